"""Write the compiled catalogs: ``python -m grader.messages.compile`` (a development tool, needs Babel)."""

import io
from pathlib import Path

from babel.messages.mofile import write_mo
from babel.messages.pofile import read_po

from grader.contracts.text import LANGUAGES
from grader.messages import DOMAIN, FOLDER


def compiled(po_path: Path) -> bytes:
    """Return the binary catalog of a ``.po`` file; fuzzy entries are left out."""
    with po_path.open("rb") as file:
        catalog = read_po(file, abort_invalid=True)
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
