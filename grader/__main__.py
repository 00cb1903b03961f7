"""`python -m grader` and the `grader` command."""

import sys

from grader.launch import launch_ahead


def main() -> None:
    """Run the command line and exit with its code."""
    arguments = sys.argv[1:]
    if arguments[:1] == ["check"]:
        launch_ahead()  # it imports the physics while this process finds out what to grade
    from grader.cli import run

    sys.exit(run(arguments))


if __name__ == "__main__":
    main()
