"""The progress of a long command, on standard error if that is a terminal."""

from collections.abc import Generator, Sequence

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn


def followed(names: Sequence[str]) -> Generator[str, None, None]:
    """Yield `names`, showing which is under way and how many are done; nothing of it remains at the end.

    A reader that may fail closes it (`contextlib.closing`); otherwise it draws over the error message.
    """
    console = Console(stderr=True)
    columns = (BarColumn(), MofNCompleteColumn(), TextColumn("{task.description}", markup=False))
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task("", total=len(names))
        for name in names:
            progress.update(task, description=name, refresh=True)
            yield name
            progress.advance(task)
