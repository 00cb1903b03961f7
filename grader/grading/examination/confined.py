"""The process that reads one uploaded folder: its path as argument, a `Reading` as JSON on standard output.

Once everything is imported it gives away what it does not need: it may read Python's files and the folder, write
nothing, speak to no network, and has little memory and time. Where the kernel has no Landlock, the limits of
memory, time and files remain.
"""

import gc
import json
import resource
import sys
from pathlib import Path

from grader import contracts
from grader.catalog import Catalog
from grader.catalog.document import Document
from grader.catalog.files import SPEC_NAME
from grader.catalog.misfits import refusals
from grader.contracts.assignment import Assignment
from grader.contracts.errors import AssignmentError
from grader.contracts.record import to_plain
from grader.grading.examination import misfits
from grader.grading.examination.reading import TOO_MUCH, Reading, misfits_of
from grader.jail import landlock, libc, readers

MAX_MEMORY_BYTES = 1536 * 1024 * 1024
MAX_CPU_S = 20


def main(path: str) -> int:
    """Read the folder at `path`; return 0, or `TOO_MUCH`."""
    gc.freeze()
    gc.enable()  # the one that starts this process turns it off
    folder = Path(path)
    _confine(folder)
    try:
        reading = _read(folder)
    except (MemoryError, RecursionError):
        return TOO_MUCH
    sys.stdout.write(json.dumps(reading, default=to_plain))
    return 0


def _read(folder: Path) -> Reading:
    catalog = Catalog(folder.parent)
    try:
        document = Document.read(folder / SPEC_NAME)
        assignment = document.assignment()
        wrong = catalog.wrong_attempts(folder.name)
        changed = catalog.changed_scripts(folder.name)
        for name in ("solution", "starter"):
            catalog.own_file(assignment, name)
        _check(catalog, assignment)
    except AssignmentError as error:
        return Reading(misfits=misfits_of(error, str(folder)))
    texts = {name: text.decode() for name, text in changed.items()}
    return Reading(assignment=assignment, wrong=wrong, changed=texts)


def _check(catalog: Catalog, assignment: Assignment) -> None:
    misfits_at = [(catalog.place(assignment.id, field), told) for field, told in misfits(assignment)]
    if misfits_at:
        raise refusals(misfits_at)


def _confine(folder: Path) -> None:
    readers.limit(MAX_MEMORY_BYTES, MAX_CPU_S)
    for name, bound in ((resource.RLIMIT_FSIZE, 0), (resource.RLIMIT_NOFILE, 64)):
        resource.setrlimit(name, (bound, bound))
    if landlock.abi_version():
        package = Path(contracts.__path__[0]).parents[1]
        readable = {sys.prefix, sys.base_prefix, str(package), str(folder.parent), *filter(None, sys.path)}
        libc.prctl(libc.PR_SET_NO_NEW_PRIVS, 1)
        landlock.restrict_self(landlock.create_ruleset(sorted(readable), ()))
