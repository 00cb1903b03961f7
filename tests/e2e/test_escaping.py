"""Nothing a student writes controls the reader's terminal, whichever way it gets there."""

import json
import subprocess
import sys
import unicodedata
from collections.abc import Callable
from pathlib import Path

import pytest

Terminal = Callable[..., subprocess.CompletedProcess[str]]
EVIL = "\x1b[31m\x1b]0;title\x07\x9b2J\u202eevil\u2066\u200b<script>alert(1)</script>[bold red]\x08\r"
NAME = "square\x1b[2J\u202e.py"
SPOKEN = f"EVIL = {EVIL!r}\n"
START = SPOKEN + "import sys\nimport rclpy\nfrom rclpy.node import Node\nrclpy.init()\nnode = Node('n')\n"

SCRIPTS = {
    "prints": START + "print(EVIL)\nprint(EVIL, file=sys.stderr)\nprint(EVIL, end='')\n",
    "writes bytes": START + "sys.stdout.buffer.write(b'\\xff\\x1b[2J\\x00')\n",
    "logs": START + "node.get_logger().info(EVIL)\n",
    "raises": START + "raise ValueError(EVIL)\n",
    "raises a type of its own": START + "raise type(EVIL, (Exception,), {})(EVIL)\n",
    "in a thread": START
    + "import threading\nt = threading.Thread(target=lambda: 1 / 0, name=EVIL)\nt.start()\nt.join()\n",
    "names a parameter": START + "node.get_parameter(EVIL)\n",
    "names a topic": START + "from std_msgs.msg import String\nnode.create_publisher(String, EVIL, 1)\n",
    "says it in the source": f"x = 1\nprint('{EVIL.replace(chr(13), '')}'\n",
    "refused with it": START + "open(EVIL, 'w')\n",
    "stalls with it": START
    + "import threading\nthreading.current_thread().name = EVIL\nthreading.Event().wait()\n",
}


def hidden(text: str) -> set[str]:
    return {
        each for each in text if each != "\n" and unicodedata.category(each) in ("Cc", "Cf", "Cs", "Zl", "Zp")
    }


@pytest.mark.parametrize("name", SCRIPTS)
def test_the_terminal_shows_it_escaped(name: str, tmp_path: Path, at_terminal: Terminal) -> None:
    (tmp_path / NAME).write_text(SCRIPTS[name], encoding="utf-8", newline="")
    done = at_terminal("check", NAME, "--assignment", "square", "--lang", "en", "--logs")
    assert done.returncode in (1, 2)
    assert hidden(done.stdout + done.stderr) == set()
    assert "\\x1b" in done.stdout + done.stderr


def test_running_without_grading_shows_it_escaped(tmp_path: Path) -> None:
    (tmp_path / NAME).write_text(SCRIPTS["prints"] + "raise ValueError(EVIL)\n", encoding="utf-8")
    command = [sys.executable, "-m", "grader", "run", NAME]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert "evil" in done.stdout
    assert hidden(done.stdout + done.stderr) == set()


@pytest.mark.parametrize(
    "arguments",
    [
        ("check", f"missing{NAME}"),
        ("check", NAME, "--assignment", EVIL),
        ("assignments", "show", EVIL),
    ],
)
def test_messages_about_it_show_it_escaped(
    arguments: tuple[str, ...], tmp_path: Path, at_terminal: Terminal
) -> None:
    (tmp_path / NAME).write_text("pass\n")
    done = at_terminal(*arguments)
    assert done.returncode == 2
    assert done.stderr
    assert hidden(done.stdout + done.stderr) == set()


def test_json_is_data_and_keeps_it(tmp_path: Path, at_terminal: Terminal) -> None:
    (tmp_path / "square.py").write_text(SCRIPTS["raises"], encoding="utf-8")
    done = at_terminal("check", "square.py", "--json")
    assert json.loads(done.stdout)["runs"][0]["outcome"]["error"]["message"] == EVIL
    assert "\x1b" not in done.stdout
