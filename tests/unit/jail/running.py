"""A sandbox around scripts that talk in bare frames."""

from pathlib import Path

from grader.contracts.assignment import Limits
from grader.jail.ending import JailReport
from grader.sandbox import Layer, Mode, Sandbox

RUNNER = Path(__file__).parents[2] / "hostile" / "runner"


def make(mode: Mode = Mode.STRICT, *without: Layer, entry: str = "bare_runner:run") -> Sandbox:
    return Sandbox(mode, RUNNER, entry=entry, without=frozenset(without))


def run(sandbox: Sandbox, source: str | bytes, **limits: float) -> tuple[list[bytes], JailReport]:
    with sandbox.open(Limits(**limits)) as jail:  # type: ignore[arg-type]
        jail.send(source if isinstance(source, bytes) else source.encode())
        frames = []
        while (frame := jail.receive()) is not None:
            frames.append(frame)
        return frames, jail.close()
