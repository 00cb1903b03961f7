"""`grader serve`: the HTTP service with its local workers."""

import argparse
import sys
from pathlib import Path
from typing import Any

from grader.contracts.errors import SettingsError


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments; each overrides the setting of the same name (GRADER_HOST, ...)."""
    parser.add_argument("--host", help="address to listen on (default: 127.0.0.1)")
    parser.add_argument("--port", type=int, help="port; 0 takes a free one (default: 8080)")
    parser.add_argument("--data", type=Path, metavar="DIR", help="folder of the database (default: here)")
    parser.add_argument("--slots", type=int, help="gradings at once (default: one per core)")


def run(arguments: argparse.Namespace) -> int:
    """Serve until told to stop; running gradings finish first."""
    import uvicorn

    from grader.api import create_app
    from grader.service import running
    from grader.settings import load

    settings = load(**_overrides(arguments))
    app = create_app(lambda: running(settings))
    sys.stderr.write(f"grader: http://{settings.host}:{settings.port}/api/v1/assignments\n")
    uvicorn.run(app, host=settings.host, port=settings.port, log_level="warning")
    return 0


def _overrides(arguments: argparse.Namespace) -> dict[str, Any]:
    given: dict[str, Any] = {
        name: getattr(arguments, name)
        for name in ("host", "port", "slots")
        if getattr(arguments, name) is not None
    }
    if arguments.data is not None:
        try:
            arguments.data.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise SettingsError(f"--data {arguments.data}: {error.strerror}") from error
        given["database_url"] = f"sqlite:///{(arguments.data / 'grader.db').resolve()}"
    return given
