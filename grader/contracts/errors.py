"""Everything the grader raises on purpose.

GraderError
├── AssignmentError        the instructor's file is wrong: names file, field and fix
├── UnknownAssignmentError no assignment of that name
├── RefusedError           what somebody asks for is not done: names the kind, the place and what is accepted
├── CourseError            a course, its people or its rules cannot be changed as asked
│   └── ChangedMeanwhileError     somebody else changed the same since it was looked at
├── SettingsError          the operator's configuration is wrong
├── SandboxError           the sandbox could not run the script: infrastructure, never a low mark
│   └── SandboxUnavailableError   a required layer is missing: the service refuses to grade
│   └── NoRoomError               the host has no process, thread or memory to spare; also an InfrastructureError
├── ProtocolError          the jailed process sent something outside the wire format
└── InfrastructureError    anything else on the grader's side; retried
"""

import errno
from typing import TYPE_CHECKING, Any, Final

from grader.contracts.python import Self

if TYPE_CHECKING:
    from collections.abc import Iterable

    from grader.contracts.text import Language, Text

_NO_ROOM: Final = (errno.EAGAIN, errno.ENOMEM)
_SIGNS: Final = (*(f"[Errno {number}]" for number in _NO_ROOM), "MemoryError", "can't start new thread")


class GraderError(Exception):
    """Root of the grader's own exceptions; its message is fit to be shown.

    Attributes:
        zh: the message in Chinese; empty where only operators read it.
    """

    def __init__(self, message: str = "", zh: str = "") -> None:
        super().__init__(message)
        self.zh = zh

    @classmethod
    def about(cls, name: object, told: "Text") -> Self:
        """Return the error that says what is wrong with something, behind its name."""
        message = told.about(name)
        return cls(message.en, message.zh)

    def message_in(self, language: "Language") -> str:
        """Return the message in `language` if it is there, else in English."""
        return (self.zh if language == "zh" else "") or str(self)

    @property
    def text(self) -> "Text":
        """The message in both languages; in Chinese it is the English one where there is no other."""
        from grader.contracts.text import Text

        return Text(zh=self.message_in("zh"), en=self.message_in("en"))


class AssignmentError(GraderError):
    """An assignment's files do not say what they must.

    Attributes:
        problems: where something is wrong (file, line and field), and what; empty where the message alone says it.
    """

    problems: "tuple[tuple[str, Text], ...]" = ()


class UnknownAssignmentError(GraderError):
    """No assignment has the name asked for."""

    @classmethod
    def among(cls, known: "Iterable[str]", assignment_id: str) -> "UnknownAssignmentError":
        """Return the error that names the id that was probably meant, else lists those that there are."""
        import difflib  # every process imports this module, and few meet this error

        ids = sorted(known)
        if likely := difflib.get_close_matches(assignment_id, ids, 1):
            return cls(
                f"no assignment {assignment_id!r}; do you mean {likely[0]}?",
                f"没有作业 {assignment_id!r}；是不是 {likely[0]}？",
            )
        there = ", ".join(ids)
        return cls(
            f"no assignment {assignment_id!r}; there are: {there}",
            f"没有作业 {assignment_id!r}；现有：{there}",
        )

    @classmethod
    def unguessed(cls, file_name: str) -> "UnknownAssignmentError":
        """Return the error of a command for a file whose name fits no assignment."""
        return cls(
            f"the file name {file_name!r} does not tell the assignment; say which, as in -a square "
            "(`grader assignments list` names them; a course's own stand on its pages)",
            f"从文件名 {file_name!r} 看不出是哪个作业：用 -a 指明，例如 -a square"
            "（作业名用 grader assignments list 查看，课程自己的作业看网页）",
        )


class RefusedError(GraderError):
    """A use case does not do what was asked.

    Attributes:
        code: stable name of the kind of refusal; `grader.service.routes.problems` has its title and what to do.
        detail: what happened this time; None: the title of the kind is enough.
        retry_after_s: seconds until the same request may succeed; None: waiting does not help.
        members: where it is wrong and what would be accepted: `field`, `line`, `column`, `text`, `allowed`.
    """

    def __init__(
        self,
        code: str,
        detail: "Text | None" = None,
        *,
        retry_after_s: int | None = None,
        **members: object,
    ) -> None:
        super().__init__(code if detail is None else detail.en, "" if detail is None else detail.zh)
        self.code = code
        self.detail = detail
        self.retry_after_s = retry_after_s
        self.members: dict[str, Any] = members

    @classmethod
    def saying(cls, code: str, *, zh: str, en: str, **members: Any) -> Self:
        """Return the refusal that says in these words what happened."""
        from grader.contracts.text import Text

        return cls(code, Text(zh=zh, en=en), **members)


class CourseError(GraderError):
    """A course, its people or its rules cannot be changed as asked.

    Attributes:
        field: the part of what was asked for that is wrong; None where it is none alone.
    """

    def __init__(self, message: str = "", zh: str = "", field: str | None = None) -> None:
        super().__init__(message, zh)
        self.field = field


class ChangedMeanwhileError(CourseError):
    """Somebody else changed the same thing after the caller had looked at it."""


class SettingsError(GraderError):
    """A setting has a value the grader refuses to start with."""


class SandboxError(GraderError):
    """The sandbox failed before or while running a script, through no fault of the script."""


class SandboxUnavailableError(SandboxError):
    """A required layer of isolation is missing on this host."""


class ProtocolError(GraderError):
    """The jailed process sent a frame outside the wire format."""


class InfrastructureError(GraderError):
    """A fault of the grader or its host; the submission is graded again."""


class NoRoomError(SandboxError, InfrastructureError):
    """The host has no process, thread or memory to spare now, so that nothing of a script has run."""


def lacks_room(error: BaseException | str) -> bool:
    """Return whether an error, or what a trusted process says of one, means that the host has nothing to spare."""
    if isinstance(error, OSError):
        return error.errno in _NO_ROOM
    return any(sign in (error if isinstance(error, str) else repr(error)) for sign in _SIGNS)
