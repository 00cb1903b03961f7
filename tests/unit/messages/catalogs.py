"""The hand-edited catalogs, read for comparison."""

from functools import cache

from babel.messages.pofile import read_po

from grader.contracts.text import Language
from grader.messages import DOMAIN, FOLDER


@cache
def catalog_texts(language: Language) -> dict[str, str]:
    """Return id -> sentence of a ``.po`` file."""
    path = FOLDER / language / "LC_MESSAGES" / f"{DOMAIN}.po"
    with path.open("rb") as file:
        return {str(each.id): str(each.string) for each in read_po(file, abort_invalid=True) if each.id}
