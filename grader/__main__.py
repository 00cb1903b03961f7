"""`python -m grader` and the `grader` command."""

import gc
import os
import sys

from grader.grading.launch import launch_ahead

TYPE_CHECKING = False  # `typing` itself takes as long to import as all that is done before the launch
if TYPE_CHECKING:
    from typing import NoReturn


_EXIT_INTERRUPTED = 130  # as a shell reports SIGINT


def main() -> None:
    """Run the command line and exit with its code."""
    arguments = sys.argv[1:]
    try:
        if arguments[:1] == ["check"]:
            _check(arguments)
        if arguments[:1] in (["serve"], ["worker"]):
            gc.disable()  # what they import takes a tenth less time; they collect garbage once they have started
        from grader.commands.cli import run

        sys.exit(run(arguments))
    except KeyboardInterrupt:  # before the command line was there to take it
        os._exit(_EXIT_INTERRUPTED)


def _check(arguments: list[str]) -> "NoReturn":
    """Grade one file, in a process that lives for a fraction of a second and is made for it.

    The grading process imports the physics while this one finds out what to grade. Collecting garbage, and
    taking every imported module apart in the end, would take longer than all the rest of what is done here.
    """
    launch_ahead()
    gc.disable()
    from grader.commands.cli import run

    code = run(arguments)
    for stream in filter(None, (sys.stdout, sys.stderr)):
        stream.flush()
    os._exit(code)


if __name__ == "__main__":
    main()
