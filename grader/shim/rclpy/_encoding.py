"""How a file's bytes are text: as Python takes a file, which is stricter than `compile` is with bytes."""

from __future__ import annotations

_DECLARED = b"coding"
"""In one of the first two lines (PEP 263) it leaves the matter to the compiler."""


def require_utf8(source: bytes, file_name: str) -> None:
    """Refuse what declares no encoding and is not UTF-8 (a comment in GBK, UTF-16), which `compile` may take.

    Raises:
        SyntaxError: in Python's words, with the line.
    """
    if _DECLARED in b"\n".join(source.split(b"\n", 2)[:2]):
        return
    try:
        source.decode()
    except UnicodeDecodeError as error:
        line = source.count(b"\n", 0, error.start) + 1
        raise SyntaxError(
            f"Non-UTF-8 code starting with '\\x{source[error.start]:02x}' in file {file_name} on line {line}, "
            "but no encoding declared; see https://peps.python.org/pep-0263/ for details",
            (file_name, line, None, None),
        ) from None
