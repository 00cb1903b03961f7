"""`grader worker`: grades what services on the same database accept, without serving itself."""

import argparse
import gc
import logging
import signal
import sys
import threading
from contextlib import closing
from pathlib import Path

from grader.commands.options import add_language_option, whole_number
from grader.contracts.errors import SettingsError

_log = logging.getLogger(__name__)


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments; each overrides the setting of the same name (GRADER_SLOTS, ...)."""
    parser.add_argument("--database-url", metavar="URL", help="the services' database / 服务所用的数据库")
    parser.add_argument(
        "--data", type=Path, metavar="DIR", help="folder of a database that is a file / 数据库文件所在文件夹"
    )
    parser.add_argument("--slots", type=whole_number, help="gradings at once (one per core) / 同时评几份")
    parser.add_argument(
        "--service", type=whole_number, help=argparse.SUPPRESS
    )  # by `grader serve`: a descriptor
    add_language_option(parser)


def run(arguments: argparse.Namespace) -> int:
    """Grade until told to stop; running gradings finish first. A second signal does not wait for them."""
    from grader.commands.storage import database_url, refuse_missing
    from grader.operation import logs
    from grader.operation.settings import load
    from grader.service.composition import running_worker
    from grader.store.database import Database

    url = database_url(arguments.data, create=False) or arguments.database_url
    settings = load(database_url=url, slots=arguments.slots)
    if not settings.slots:
        raise SettingsError(
            "slots (GRADER_SLOTS): a worker without slots would grade nothing",
            "slots (GRADER_SLOTS)：没有槽位的评分进程什么也评不了",
        )
    with closing(Database(settings.database_url)) as database:
        refuse_missing(database)
    logs.configure(settings.log_format, settings.log_level)
    stopped = threading.Event()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))  # starting may take as long as an upgrade
    with running_worker(settings, arguments.service, stopped) as worker:
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, lambda received, _: _stop(stopped, received))
        gc.collect()
        gc.freeze()
        gc.enable()
        _log.info("worker %s grades, %d at once", worker.id, settings.slots)
        stopped.wait()
    return 0


def _stop(stopped: threading.Event, received: int) -> None:
    signal.signal(received, signal.SIG_DFL)
    stopped.set()
