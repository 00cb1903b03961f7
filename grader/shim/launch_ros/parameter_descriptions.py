"""Values and files of parameters."""

from __future__ import annotations

from launch._evaluation import checked

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class ParameterValue:
    """A value, with the type that its text is read as; None: as YAML says."""

    def __init__(self, value: Any, *, value_type: Any = None) -> None:
        self.value = value
        self.value_type = value_type


class Parameter:
    """A parameter's name and value."""

    def __init__(self, name: Any, value: Any, *, value_type: Any = None) -> None:
        checked(name)
        self.name = name
        self.value = value
        self.value_type = value_type


class ParameterFile:
    """A file of parameters. Substitutions in it, which `allow_substs` asks for, are not carried out."""

    def __init__(self, param_file: Any, *, allow_substs: Any = False) -> None:
        self.param_file = param_file
        self.allow_substs = allow_substs
