"""What a file must be to be accepted at all, the same on the command line and over HTTP."""

import re

from grader.contracts.errors import RefusedError
from grader.contracts.text import Text

MAX_SOURCE_BYTES = 256 * 1024
_ZIP = Text(zh="压缩包，或者 Word 之类的文档", en="an archive, or a document of Word and the like")
_OTHER_FILES = {  # what beginners hand in instead, by how it begins
    b"PK\x03\x04": _ZIP,
    b"Rar!": _ZIP,
    b"7z\xbc\xaf": _ZIP,
    b"\x1f\x8b": _ZIP,
    b"\xd0\xcf\x11\xe0": Text(zh="旧版 Word 文档", en="an old document of Word"),
    b"%PDF-": Text(zh=" PDF 文件", en="a PDF"),
    b"\x89PNG": Text(zh="图片", en="a picture"),
    b"\xff\xd8\xff": Text(zh="图片", en="a picture"),
}
_CODING = re.compile(rb"[ \t\f]*#.*?coding[:=][ \t]*([-\w.]{1,40})")  # of PEP 263


def check_source(source: bytes, max_bytes: int = MAX_SOURCE_BYTES) -> None:
    """Accept a file of UTF-8 text (a byte order mark is fine) within `max_bytes`.

    Raises:
        RefusedError: ``too_large``, ``empty``, ``not_utf8`` or ``contains_nul``; the message says where.
    """
    if len(source) > max_bytes:
        raise RefusedError(
            "too_large",
            Text(
                zh=f"文件有 {len(source)} 字节，最多接受 {max_bytes} 字节。",
                en=f"the file has {len(source)} bytes; at most {max_bytes} are accepted",
            ),
            field="file",
        )
    if not source.removeprefix(b"\xef\xbb\xbf").strip():
        raise RefusedError(
            "empty",
            Text(
                zh="文件里什么也没有：提交之前保存了吗？",
                en="the file is empty: was it saved before it was handed in?",
            ),
            field="file",
        )
    _check_kind(source)
    if (place := source.find(b"\0")) >= 0:
        raise RefusedError(
            "contains_nul",
            Text(
                zh=f"第 {_line(source, place)} 行含有 NUL 字节，这不是文本文件。",
                en=f"line {_line(source, place)} contains a NUL byte: this is not a text file",
            ),
            field="file",
        )
    _check_encoding(source)


def _check_kind(source: bytes) -> None:
    """Refuse what its first bytes tell to be no text in UTF-8."""
    if source.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise RefusedError(
            "not_utf8",
            Text(
                zh="文件是 UTF-16 编码（记事本里叫 Unicode）：请把文件另存为 UTF-8。",
                en="this is UTF-16, which Notepad calls Unicode: save the file as UTF-8",
            ),
            field="file",
        )
    kind = next((kind for head, kind in _OTHER_FILES.items() if source.startswith(head)), None)
    if kind is not None:
        raise RefusedError(
            "contains_nul",
            Text(
                zh=f"这是{kind.zh}，改名字没有用：请提交脚本或文字文件本身。",
                en=f"this is {kind.en}, whatever its name ends in: hand in the script or text itself",
            ),
            field="file",
        )


def _check_encoding(source: bytes) -> None:
    try:
        source.decode("utf-8")
    except UnicodeDecodeError as error:
        line, byte = _line(source, error.start), f"0x{source[error.start]:02x}"
        en, zh = "", ""
        if (declared := _declared(source)) is not None:
            where, coding = declared
            en = f", and delete line {where}, which declares {coding}: only UTF-8 is accepted"
            zh = f"，并删去第 {where} 行的编码声明（{coding}）：这里只接受 UTF-8"
        raise RefusedError(
            "not_utf8",
            Text(
                zh=f"第 {line} 行有一个字节不是 UTF-8 编码（{byte}）：请把文件另存为 UTF-8{zh}。",
                en=f"line {line} contains a byte that is not UTF-8 ({byte}): save the file as UTF-8{en}",
            ),
            field="file",
        ) from None


def _declared(source: bytes) -> tuple[int, str] | None:
    """Return line and name of a coding declared by PEP 263 that is not UTF-8, if there is one.

    Python would read such a file. Everything behind the upload (pages, exports, marks of lines) is told in
    UTF-8 alone, and the declaration would garble the file once it is saved so: hence the advice to delete it.
    """
    for number, line in enumerate(source.splitlines()[:2], start=1):
        if (found := _CODING.match(line)) is not None:
            coding = found[1].decode("ascii")
            return None if re.fullmatch("utf[-_]?8.*", coding, re.IGNORECASE) else (number, coding)
        if line.strip() and not line.lstrip().startswith(b"#"):
            return None
    return None


def _line(source: bytes, place: int) -> int:
    return source.count(b"\n", 0, place) + 1
