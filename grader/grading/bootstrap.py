"""Composition root: from settings to the concrete parts of a grading process."""

from grader.contracts.errors import SettingsError
from grader.grading.slot import SlotConfig
from grader.sandbox import Mode, Sandbox

PRELOADED = ("rclpy._process.warm",)  # paid once per zygote, not once per run
SYNTAX_CHECK = "rclpy._process.syntax:run"


def build_sandbox(config: SlotConfig) -> Sandbox:
    """Start the sandbox that `config` asks for.

    Raises:
        SettingsError: unknown mode.
        SandboxUnavailableError: this host lacks a layer that the mode requires.
    """
    return Sandbox(_mode(config), preload=PRELOADED)


def build_syntax_sandbox(config: SlotConfig) -> Sandbox:
    """Start a sandbox as confined as `build_sandbox`'s, whose processes compile a script and run nothing.

    Raises as `build_sandbox` does.
    """
    return Sandbox(_mode(config), entry=SYNTAX_CHECK)


def _mode(config: SlotConfig) -> Mode:
    try:
        return Mode(config.mode)
    except ValueError as error:
        raise SettingsError(f"isolation: {config.mode!r} is not one of {', '.join(Mode)}") from error
