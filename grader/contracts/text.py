"""Text in the two languages of the course."""

import errno
from typing import Literal

from grader.contracts.record import Record

BYTE_ORDER_MARK = "\ufeff"
"""Begins tables for spreadsheet programs: without it, Excel takes UTF-8 for another encoding."""

Language = Literal["zh", "en"]
LANGUAGES: tuple[Language, ...] = ("zh", "en")
_TROUBLES = {
    errno.ENOENT: "没有这个文件或文件夹",
    errno.EISDIR: "这是文件夹，不是文件",
    errno.ENOTDIR: "这不是文件夹",
    errno.EEXIST: "已经有同名的文件",
    errno.EACCES: "没有权限",
    errno.EPERM: "没有权限",
    errno.EROFS: "这里不能写文件",
    errno.ENOSPC: "磁盘满了",
    errno.EADDRINUSE: "已被别的程序占用",
    errno.EADDRNOTAVAIL: "这台机器没有这个地址",
}


class Text(Record):
    """One sentence in Chinese and in English. Both are always present."""

    zh: str
    en: str

    def get(self, language: Language) -> str:
        """Return the sentence in `language`."""
        return self.zh if language == "zh" else self.en

    def about(self, name: object) -> "Text":
        """Return the sentence behind the name of what it is about."""
        return Text(zh=f"{name}：{self.zh}", en=f"{name}: {self.en}")


EMPTY = Text(zh="", en="")


def trouble(error: OSError) -> Text:
    """Return what the operating system said, in both languages as far as it is common."""
    en = error.strerror or str(error)
    return Text(zh=_TROUBLES.get(error.errno or 0, en), en=en)
