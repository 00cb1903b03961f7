"""Values and files of parameters."""

from __future__ import annotations

import os

from launch._evaluation import LaunchContext, Substitution, perform
from launch._types import normalize_typed_substitution, perform_typed_substitution, yaml
from launch.substitutions import SubstitutionFailure
from launch.utilities import ensure_argument_type, normalize_to_list_of_substitutions

TYPE_CHECKING = False
if TYPE_CHECKING:
    from pathlib import Path
    from typing import Any


class ParameterValue:
    """A value, with the type that its text is read as; None: as YAML says."""

    def __init__(self, value: Any, *, value_type: Any = None) -> None:
        self._value = normalize_typed_substitution(value, value_type)
        self._value_type = value_type

    @property
    def value(self) -> Any:
        """The value: a scalar, a list of substitutions, or a list with both; once evaluated, what that gave."""
        return self._value

    @property
    def value_type(self) -> Any:
        """The type, or None."""
        return self._value_type

    def __str__(self) -> str:
        return f"launch_ros.description.ParameterValue(value={self.value}, value_type={self.value_type})"

    def evaluate(self, context: LaunchContext) -> Any:
        """Return the value, its texts read as the type says."""
        self._value = perform_typed_substitution(context, self._value, self._value_type)
        return self._value


class Parameter:
    """A parameter's name and value."""

    def __init__(self, name: Any, value: Any, *, value_type: Any = None) -> None:
        self._name: Any = normalize_to_list_of_substitutions(name)
        self._value = ParameterValue(value, value_type=value_type)

    @property
    def name(self) -> Any:
        """The name as a list of substitutions; once evaluated, its text."""
        return self._name

    @property
    def value(self) -> Any:
        """The value, as ParameterValue has it."""
        return self._value.value

    @property
    def value_type(self) -> Any:
        """The type, or None."""
        return self._value.value_type

    def __str__(self) -> str:
        return (
            f"launch_ros.description.Parameter(name={self.name}, value={self.value}, "
            f"value_type={self.value_type})"
        )

    def evaluate(self, context: LaunchContext) -> tuple[str, Any]:
        """Return name and value."""
        self._name = perform(context, self._name)
        return self._name, self._value.evaluate(context)


class ParameterFile:
    """A file of parameters; with `allow_substs`, ``$(var name)`` and the like in it are carried out."""

    def __init__(self, param_file: Any, *, allow_substs: Any = False) -> None:
        ensure_argument_type(
            param_file,
            (str, Substitution, list, tuple, os.PathLike, bytes),
            "param_file",
            "ParameterFile()",
        )
        ensure_argument_type(allow_substs, bool, "allow_subst", "ParameterFile()")
        self._param_file = (
            normalize_to_list_of_substitutions(param_file)
            if isinstance(param_file, (str, Substitution, list, tuple))
            else os.fsdecode(param_file)
        )
        self._allow_substs = allow_substs
        self._path: Path | None = None

    @property
    def param_file(self) -> Any:
        """The file; once evaluated, its path."""
        return self._path or self._param_file

    @property
    def allow_substs(self) -> bool:
        """Whether substitutions in it are carried out."""
        return bool(self._allow_substs)

    def evaluate(self, context: LaunchContext) -> Path:
        """Return the path of the file, or of a copy in which the substitutions are carried out.

        Raises:
            SubstitutionFailure: a substitution has no text, or the file is no YAML with it.
        """
        from pathlib import Path

        from launch.frontend.parse_substitution import parse_substitution

        if self._path is None:
            path = Path(perform(context, self._param_file))
            if self._allow_substs:
                parsed = perform(context, parse_substitution(path.read_text()))
                try:
                    yaml().safe_load(parsed)
                except yaml().YAMLError:
                    raise SubstitutionFailure(
                        "The substituted parameter file is not a valid yaml file"
                    ) from None
                path = Path(new_file(parsed))
            self._path = path
        return self._path


_written: list[str] = []


def new_file(text: str) -> str:
    """Return the path of a new file with a text."""
    path = f"/tmp/launch_params_{len(_written)}"  # noqa: S108 - the storage's own
    _written.append(path)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return path
