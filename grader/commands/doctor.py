"""`grader doctor`: try every layer of the sandbox for real and say in words what is missing."""

import argparse
import json
import sys

from grader.commands.options import add_language_option
from grader.jail.doctor import run_doctor


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument("--json", action="store_true", help="print the findings as JSON / 以 JSON 输出")
    add_language_option(parser)


def run(arguments: argparse.Namespace) -> int:
    """Diagnose; 0 ready for strict mode, 1 reduced isolation only, 2 cannot run scripts."""
    diagnosis = run_doctor()
    if arguments.json:
        sys.stdout.write(json.dumps(diagnosis.to_dict(), ensure_ascii=False, indent=2) + "\n")
    else:
        sys.stdout.write(diagnosis.text(arguments.lang) + "\n")
    return diagnosis.exit_code
