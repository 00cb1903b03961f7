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
_NOTEBOOK = Text(
    zh="这是 Jupyter 笔记本：请导出为脚本（Jupyter：File → Save and Export Notebook As → Executable Script；"
    "VS Code：… → Export → Python Script），再交 .py 文件。",
    en="This is a Jupyter notebook: export it as a script (Jupyter: File → Save and Export Notebook As → "
    "Executable Script; VS Code: … → Export → Python Script) and hand in the .py file.",
)
_NOTEBOOK_HEAD = re.compile(rb'\s*\{\s*"(cells|metadata|nbformat|nbformat_minor)"\s*:')
_HIDDEN = re.compile(r"(.+?)(?:\.py)?(?:\.(?:txt|text|md|doc|docx|pyw|pyc|bak|py)|。py|．py)", re.IGNORECASE)
_CHINESE = ("gbk", "gb2312", "gb18030", "cp936", "936")
_CONVERT = Text(
    zh="请另存为 UTF-8：VS Code 点右下角的编码 → “通过编码重新打开” → GBK，再点一次 → “通过编码保存” → UTF-8；"
    "记事本用“另存为”，编码选 UTF-8。",
    en=". Save the file as UTF-8: in VS Code click the encoding at the bottom right, Reopen with Encoding → GBK, "
    "then Save with Encoding → UTF-8; in Notepad, Save as with the encoding UTF-8",
)
_CODING = re.compile(rb"[ \t\f]*#.*?coding[:=][ \t]*([-\w.]{1,40})")  # of PEP 263


def check_source(source: bytes, max_bytes: int = MAX_SOURCE_BYTES) -> None:
    """Accept a text within `max_bytes`, in UTF-8 (a byte order mark is fine) or a Chinese coding that it declares.

    Raises:
        RefusedError: ``too_large``, ``empty``, ``not_utf8``, ``contains_nul`` or, for a notebook,
            ``wrong_file_type``; the message says where.
    """
    if len(source) > max_bytes:
        raise RefusedError.saying(
            "too_large",
            zh=f"文件有 {len(source)} 字节，最多接受 {max_bytes} 字节。",
            en=f"the file has {len(source)} bytes; at most {max_bytes} are accepted",
            field="file",
        )
    if not source.removeprefix(b"\xef\xbb\xbf").strip():
        raise RefusedError.saying(
            "empty",
            zh="文件里什么也没有：提交之前保存了吗？",
            en="the file is empty: was it saved before it was handed in?",
            field="file",
        )
    _check_kind(source)
    if (place := source.find(b"\0")) >= 0:
        raise RefusedError.saying(
            "contains_nul",
            zh=f"第 {_line(source, place)} 行含有 NUL 字节，这不是文本文件。",
            en=f"line {_line(source, place)} contains a NUL byte: this is not a text file",
            field="file",
        )
    _check_encoding(source)


def in_utf8(source: bytes) -> bytes:
    """Return a text that people wrote in UTF-8: as Notepad saves it, in GBK or UTF-16, it is a text as well.

    What is none of them is returned as it is, and `check_source` says what is wrong with it.
    """
    codings = ("utf-8", "utf-16") if source.startswith((b"\xff\xfe", b"\xfe\xff")) else ("utf-8", "gb18030")
    if any(source.startswith(head) for head in _OTHER_FILES):
        return source
    for coding in codings:
        if _decodes(source, coding):
            return source if coding == "utf-8" else source.decode(coding).encode()
    return source


def _check_kind(source: bytes) -> None:
    """Refuse what its first bytes tell to be no text in UTF-8."""
    if source.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise RefusedError.saying(
            "not_utf8",
            zh="文件是 UTF-16 编码（记事本里叫 Unicode）：请把文件另存为 UTF-8。",
            en="this is UTF-16, which Notepad calls Unicode: save the file as UTF-8",
            field="file",
        )
    if _NOTEBOOK_HEAD.match(source) and b'"cell_type"' in source:
        raise RefusedError("wrong_file_type", _NOTEBOOK, field="file")
    kind = next((kind for head, kind in _OTHER_FILES.items() if source.startswith(head)), None)
    if kind is not None:
        raise RefusedError.saying(
            "contains_nul",
            zh=f"这是{kind.zh}，改名字没有用：请提交脚本或文字文件本身。",
            en=f"this is {kind.en}, whatever its name ends in: hand in the script or text itself",
            field="file",
        )


def decoded(source: bytes) -> str:
    """Return the text of an accepted file, decoded as Python does."""
    declared = _declared(source)
    if declared is not None and declared.lower() in _CHINESE:
        return source.decode(declared, "replace")
    return source.decode("utf-8-sig", "replace")


def lines_of(text: str) -> list[str]:
    """Return the lines as Python and editors count them; `str.splitlines` ends lines at eight other characters."""
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    return lines if lines[-1] else lines[:-1]


def _check_encoding(source: bytes) -> None:
    """Refuse what neither is UTF-8 nor declares, as Python wants it, the Chinese coding that it is in."""
    try:
        source.decode("utf-8")
    except UnicodeDecodeError as error:
        declared = _declared(source)
        if declared is not None and declared.lower() in _CHINESE and _decodes(source, declared):
            return
        line, byte = _line(source, error.start), f"0x{source[error.start]:02x}"
        if _decodes(source, "gb18030"):
            zh = f"第 {line} 行不是 UTF-8 编码（{byte}），看起来文件是 GBK（ANSI）编码。"
            en = f"line {line} is not UTF-8 ({byte}): this file seems to be GBK, which Windows calls ANSI"
        else:
            zh = f"第 {line} 行有一个字节不是 UTF-8 编码（{byte}）。"
            en = f"line {line} contains a byte that is not UTF-8 ({byte})"
        raise RefusedError.saying(
            "not_utf8", zh=zh + _CONVERT.zh, en=en + _CONVERT.en, field="file"
        ) from None


def _decodes(source: bytes, coding: str) -> bool:
    try:
        source.decode(coding)
    except UnicodeDecodeError:
        return False
    return True


def _declared(source: bytes) -> str | None:
    """Return the coding that the first two lines declare by PEP 263, if any."""
    for line in source.splitlines()[:2]:
        if (coding := _CODING.match(line)) is not None:
            return coding[1].decode("ascii")
        if line.strip() and not line.lstrip().startswith(b"#"):
            return None
    return None


def check_name(name: str, endings: tuple[str, ...]) -> None:
    """Accept a file name with one of the wanted endings, behind something.

    Raises RefusedError: ``wrong_file_type``; the message names what the file is called, or is, and the remedy.
    """
    lower = name.lower()
    if lower.endswith(endings) and lower not in endings:
        return
    allowed_endings = Text(zh=" 或 ".join(endings), en=" or ".join(endings))
    told = Text(
        zh=f"收到的文件名是 {name or '—'}，这个作业要交的文件以 {allowed_endings.zh} 结尾。",
        en=f"The file is called {name or '—'}; this assignment takes names that end in {allowed_endings.en}.",
    )
    raise RefusedError("wrong_file_type", _remedy(name, endings, told), field="file")


def _remedy(name: str, endings: tuple[str, ...], told: Text) -> Text:
    """Return `told` with what to do about it, where the name tells that."""
    if ".py" not in endings:
        return told
    if name.lower().endswith(".ipynb"):
        return Text(zh=told.zh + _NOTEBOOK.zh, en=f"{told.en} {_NOTEBOOK.en}")
    found = _HIDDEN.fullmatch(name)
    if found is None:
        return told
    right = f"{found[1]}.py"
    return Text(
        zh=f"{told.zh}请把它改名为 {right}"
        "（Windows 会隐藏扩展名：在资源管理器里打开“查看 → 显示 → 文件扩展名”再改）。",
        en=f"{told.en} Rename it to {right} (Windows hides the ending: in Explorer, turn on View → Show → "
        "File name extensions first).",
    )


def _line(source: bytes, place: int) -> int:
    return source.count(b"\n", 0, place) + 1


def same_program(one: bytes, other: bytes) -> bool:
    """Return whether two scripts differ in nothing but blank lines, comment lines and space at line ends."""
    return _statements(one) == _statements(other)


def _statements(source: bytes) -> list[str]:
    lines = (line.rstrip() for line in lines_of(decoded(source)))
    return [line for line in lines if line and not line.lstrip().startswith("#")]
