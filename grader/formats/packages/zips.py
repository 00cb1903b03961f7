"""Read a zip that a student uploaded: what is refused is refused with the sentence that its sender needs."""

from grader.contracts.errors import RefusedError
from grader.contracts.text import Text
from grader.formats.packages.archives import (
    BOUNDS,
    ArchiveError,
    Fault,
    Keep,
    ZipBounds,
    all_files,
    read_archive,
)

_SHOWN = 80


def read_zip(content: bytes, keep: Keep = all_files, bounds: ZipBounds = BOUNDS) -> dict[str, bytes]:
    """Return the files of a zip by their paths, as `grader.formats.packages.archives.read_archive`.

    Raises:
        RefusedError: ``bad_archive``: it is no zip, damaged, encrypted, too large or too deep, or holds links or
            paths that lead out of it; ``too_large``: it unpacks to more than the bounds.
    """
    try:
        return read_archive(content, keep, bounds)
    except ArchiveError as error:
        large = error.fault in (Fault.LARGE, Fault.LARGE_FILE, Fault.DENSE)
        raise RefusedError(
            "too_large" if large else "bad_archive", _refusal_text(error), field="file"
        ) from error


def _refusal_text(error: ArchiveError) -> Text:
    if error.path:
        return _refusal_text_of_file(error.fault, _shown(error.path))
    if error.fault is Fault.OTHER_FORMAT:
        return Text(
            zh=f"这是 {error.format} 压缩包，改名字没有用：请压缩成 zip 格式再交。",
            en=f"this is a {error.format} archive, whatever its name ends in: pack it as .zip",
        )
    if error.fault is Fault.MANY:
        return Text(
            zh=f"压缩包里有 {error.count} 个文件，最多 {error.most} 个：只压缩功能包的文件夹。",
            en=f"the zip holds {error.count} files, at most {error.most} are taken: "
            "zip nothing but the package's folder",
        )
    if error.fault is Fault.NO_ZIP:
        return Text(
            zh="这不是 zip 文件，或者没有传完整：请把文件夹压缩成 .zip 再交。",
            en="this is no zip, or a part of one: pack the folder as .zip and hand that in",
        )
    return Text(
        zh="这个 zip 文件坏了，打不开：请重新压缩后再交。",
        en="this zip is damaged and cannot be read: zip it again",
    )


def _refusal_text_of_file(fault: Fault, path: str) -> Text:
    large = Text(
        zh=f"解压后太大（到 {path} 为止）：只压缩源代码，不要 build、install、log、.git、图片和录像。",
        en=f"it unpacks to too much (at {path}): zip the sources only, without build, install, log, .git, "
        "pictures and recordings",
    )
    refusals = {
        Fault.NAME: Text(
            zh=f"压缩包里有不能用的文件名 {path}：把文件夹重新压缩一次，文件名里不要有 ..、开头的 / 或盘符。",
            en=f"the zip holds a name that cannot be used, {path}: zip the folder again, without '..', "
            "a leading '/' or a drive letter in any name",
        ),
        Fault.LONG: Text(
            zh=f"压缩包里的路径太长：{path}。请只压缩功能包的文件夹。",
            en=f"a path in the zip is too long: {path}. Zip nothing but the package's folder",
        ),
        Fault.TWICE: Text(
            zh=f"压缩包里有两个同名文件（大小写不算）：{path}。请改掉一个再压缩。",
            en=f"two files in the zip have the same name but for small and capital letters: {path}. "
            "Rename one and zip again",
        ),
        Fault.LINK: Text(
            zh=f"压缩包里的 {path} 是链接，不是文件：请换成文件本身。",
            en=f"{path} in the zip is a link, not a file: put the file itself there",
        ),
        Fault.LOCKED: Text(
            zh="这个压缩包有密码：请不设密码重新压缩。",
            en="this zip is protected by a password: zip it again without one",
        ),
        Fault.METHOD: Text(
            zh=f"{path} 用了少见的压缩方法：请用系统自带的“压缩为 zip”重新压缩。",
            en=f"{path} is packed by an unusual method: zip the folder with your system's own tool",
        ),
    }
    return refusals.get(fault, large)


def _shown(path: str) -> str:
    """Return a path as it may be printed."""
    text = path if len(path) <= _SHOWN else f"…{path[-_SHOWN:]}"
    return "".join(char if char.isprintable() else "?" for char in text)
