"""What a process would be: its command line, its environment and where it works, as launch evaluates them."""

from __future__ import annotations

import os
import re
import shlex

from launch._evaluation import LaunchContext, checked, perform

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from typing import Any

__all__ = ["Executable"]


class Executable:
    """A command line, which is not run here.

    The names that begin with ``final_`` are None until `prepare`.
    """

    count = 0

    def __init__(
        self,
        *,
        cmd: Iterable[Any],
        prefix: Any = None,
        name: Any = None,
        cwd: Any = None,
        env: Mapping[Any, Any] | None = None,
        additional_env: Mapping[Any, Any] | None = None,
        arguments: Iterable[Any] | None = None,
    ) -> None:
        self.cmd = [*cmd, *(arguments or ())]
        checked(*self.cmd, prefix, name, cwd)
        self.prefix, self.name, self.cwd, self.arguments = prefix, name, cwd, arguments
        self.env = None if env is None else list(env.items())
        self.additional_env = None if additional_env is None else list(additional_env.items())
        for pair in (*(self.env or ()), *(self.additional_env or ())):
            checked(*pair)
        self.final_cmd: list[str] | None = None
        self.final_name: str | None = None
        self.final_cwd: str | None = None
        self.final_env: dict[str, str] | None = None

    def prepare(self, context: LaunchContext, action: Any) -> None:
        """Evaluate it; each one that is evaluated gets a name of its own, such as ``drive-1``."""
        cmd = [perform(context, part) for part in self.cmd]
        self.final_cmd = [*self._prefix(context, cmd[0]), *cmd]
        name = os.path.basename(self.final_cmd[0]) if self.name is None else perform(context, self.name)
        Executable.count += 1
        self.final_name = f"{name}-{Executable.count}"
        self.final_cwd = None if self.cwd is None else perform(context, self.cwd)
        env = dict(context.environment) if self.env is None else {}
        for key, value in (*(self.env or ()), *(self.additional_env or ())):
            env[perform(context, key)] = perform(context, value)
        self.final_env = env

    def _prefix(self, context: LaunchContext, program: str) -> list[str]:
        configurations = context.launch_configurations
        if self.prefix is not None:
            return shlex.split(perform(context, self.prefix))
        if re.match(configurations.get("launch-prefix-filter", ""), os.path.basename(program)):
            return shlex.split(configurations.get("launch-prefix", ""))
        return []
