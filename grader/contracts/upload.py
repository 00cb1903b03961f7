"""What a file must be to be accepted at all, the same on the command line and over HTTP."""

from grader.contracts.errors import SubmissionError

MAX_SOURCE_BYTES = 256 * 1024


def check_source(source: bytes, max_bytes: int = MAX_SOURCE_BYTES) -> None:
    """Accept a file of UTF-8 text (a byte order mark is fine) within `max_bytes`.

    Raises:
        SubmissionError: ``too_large``, ``empty``, ``not_utf8`` or ``contains_nul``; the message says where.
    """
    if len(source) > max_bytes:
        raise SubmissionError(
            "too_large",
            f"the file has {len(source)} bytes; at most {max_bytes} are accepted",
            f"文件有 {len(source)} 字节，最多接受 {max_bytes} 字节。",
        )
    if not source.removeprefix(b"\xef\xbb\xbf").strip():
        raise SubmissionError(
            "empty",
            "the file is empty: was it saved before it was handed in?",
            "文件里什么也没有：提交之前保存了吗？",
        )
    if (place := source.find(b"\0")) >= 0:
        raise SubmissionError(
            "contains_nul",
            f"line {_line(source, place)} contains a NUL byte: this is not a text file",
            f"第 {_line(source, place)} 行含有 NUL 字节，这不是文本文件。",
        )
    try:
        source.decode("utf-8")
    except UnicodeDecodeError as error:
        raise SubmissionError(
            "not_utf8",
            f"line {_line(source, error.start)} contains a byte that is not UTF-8 "
            f"(0x{source[error.start]:02x}): save the file as UTF-8",
            f"第 {_line(source, error.start)} 行有一个字节不是 UTF-8 编码（0x{source[error.start]:02x}）："
            "请把文件另存为 UTF-8。",
        ) from None


def _line(source: bytes, place: int) -> int:
    return source.count(b"\n", 0, place) + 1
