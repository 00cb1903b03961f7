"""`grader receipt`: say whether a service signed a receipt, and whether a file is the one that it is about."""

import argparse
import sys
from pathlib import Path

from grader.commands.options import add_language_option, tell
from grader.commands.storage import add_data_option, opened
from grader.contracts.errors import CourseError
from grader.contracts.receipt import LONGEST_RECEIPT
from grader.contracts.text import trouble
from grader.messages import on_page
from grader.store.receipts import Receipts
from grader.store.submissions import Submissions
from grader.use_cases.receipts import checked


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument("receipt", type=Path, help="the file that the student saved / 学生保存的回执")
    parser.add_argument("--file", type=Path, help="the file that the student has / 学生手里的文件")
    add_data_option(parser)
    add_language_option(parser)


def run(arguments: argparse.Namespace) -> int:
    """Return 0; 1: the receipt is not genuine, or the file another one. Unreadable files are a CourseError."""
    text = _content(arguments.receipt)[: LONGEST_RECEIPT + 1].decode(errors="replace")
    file = b"" if arguments.file is None else _content(arguments.file)
    with opened(arguments) as storage:
        found = checked(Receipts(storage.database).key(), Submissions(storage.database), text, file)
    if found is None:
        tell(arguments, zh="这份回执不是这里签的，或者被改过", en="not signed here, or changed since")
        return 1
    keys = ["genuine", *([] if found.stored else ["lost"])]
    if found.same_file is not None:
        keys.append("same" if found.same_file else "other")
    receipt = found.receipt
    named = (receipt.course, receipt.student, receipt.assignment, receipt.file, receipt.received)
    sys.stdout.write("  ".join(one for one in named if one) + "\n")
    sys.stdout.writelines(f"{on_page(arguments.lang, f'receipts.{key}')}\n" for key in keys)
    return 1 if found.same_file is False else 0


def _content(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise CourseError.about(path, trouble(error)) from error
