"""Text in the two languages of the course."""

from dataclasses import dataclass
from typing import Literal

Language = Literal["zh", "en"]
LANGUAGES: tuple[Language, ...] = ("zh", "en")


@dataclass(frozen=True, slots=True, kw_only=True)
class Text:
    """One sentence in Chinese and in English. Both are always present."""

    zh: str
    en: str

    def get(self, language: Language) -> str:
        """Return the sentence in `language`."""
        return self.zh if language == "zh" else self.en


EMPTY = Text(zh="", en="")
