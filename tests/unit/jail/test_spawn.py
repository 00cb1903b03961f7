"""The zygote's interpreter, before it is told anything."""

import io
import os
import subprocess
import sys
from pathlib import Path
from typing import IO

import pytest

from grader.jail import spawn

_OWN_GROUP = Path("/proc/self/autogroup")
_NICE_PARENT = """
import time
from pathlib import Path
from grader.jail import spawn

try:
    Path("/proc/self/autogroup").write_text("7")
except OSError:
    raise SystemExit("not allowed")
time.sleep(0.2)  # from whoever is no administrator the kernel takes one change in 0.1 s
interpreter = spawn.spawn()
print(Path(f"/proc/{interpreter.pid}/autogroup").read_text())
interpreter.end()
"""


@pytest.mark.skipif(not _OWN_GROUP.exists(), reason="this kernel does not group processes by session")
def test_it_gives_way_as_much_as_the_process_that_started_it() -> None:
    parent = subprocess.run(
        [sys.executable, "-c", _NICE_PARENT],
        capture_output=True,
        text=True,
        check=True,
        start_new_session=True,
    )
    assert parent.stdout.split()[-2:] == ["nice", "7"]


@pytest.mark.parametrize("shown", ["", None])
def test_it_starts_where_processes_are_in_no_group(
    shown: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Below an init that began no session the file is empty; other kernels do not have it."""

    def read_group(path: str, encoding: str) -> IO[str]:
        if shown is None:
            raise FileNotFoundError(path)
        return io.StringIO(shown)

    monkeypatch.setattr(spawn, "open", read_group, raising=False)
    interpreter = spawn.spawn()
    assert interpreter.alive
    interpreter.end()
    with pytest.raises(ProcessLookupError):
        os.kill(interpreter.pid, 0)
