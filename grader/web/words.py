"""The pages' own words, from the catalogue of texts, where their ids begin with ``page.``."""

from grader.contracts.text import Language
from grader.messages import MissingMessageError, sentence, template


def say(key: str, language: Language, /, **values: object) -> str:
    """Return one text in `language`, its fields filled in, not yet escaped.

    Without values the fields stay in their braces: the pages' scripts fill some of them in.

    Raises:
        MissingMessageError: there is no such text: a defect of the page.
    """
    if values:
        return sentence(language, f"page.{key}", **values)
    text = template(language, f"page.{key}")
    if text is None:
        raise MissingMessageError(f"{language}: no message {key!r} of a page")
    return text


def known(key: str) -> bool:
    """Whether the pages have such a text."""
    return template("en", f"page.{key}") is not None
