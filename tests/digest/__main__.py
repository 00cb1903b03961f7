"""``python -m tests.digest``: grade the corpus of reports, save its table, compare it with another."""

import argparse
import sys
import time
from pathlib import Path

from grader.grading.pipeline import Pipeline
from grader.jail import bounds
from grader.sandbox import script_sandbox
from tests.digest import (
    GOLDEN,
    Line,
    compared,
    digest,
    lines,
    lines_of_slots,
    portable,
    read,
    renewed,
    written,
)
from tests.digest.gradings import Grading, gradings, replays


def main() -> int:
    """Return 1 when a line differs from the table of `--compare`."""
    options = _parser().parse_args()
    begin_s = time.monotonic()
    chosen = [grading for grading in gradings() if any(part in grading.id for part in options.only or [""])]
    table = _table(chosen[:: options.every], options)
    _tell(f"{len(table)} reports in {time.monotonic() - begin_s:.0f} s, hash {digest(table)}")
    if options.save:
        options.save.write_text(written(table), "utf-8")
    if options.renew:
        GOLDEN.write_text(renewed(portable(table, replays(gradings()))), "utf-8")
    if not options.compare:
        return 0
    before = read(options.compare)
    print("\n".join(compared(before, table)))
    return int(any(before.get(line.id, line) != line for line in table))


def _table(chosen: list[Grading], options: argparse.Namespace) -> list[Line]:
    if not options.here:
        return lines_of_slots(chosen, options.slots, lambda done: _tell(f"{done} graded"))
    bounds.ENVIRONMENT.update(setting.split("=", 1) for setting in options.set)
    with script_sandbox("strict") as sandbox, Pipeline(sandbox) as pipeline:
        return lines(pipeline, chosen)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m tests.digest")
    parser.add_argument("--save", type=Path, metavar="FILE", help="write the table")
    parser.add_argument(
        "--compare", type=Path, metavar="FILE", help="print what differs from an earlier table"
    )
    parser.add_argument("--renew", action="store_true", help="write the sample that is committed and tested")
    parser.add_argument("--only", action="append", metavar="PART", help="ids with this part (again: or that)")
    parser.add_argument("--every", type=int, default=1, metavar="N", help="each Nth of them")
    parser.add_argument("--slots", type=int, default=2, metavar="N", help="scripts graded at once")
    parser.add_argument("--here", action="store_true", help="grade in this process, with its environment")
    parser.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", help="in the sandbox, too (--here)"
    )
    return parser


def _tell(line: str) -> None:
    print(line, file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
