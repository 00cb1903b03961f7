"""Printing is counted: a flood ends at the same byte in each run, and everything before it arrives."""

from collections.abc import Callable
from typing import Any

import pytest

RunScript = Callable[..., Any]
PRINTED_TOO_MUCH = 4


@pytest.mark.parametrize(
    ("source", "stdout", "stderr"),
    [
        ("while True: print('abcdefg')", "abcdefg\n" * 12 + "abcd", ""),
        ("print('x' * 1000)", "x" * 100, ""),
        ("import sys\nwhile True: print('ab'); print('c', file=sys.stderr)", "ab\n" * 20, "c\n" * 20),
        (
            "import sys\nwhile True: sys.stdout.buffer.write(b'1234567'); sys.stdout.flush()",
            "1234567" * 14 + "12",
            "",
        ),
        ("import sys\nsys.stdout.buffer.raw.write(bytes(200))", "\0" * 100, ""),
        ("while True: print('中')", "中\n" * 25, ""),
    ],
)
def test_a_flood_is_cut_at_the_limit(run_bare: RunScript, source: str, stdout: str, stderr: str) -> None:
    run = run_bare(source, output_bytes=100)
    assert (run.stdout, run.stderr) == (stdout, stderr)
    assert run.exit["reason"] == PRINTED_TOO_MUCH


def test_logs_count_as_well_and_those_before_the_end_arrive(run_script: RunScript) -> None:
    source = (
        "import rclpy\nfrom rclpy.node import Node\nrclpy.init()\nnode = Node('n')\n"
        "while True: node.get_logger().info('word')\n"
    )
    run, again = run_script(source, output_bytes=1000), run_script(source, output_bytes=1000)
    assert len(run.stderr.encode()) == 1000
    assert run.exit["reason"] == PRINTED_TOO_MUCH
    assert run.raw == again.raw
    assert run.stderr == again.stderr


def test_a_flood_in_a_thread_ends_the_run(run_bare: RunScript) -> None:
    run = run_bare(
        "import threading, time\ndef flood():\n    while True: print('x' * 50)\n"
        "threading.Thread(target=flood).start()\ntime.sleep(9)\n",
        output_bytes=100,
    )
    assert run.exit["reason"] == PRINTED_TOO_MUCH
    assert len(run.stdout) == 100


def test_exactly_the_limit_is_allowed(run_bare: RunScript) -> None:
    run = run_bare("print('x' * 99)", output_bytes=100)
    assert (len(run.stdout), run.exit["reason"]) == (100, 0)


def test_the_streams_look_as_on_a_pc(run_bare: RunScript) -> None:
    run = run_bare(
        "import io, sys\nfor s in (sys.stdin, sys.stdout, sys.stderr):\n"
        "    print(s.fileno(), s.encoding, s.errors, s.mode, s.isatty(), s.readable(), s.writable())\n"
        "print(sys.stdout.name, sys.stdout.line_buffering, sys.stdout is sys.__stdout__, type(sys.stdout))\n"
        "print('\\udc80', file=sys.stderr)\nsys.stdout.reconfigure(line_buffering=False)\n"
        "print('half a line', end='')\n",
    )
    assert run.stdout == (
        "0 utf-8 strict r False True False\n1 utf-8 strict w False False True\n"
        "2 utf-8 backslashreplace w False False True\n<stdout> True True <class '_io.TextIOWrapper'>\nhalf a line"
    )
    assert run.stderr == "\\udc80\n"


def test_a_closed_stream_is_no_flood(run_bare: RunScript) -> None:
    run = run_bare(
        "import sys\nsys.stdout.close()\ntry: print('x')\nexcept ValueError as e: sys.exit(str(e))\n"
    )
    assert run.exit["code"] == 1
    assert "closed file" in run.stderr
