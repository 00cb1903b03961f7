"""Text in the two languages of the course."""

from typing import Literal

from grader.contracts.record import record

Language = Literal["zh", "en"]
LANGUAGES: tuple[Language, ...] = ("zh", "en")


@record
class Text:
    """One sentence in Chinese and in English. Both are always present."""

    zh: str
    en: str

    def get(self, language: Language) -> str:
        """Return the sentence in `language`."""
        return self.zh if language == "zh" else self.en


EMPTY = Text(zh="", en="")
