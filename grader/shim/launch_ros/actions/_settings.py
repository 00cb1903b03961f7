"""What holds for all nodes behind an action, to the end of its group. It is kept among the launch arguments."""

from __future__ import annotations

import os

from launch._evaluation import Action, LaunchContext, checked, perform
from launch.actions import TimerAction
from launch.substitutions import SubstitutionFailure
from launch.utilities import normalize_to_list_of_substitutions
from rclpy.validate_namespace import validate_namespace

from launch_ros._parameters import evaluate_parameter_dict, normalize_parameter_dict
from launch_ros.actions._node import joined_namespace

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable
    from typing import Any


class PushROSNamespace(Action):
    """A namespace for the nodes behind it; an absolute one takes the place of those around."""

    def __init__(self, namespace: Any, **options: Any) -> None:
        super().__init__(**options)
        checked(namespace)
        self.namespace = namespace

    def execute(self, context: LaunchContext) -> None:
        pushed, known = perform(context, self.namespace), context.launch_configurations
        before = known.get("ros_namespace")
        namespace = joined_namespace(before, pushed)
        try:
            validate_namespace(namespace or "")
        except Exception:
            raise SubstitutionFailure(
                "The resulting namespace is invalid: "
                f"[previous_namespace='{before}', pushed_namespace='{pushed}']"
            ) from None
        known["ros_namespace"] = namespace


class SetParameter(Action):
    """A parameter for the nodes behind it."""

    def __init__(self, name: Any, value: Any, **options: Any) -> None:
        super().__init__(**options)
        self._given = normalize_parameter_dict({tuple(normalize_to_list_of_substitutions(name)): value})

    @property
    def name(self) -> Any:
        """The name as a tuple of substitutions."""
        return next(iter(self._given))

    @property
    def value(self) -> Any:
        """The value, a text as a tuple of substitutions."""
        return next(iter(self._given.values()))

    def execute(self, context: LaunchContext) -> None:
        for name, value in evaluate_parameter_dict(context, self._given).items():
            _extended(context, "global_params", (name, tuple(value) if isinstance(value, list) else value))


class SetParametersFromFile(Action):
    """A file of parameters for the nodes behind it."""

    def __init__(self, filename: Any, **options: Any) -> None:
        super().__init__(**options)
        checked(filename)
        self._filename = filename

    def execute(self, context: LaunchContext) -> None:
        _extended(context, "global_params", perform(context, self._filename))


class SetRemap(Action):
    """A remapping for the nodes behind it, which precedes their own."""

    def __init__(self, src: Any, dst: Any, **options: Any) -> None:
        super().__init__(**options)
        checked(src, dst)
        self.src = src
        self.dst = dst

    def execute(self, context: LaunchContext) -> None:
        _extended(context, "ros_remaps", (perform(context, self.src), perform(context, self.dst)))


class SetUseSimTime(Action):
    """The clock of launch itself, which makes no difference here."""

    def __init__(self, value: bool, **options: Any) -> None:
        super().__init__(**options)
        self.value = value


class SetROSLogDir(Action):
    """The folder of log files for the nodes behind it, in the present one where it is relative."""

    def __init__(self, new_log_dir: Any, **options: Any) -> None:
        super().__init__(**options)
        checked(new_log_dir)
        self.log_dir = new_log_dir

    def execute(self, context: LaunchContext) -> None:
        own = os.path.join(os.environ.get("ROS_HOME") or os.path.join("~", ".ros"), "log")
        present = os.environ.get("ROS_LOG_DIR") or os.path.expanduser(own)
        os.environ["ROS_LOG_DIR"] = os.path.join(present, perform(context, self.log_dir))


class ROSTimer(TimerAction):
    """Actions that come later; ROS time is launch's own here."""


class LifecycleTransition(Action):
    """Transitions of nodes with states, which are not carried out.

    Raises ValueError: no nodes or no transitions are given.
    """

    def __init__(
        self, *, lifecycle_node_names: Iterable[Any], transition_ids: Iterable[Any], **options: Any
    ) -> None:
        super().__init__(**options)
        self._names, ids = list(lifecycle_node_names), list(transition_ids)
        if not ids:
            raise ValueError("No transition_ids provided.")
        if not self._names:
            raise ValueError("No lifecycle_node_names provided.")

    def execute(self, context: LaunchContext) -> None:
        names = ", ".join(perform(context, part) for part in self._names)
        context.untold.append(f"LifecycleTransition of {names}")


def _extended(context: LaunchContext, key: str, value: Any) -> None:
    """Add to one of the lists among the arguments. As upstream, a group adds to a list that is there before it."""
    context.launch_configurations.setdefault(key, []).append(value)
