"""One ``assignment.yaml``: parsed safely, validated strictly, with errors that name line, field and fix."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import yaml
from pydantic import ValidationError

from grader.catalog.attempts import LARGE, MOST_BYTES
from grader.catalog.interfaces import read_interfaces, standard_types, types_of
from grader.catalog.misfits import (
    MisfitError,
    WrongKeyError,
    misfit,
    refusals,
    root_causes,
    unparsable,
)
from grader.catalog.reference import with_reference
from grader.catalog.schema import AssignmentModel
from grader.catalog.types import misfits_of_types
from grader.contracts.assignment import SUFFIXES, Assignment, InterfaceDefinition, WrongAttempt
from grader.contracts.text import Text, trouble

_Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # ten times faster where libyaml is there
_NOT_UTF8 = Text(zh="不是 UTF-8 编码：请另存为 UTF-8", en="this is not UTF-8; save it as UTF-8")
_NO_FIELDS = Text(
    zh="最外层要写字段，例如 id: square", en="expected fields such as `id: square` at the top; add them"
)
"""By tool: the suffix of the structure that it sends or reads, after the name of the type."""


class _StrictLoader(_Loader):  # type: ignore[misc]
    """Refuses what PyYAML lets pass: a key that is given twice, one that is no text, and broken values."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        keys_so_far: set[str] = set()
        fields = node.value if isinstance(node, yaml.MappingNode) else ()  # else: `!!map [a]`, refused below
        for key, _ in fields:
            if not isinstance(key, yaml.ScalarNode):
                told = Text(zh="字段名要写成一个词", en="a field's name is one word; write it so")
                raise WrongKeyError(told, key.start_mark)
            if key.value in keys_so_far:
                zh, en = (
                    f"字段 {key.value!r} 写了两次：删掉一个",
                    f"the field {key.value!r} is given twice; remove one",
                )
                raise WrongKeyError(Text(zh=zh, en=en), key.start_mark)
            keys_so_far.add(key.value)
        mapping: dict[Any, Any] = super().construct_mapping(node, deep=deep)
        return mapping

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        try:
            return super().construct_object(node, deep=deep)
        except (ValueError, LookupError, AttributeError) as error:  # the 30th of February, `!!bool maybe`
            raise yaml.constructor.ConstructorError(None, None, str(error), node.start_mark) from error


@dataclass(frozen=True, slots=True)
class Document:
    """A parsed but not yet validated file."""

    path: Path
    text: str
    data: dict[str, Any]

    @classmethod
    def read(cls, path: Path) -> "Document":
        """Read and parse a file.

        Raises AssignmentError: not readable, not UTF-8, or not YAML with fields at the top.
        """
        try:
            text = path.read_text(encoding="utf-8")
            data = yaml.load(text, Loader=_StrictLoader)  # noqa: S506  (a safe loader)
        except OSError as error:
            raise refusals([(str(path), trouble(error))]) from error
        except UnicodeDecodeError as error:
            raise refusals([(str(path), _NOT_UTF8)]) from error
        except yaml.MarkedYAMLError as error:
            line = error.problem_mark.line + 1 if error.problem_mark is not None else "?"
            raise refusals([(f"{path}:{line}", unparsable(error))]) from error
        except yaml.YAMLError as error:
            raise refusals([(str(path), unparsable(yaml.MarkedYAMLError(problem=str(error))))]) from error
        if not isinstance(data, dict):
            raise refusals([(f"{path}:1", _NO_FIELDS)])
        return cls(path, text, data)

    def with_seeds(self, shift: int) -> "Document":
        """Return the file with all seeds larger by `shift`, as far as they are whole numbers."""
        if not shift:
            return self

        def later(part: object) -> object:
            seed = part.get("seed", 0) if isinstance(part, dict) else None
            return (
                {**part, "seed": seed + shift} if isinstance(part, dict) and isinstance(seed, int) else part
            )

        data = {**self.data, "world": later(self.data.get("world", {}))}
        if isinstance(cases := self.data.get("cases"), list):
            data["cases"] = [later(case) for case in cases]
        return replace(self, data=data)

    @property
    def order(self) -> float:
        """Position on the checklist as written, last if it is not a number."""
        order = self.data.get("order")
        return order if isinstance(order, int | float) else float("inf")

    @property
    def file_patterns(self) -> tuple[str, ...]:
        """File name patterns as written; empty if they are not a list of texts."""
        patterns = self.data.get("file_patterns")
        return tuple(map(str, patterns)) if isinstance(patterns, list) else ()

    def assignment(self) -> Assignment:
        """Return the validated assignment, with the interfaces that it brings along.

        Raises AssignmentError: naming file, line, field and fix of every problem.
        """
        assignment = self._validated().to_contract()
        interfaces = read_interfaces(self.path.parent)
        self._check_conversation(assignment, interfaces)
        return with_reference(replace(assignment, interfaces=interfaces), self.path.parent)

    def wrong_attempts(self) -> tuple[WrongAttempt, ...]:
        """Return the validated expectations for the wrong scripts. Raises as `assignment`."""
        return self._validated().attempts()

    def changed_scripts(self) -> dict[str, bytes]:
        """Return by name the wrong scripts that are changes of others.

        Raises as `assignment`; or a change does not fit the script that it changes.
        """
        model = self._validated()
        solution = "solution" + SUFFIXES[model.input][0]
        texts: dict[str, str] = {}
        refused = []
        for i, wrong in enumerate(model.wrong):
            if wrong.change:
                try:
                    texts[wrong.file] = wrong.made_of(self._base(wrong.base or solution, texts))
                    if sum(map(len, texts.values())) > MOST_BYTES:
                        raise MisfitError(LARGE, "change")
                except MisfitError as error:
                    refused.append((self.place(f"wrong.{i}.{error.field[0]}", *error.field[1:]), error.told))
                    texts.setdefault(wrong.file, "")
        if refused:
            raise refusals(refused)
        return {name: text.encode() for name, text in texts.items()}

    def _base(self, name: str, changed: Mapping[str, str]) -> str:
        """Return the text of the script that an attempt is a change of; each of its lines ends as Unix's do."""
        if name in changed:
            return changed[name]
        own = name.startswith(("solution.", "starter."))
        path = self.path.with_name(name) if own else self.path.parent / "wrong" / name
        try:
            return path.read_text(encoding="utf-8-sig")
        except OSError as error:
            raise MisfitError(trouble(error).about(path), "base") from error
        except UnicodeDecodeError as error:
            raise MisfitError(_NOT_UTF8.about(path), "base") from error

    def line_of(self, field: tuple[int | str, ...]) -> int:
        """Return the 1-based line where `field` stands, or of the nearest enclosing one that does."""
        node = yaml.compose(self.text, Loader=_Loader)
        line = 1
        for step in field:
            if isinstance(node, yaml.MappingNode):
                pair = next((pair for pair in node.value if pair[0].value == str(step)), None)
                if pair is None:
                    break
                line, node = pair[0].start_mark.line + 1, pair[1]
            elif isinstance(node, yaml.SequenceNode) and isinstance(step, int) and step < len(node.value):
                node = node.value[step]
                line = node.start_mark.line + 1
            else:
                break
        return line

    def _validated(self) -> AssignmentModel:
        try:
            model = AssignmentModel.model_validate(self.data)
        except ValidationError as error:
            raise refusals(self._problem(cause) for cause in root_causes(error.errors())) from error
        if model.id != (name := self.path.parent.name):
            told = Text(
                zh=f"{model.id!r} 要和文件夹名 {name!r} 一样",
                en=f"{model.id!r} must be the folder's name {name!r}",
            )
            raise refusals([(self.place("id"), told)])
        return model

    def _check_conversation(
        self, assignment: Assignment, interfaces: tuple[InterfaceDefinition, ...]
    ) -> None:
        """Refuse steps and expectations with a type that is unknown, or with fields that it does not have."""
        if assignment.steps or assignment.expectations:
            types = {**standard_types(), **types_of(interfaces)}
            own = assignment.package is not None and assignment.package.interfaces
            misfits = misfits_of_types(assignment, types, may_be_unknown=own)
            refused = [(self.place(field), told) for field, told in misfits]
            if refused:
                raise refusals(refused)

    def place(self, field: str, *keys: int | str) -> str:
        """Return where `field` (``items.2.measure``) stands: file, line and field.

        `keys`: steps to the line within the field, which are not named.
        """
        steps = tuple(int(step) if step.isdecimal() else step for step in field.split("."))
        return f"{self.path}:{self.line_of((*steps, *keys))}: {field}"

    def _problem(self, error: Any) -> tuple[str, Text]:
        field, told = misfit(error, AssignmentModel)
        return self.place(".".join(map(str, field)) or "assignment"), told
