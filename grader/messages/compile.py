"""Write the compiled catalogs: ``python -m grader.messages.compile`` (a development tool, needs Babel)."""

import io
from datetime import UTC, datetime
from pathlib import Path

from babel.messages.mofile import write_mo
from babel.messages.pofile import read_po

from grader.contracts.text import LANGUAGES
from grader.messages import DOMAIN, FOLDER

_NO_DATE = datetime(2000, 1, 1, tzinfo=UTC)


def compiled(po_path: Path) -> bytes:
    """Return the binary catalog of a ``.po`` file; fuzzy entries are left out."""
    with po_path.open("rb") as file:
        catalog = read_po(file, abort_invalid=True)
    catalog.creation_date = _NO_DATE  # the same sentences give the same bytes on any day
    buffer = io.BytesIO()
    write_mo(buffer, catalog)
    return buffer.getvalue()


def main() -> None:
    """Compile every language's catalog in place."""
    for language in LANGUAGES:
        po_path = FOLDER / language / "LC_MESSAGES" / f"{DOMAIN}.po"
        po_path.with_suffix(".mo").write_bytes(compiled(po_path))


if __name__ == "__main__":
    main()
