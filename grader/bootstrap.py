"""Composition root: from settings to the concrete parts of a grading process."""

from grader.contracts.errors import SettingsError
from grader.sandbox import Mode, Sandbox
from grader.slot import SlotConfig

PRELOADED = ("rclpy._warm",)  # paid once per zygote, not once per run


def build_sandbox(config: SlotConfig) -> Sandbox:
    """Start the sandbox that `config` asks for.

    Raises:
        SettingsError: unknown mode.
        SandboxUnavailableError: this host lacks a layer that the mode requires.
    """
    try:
        mode = Mode(config.mode)
    except ValueError as error:
        raise SettingsError(f"isolation: {config.mode!r} is not one of {', '.join(Mode)}") from error
    return Sandbox(mode, preload_numpy=config.preload_numpy, namespaces=config.namespaces, preload=PRELOADED)
