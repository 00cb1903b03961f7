"""The extras of an installation: what the core, which grades turtlesim's exercises, does without."""

from typing import Final

from grader.contracts.errors import InfrastructureError

_MODULES: Final = {
    "physics": ("pybullet", "pybullet_data"),
    "plots": ("matplotlib",),
    "bags": ("mcap",),
    "live": ("wsproto",),
    "postgres": ("psycopg", "procrastinate"),
    "signin": ("joserfc",),
}
_OF_MODULE: Final = {module: extra for extra, modules in _MODULES.items() for module in modules}


class MissingExtraError(InfrastructureError):
    """Something was asked for that needs an extra which is not installed.

    Attributes:
        extra: its name.
    """

    extra: str = ""

    @classmethod
    def of(cls, error: ModuleNotFoundError) -> "MissingExtraError | None":
        """Return the error that names the extra to install; None where a module of the grader is missing."""
        package = (error.name or "").partition(".")[0]
        if package in ("", "grader"):
            return None
        return cls.named(_OF_MODULE.get(package, "service"))

    @classmethod
    def named(cls, extra: str) -> "MissingExtraError":
        """Return the error for an extra."""
        error = cls(
            f"this needs the extra '{extra}', which is not installed: install the grader again as you did, with "
            f"[{extra}] behind its name",
            f"这里需要附加组件 {extra}，还没有安装：用原来的方法重新安装评分程序，在名字后面加上 [{extra}]",
        )
        error.extra = extra
        return error
