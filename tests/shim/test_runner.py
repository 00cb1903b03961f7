"""What Python does around a script: `__main__`, streams, exceptions, exit codes."""

import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.shim.conftest import PYTHON

RunScript = Callable[..., Any]
_ADDRESS = re.compile(r"0x[0-9a-f]+")


def test_the_script_is_main(run_bare: RunScript) -> None:
    run = run_bare(
        "import sys, __main__, pickle\nprint(__name__, __file__, sys.argv, __main__.__dict__ is globals())\n"
        "class A: pass\nprint(type(pickle.loads(pickle.dumps(A()))) is A, __doc__, __spec__, sys.path[0])\n",
        args=["--speed", "2"],
        file_name="square.py",
    )
    assert run.stdout == (
        "__main__ square.py ['square.py', '--speed', '2'] True\nTrue None None /home/student/ros2_ws\n"
    )
    assert run.returncode == 0


def test_nothing_of_the_grader_is_in_reach(run_bare: RunScript) -> None:
    run = run_bare("import sys\nprint([m for m in sys.modules if m.split('.')[0] in ('grader', 'numpy')])\n")
    assert run.stdout == "[]\n"


@pytest.mark.parametrize("size", [1, 100, 30_000])
def test_input_reads_stdin_and_ends(run_bare: RunScript, size: int) -> None:
    text = "3\n" * size
    run = run_bare(
        "import sys\nn = int(input('边长? '))\nprint(n + 1, len(sys.stdin.read()))\ninput()\n", stdin=text
    )
    assert run.stdout == f"边长? 4 {len(text) - 2}\n"
    assert (run.exit["type"], run.exit["line"]) == ("EOFError", 4)
    assert run.exit["message"] == "EOF when reading a line"


def test_without_stdin_input_ends_at_once(run_bare: RunScript) -> None:
    assert run_bare("input()\n").exit["type"] == "EOFError"


@pytest.mark.parametrize(
    "ask",
    [
        "try: float(input()); break\n    except (ValueError, EOFError): pass",
        "if sys.stdin.readline().strip(): break",
        "if sys.stdin.read(): break",
        "for line in sys.stdin: break",
    ],
)
def test_a_loop_that_asks_again_and_again_gets_ctrl_c(run_bare: RunScript, ask: str) -> None:
    source = f"import sys\nprint(sys.stdin.mode, sys.stdin.encoding)\nwhile True:\n    {ask}\n"
    run = run_bare(source, steps=1_500_000)
    assert (run.stdout, run.exit["reason"], run.exit["after_interrupt"]) == ("r utf-8\n", 0, 1)
    assert ("asks_again", "") in run.notes
    assert "runner" not in run.stderr


def test_a_thread_that_asks_for_ever_keeps_nobody_from_the_end(run_bare: RunScript) -> None:
    """At home it waits in a terminal, and says nothing about what the others do."""
    run = run_bare(
        "import threading, time\ndef ask():\n    while True:\n        try: input()\n"
        "        except EOFError: pass\nthreading.Thread(target=ask, daemon=True).start()\n"
        "for _ in range(20): time.sleep(1)\nprint('done')\n",
        steps=1_500_000,
    )
    assert (run.stdout, run.exit["reason"]) == ("done\n", 0)
    assert "asks_again" not in dict(run.notes)


@pytest.mark.parametrize(
    ("call", "code", "stderr"),
    [
        ("sys.exit()", 0, ""),
        ("sys.exit(3)", 3, ""),
        ("sys.exit('no\u2026')", 1, "no\u2026\n"),
        ("raise SystemExit(True)", 1, ""),
        ("exit(2)", 2, ""),
        ("quit()", 0, ""),
    ],
)
def test_exit_codes(run_bare: RunScript, call: str, code: int, stderr: str) -> None:
    run = run_bare(f"import sys\nprint('x')\n{call}\n")
    assert (run.exit["reason"], run.exit["code"], run.returncode) == (0, code, code)
    assert (run.stdout, run.stderr) == ("x\n", stderr)


def test_os_exit_ends_at_once_without_exit_handlers(run_bare: RunScript) -> None:
    run = run_bare("import atexit, os\natexit.register(print, 'never')\nprint('x')\nos._exit(4)\n")
    assert (run.stdout, run.exit["code"], run.returncode) == ("x\n", 4, 4)


def test_exit_handlers_run_after_an_exception(run_bare: RunScript) -> None:
    run = run_bare("import atexit, time\natexit.register(print, 'bye')\n1 / 0\n")
    assert run.stdout == "bye\n"
    assert run.exit["type"] == "ZeroDivisionError"


def test_a_traceback_shows_the_students_frames_and_every_cause(run_bare: RunScript) -> None:
    run = run_bare(
        "import json\ndef parse():\n    return json.loads('{')\ndef main():\n    try:\n        parse()\n"
        "    except ValueError as e:\n        raise RuntimeError('bad') from e\nmain()\n"
    )
    assert run.exit["text"] == run.stderr
    assert run.exit["line"] == 8
    assert [line for line in run.stderr.splitlines() if line.startswith("  File")] == [
        '  File "student.py", line 6, in main',
        '  File "student.py", line 3, in parse',
        '  File "student.py", line 9, in <module>',
        '  File "student.py", line 8, in main',
    ]
    assert "direct cause" in run.stderr
    assert "json.loads('{')" in run.stderr


def test_a_syntax_error_is_reported_as_python_does(run_bare: RunScript) -> None:
    run = run_bare("x = 1\nprint('a'\ny = 2\n")
    end = run.exit
    assert run.frames == [end]  # only as the first frame is it believed
    assert (end["reason"], end["type"], end["line"], end["message"]) == (
        3,
        "SyntaxError",
        2,
        "'(' was never closed",
    )
    assert run.stderr == (
        "  File \"student.py\", line 2\n    print('a'\n         ^\nSyntaxError: '(' was never closed\n"
    )


@pytest.mark.parametrize(
    ("source", "kind", "line"),
    [
        (b"while True: pass\nreturn 1\n", "SyntaxError", 2),
        (b"def f():\nreturn 1\n", "IndentationError", 2),
        (b"if 1:\n\tx = 1\n        y = 2\n", "TabError", 3),
        (b"x = 1\x00", ("SyntaxError", "ValueError"), None),
        (b"x = '\xff'\n", "SyntaxError", None),
        (b"# coding: nonsense\n", "SyntaxError", None),
    ],
)
def test_other_syntax_errors(run_bare: RunScript, source: bytes, kind: Any, line: int | None) -> None:
    end = run_bare(source).exit
    assert end["reason"] == 3
    assert end["type"] in (kind if isinstance(kind, tuple) else (kind,))
    assert line is None or end["line"] == line


def test_a_compiler_error_shows_its_line(run_bare: RunScript) -> None:
    assert "\n    return 1\n" in run_bare("while True:\n    pass\nreturn 1\n").stderr


def test_chinese_text_comes_out_as_utf8_whatever_the_source_is_in(run_bare: RunScript) -> None:
    run = run_bare(
        "# -*- coding: gbk -*-\nprint('正方形 🎉'[:3])\n1/0 # 错\n".replace("🎉", "圆").encode("gbk")
    )
    assert run.stdout == "正方形\n"
    assert "1/0 # 错" in run.stderr


def test_a_lone_surrogate_cannot_be_printed_but_does_no_harm(run_bare: RunScript) -> None:
    end = run_bare("raise ValueError('\\ud800')\n").exit
    assert end["message"] == "?"


def test_long_texts_are_cut(run_bare: RunScript) -> None:
    end = run_bare("raise type('L' * 3000, (Exception,), {})('好' * 9000)\n").exit
    assert len(end["type"].encode()) == 1024
    assert 4093 <= len(end["message"].encode()) <= 4096
    assert 16_380 <= len(end["text"].encode()) <= 16_384


def test_an_exception_whose_str_fails(run_bare: RunScript) -> None:
    end = run_bare("class E(Exception):\n    def __str__(self): raise OSError\nraise E\n").exit
    assert (end["type"], end["message"], end["line"]) == ("E", "<exception str() failed>", 3)


def test_recursion_without_end(run_bare: RunScript) -> None:
    end = run_bare("def f(): f()\nf()\n").exit
    assert (end["type"], end["line"]) == ("RecursionError", 1)
    assert "more times" in end["text"]


def test_an_exception_group_keeps_its_members(run_bare: RunScript) -> None:
    text = run_bare("raise ExceptionGroup('two', [ValueError('a'), KeyError('b')])\n").exit["text"]
    assert "ValueError: a" in text
    assert "KeyError: 'b'" in text


def test_the_scripts_own_excepthook(run_bare: RunScript) -> None:
    run = run_bare("import sys\nsys.excepthook = lambda t, e, tb: print('mine', t.__name__)\n1 / 0\n")
    assert (run.stdout, run.stderr, run.exit["type"]) == ("mine ZeroDivisionError\n", "", "ZeroDivisionError")


IGNORED = """\
import atexit, io, sys
class Own(Exception): pass
class Bad(ValueError):
    def __str__(self): raise OSError
class A:
    def __init__(self, error): self.error = error
    def __del__(self):
        if self.error: raise self.error
        open('/nonexistent/x')
for error in None, ValueError(), Own('two\\nlines'), io.UnsupportedOperation('no'), Bad(): A(error)
class Handler:
    def __repr__(self): raise OSError
    def __call__(self):
        try: 1 / 0
        except ZeroDivisionError: raise KeyError('x')
atexit.register(Handler())
@atexit.register
def save():
    with open('/nonexistent/log'): pass
atexit.register(sys.exit, 3)
"""


def test_ignored_exceptions_are_told_as_by_python_without_our_frames(
    run_bare: RunScript, tmp_path: Path
) -> None:
    (tmp_path / "student.py").write_text(IGNORED)
    own = subprocess.run(
        [PYTHON, "-S", "student.py"], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    run = run_bare(IGNORED)
    assert run.returncode == 0
    python, shim = (_ADDRESS.sub("0x", text).splitlines() for text in (own.stderr, run.stderr))
    assert "Traceback" in own.stderr
    if sys.version_info >= (3, 13):  # which marks no places in these tracebacks
        shim = [line for line in shim if line.strip(" ~^")]
    assert shim == [line.replace(f"{tmp_path}/", "") for line in python]


@pytest.mark.parametrize(
    "stderr", ["None", "Failing()", "type('Deep', (), {'write': lambda self, text: self.write(text)})()"]
)
def test_an_ignored_exception_is_ignored_when_it_cannot_be_told(run_bare: RunScript, stderr: str) -> None:
    run = run_bare(
        "import sys\nclass Failing:\n    def write(self, text): raise KeyboardInterrupt\n"
        "class A:\n    def __del__(self): 1 / 0\n"
        f"sys.stderr = {stderr}\nA()\nsys.stderr = sys.__stderr__\nprint('on')\n"
    )
    assert (run.stdout, run.stderr) == ("on\n", "")


def test_the_scripts_own_unraisablehook(run_bare: RunScript) -> None:
    run = run_bare(
        "import sys\nclass A:\n    def __del__(self): 1 / 0\n"
        "sys.unraisablehook = lambda args: print('mine', args.exc_type.__name__)\nA()\n"
        "sys.unraisablehook = sys.__unraisablehook__\nA()\n"
    )
    assert run.stdout == "mine ZeroDivisionError\n"
    assert "in __del__\n    def __del__(self): 1 / 0\n" in run.stderr
    assert run.stderr.endswith("\nZeroDivisionError: division by zero\n")


def test_a_keyboard_interrupt_of_the_scripts_own_is_an_exception(run_bare: RunScript) -> None:
    end = run_bare("raise KeyboardInterrupt\n").exit
    assert (end["reason"], end["after_interrupt"], end["type"]) == (1, 0, "KeyboardInterrupt")


def test_closed_and_replaced_streams_do_no_harm(run_bare: RunScript) -> None:
    run = run_bare("import sys\nprint('x')\nsys.stdout.close()\nsys.stderr = None\n1 / 0\n")
    assert (run.stdout, run.exit["type"]) == ("x\n", "ZeroDivisionError")


def test_print_exc_and_inspect_find_the_source(run_bare: RunScript) -> None:
    run = run_bare(
        "import traceback, inspect, sys\ndef f():\n    return 1\nprint(inspect.getsource(f), end='')\n"
        "try:\n    1 / 0\nexcept Exception:\n    traceback.print_exc(file=sys.stdout)\n"
    )
    assert run.stdout.startswith("def f():\n    return 1\nTraceback")
    assert "\n    1 / 0\n" in run.stdout


def test_tracebacks_that_a_script_shows_have_its_frames_only(run_bare: RunScript) -> None:
    run = run_bare(
        "import asyncio, logging, traceback, json\nfrom concurrent.futures import ThreadPoolExecutor\n"
        "def f():\n    json.loads('{')\nasync def main():\n    asyncio.get_running_loop().call_soon(f)\n"
        "asyncio.run(main())\n"
        "try:\n    ThreadPoolExecutor().submit(f).result()\nexcept ValueError as error:\n"
        "    logging.exception('oops')\n    traceback.print_tb(error.__traceback__)\n"
    )
    places = [line for line in run.stderr.splitlines() if line.startswith("  File")]
    in_f, in_module = '  File "student.py", line 4, in f', '  File "student.py", line 9, in <module>'
    assert places == [in_f, in_module, in_f, in_module, in_f]


def test_what_was_printed_survives_a_kill(run_bare: RunScript) -> None:
    run = run_bare("print('before')\nfor _ in iter(int, 1): pass\n", cpu_s=1)
    assert run.stdout == "before\n"
    assert run.returncode < 0


def test_a_lone_loop_on_a_constant_flag_runs_into_the_cpu_limit(run_bare: RunScript) -> None:
    run = run_bare("done = False\nwhile not done:\n    pass\n", cpu_s=1)
    assert run.returncode < 0
    assert [(frame["kind"], frame["code"]) for frame in run.frames] == [("NOTE", "started")]


COUNTED = {
    "a loop": ("n = 0\nwhile True: n += 1\n", 10_000, 0),
    "sleeps": ("import time\nwhile True: time.sleep(0.001)\n", 1_000, 1.0),
    "sleeps and looks": (
        "import time\nwhile True: time.sleep(0.001); time.time(); time.time()\n",
        3_000,
        1.002,
    ),
    "callbacks": (
        "import rclpy\nrclpy.init(); node = rclpy.create_node('a')\n"
        "node.create_timer(0.001, lambda: None); rclpy.spin(node)\n",
        2_000,
        1.0,
    ),
    "threads": (
        "import threading, time\ndef work():\n    while True: time.sleep(0.001)\n"
        "threading.Thread(target=work).start(); work()\n",
        8_000,
        1.0,
    ),
}


@pytest.mark.parametrize("name", COUNTED)
def test_a_script_that_makes_too_many_steps_ends_at_the_same_place(run_script: RunScript, name: str) -> None:
    source, steps, end_s = COUNTED[name]
    ends = [run_script(source, steps=steps).exit for _ in range(2)]
    assert ends[0] == ends[1]
    assert (ends[0]["reason"], ends[0]["after_interrupt"]) == (5, 0)
    assert ends[0]["t_ns"] == pytest.approx(end_s * 1e9, rel=0.02)
    enough = run_script(source, steps=20 * steps, horizon_s=1.0)
    assert enough.exit["reason"] == (5 if name == "a loop" else 0)


def test_a_busy_loop_may_wait_for_a_thread_of_1_khz(run_script: RunScript) -> None:
    source = (
        "import threading, time\ndone = False\n"
        "def work():\n    for _ in range(3000): time.sleep(0.001)\n    global done; done = True\n"
        "threading.Thread(target=work).start()\nwhile not done: pass\nprint('done')\n"
    )
    run = run_script(source, steps=75_000)  # as many for 3 s as there are for 60 s
    assert (run.stdout, run.exit["reason"]) == ("done\n", 0)


def test_after_ctrl_c_a_script_has_a_tenth_of_its_steps_left(run_script: RunScript) -> None:
    source = "import time\ntry: time.sleep(10)\nexcept KeyboardInterrupt:\n    while True: pass\n"
    run = run_script(source, steps=100_000, horizon_s=1.0)
    assert (run.exit["reason"], run.exit["after_interrupt"]) == (5, 1)


def test_forbidden_calls_are_noted_once(run_bare: RunScript) -> None:
    run = run_bare(
        "import os, subprocess, socket\n"
        "for _ in range(2):\n"
        "    try: open('/nonexistent/x', 'w')\n    except OSError: pass\n"
        "    try: subprocess.run(['/nonexistent/ls'])\n    except OSError: pass\n"
        "    try: socket.socket().connect(('127.0.0.1', 1))\n    except OSError: pass\n"
        "open('/dev/null', 'w').close(); open('/dev/null').close()\n"
    )
    assert {code for code, _ in run.notes} == {"forbidden"}
    calls = [text.split(":")[0] for _, text in run.notes]
    assert {"open for writing", "subprocess.Popen", "socket.connect"} <= set(calls)
    assert len(calls) == len(set(calls))


@pytest.mark.parametrize(
    ("call", "error"),
    [
        ("open('/out.txt', 'w')", "[Errno 13] Permission denied: '/out.txt'"),
        ("open(b'/out.txt', 'ab')", "[Errno 13] Permission denied: b'/out.txt'"),
        ("os.open('/out.txt', os.O_CREAT | os.O_RDWR)", "[Errno 13] Permission denied: '/out.txt'"),
        ("pathlib.Path('/out.txt').write_text('x')", "[Errno 13] Permission denied: '/out.txt'"),
        ("os.remove('/a')", "[Errno 1] Operation not permitted: '/a'"),
        ("os.makedirs('/a/b')", "[Errno 1] Operation not permitted: '/a'"),
        ("os.rename('a', '/a')", "[Errno 1] Operation not permitted: 'a' -> '/a'"),
        ("os.symlink('a', 'b')", "[Errno 1] Operation not permitted: 'a'"),
        ("os.fork()", "[Errno 1] Operation not permitted"),
        ("subprocess.run(['ls', '-l'])", "[Errno 1] Operation not permitted: 'ls'"),
        ("socket.create_connection(('127.0.0.1', 9))", "[Errno 1] Operation not permitted: '127.0.0.1'"),
    ],
)
def test_what_the_sandbox_would_refuse_is_refused_alike_everywhere(
    run_bare: RunScript, call: str, error: str
) -> None:
    run = run_bare(f"import os, pathlib, socket, subprocess\n{call}\n")
    assert (run.exit["type"], run.exit["message"], run.exit["line"]) == ("PermissionError", error, 2)
    assert [code for code, _ in run.notes] == ["forbidden"]


UNDEFINED = ("caught", "line 3: NameError: name 'oops' is not defined")
WRONG = ("caught", "line 4: TypeError: float() argument must be a string or a real number, not 'list'")


@pytest.mark.parametrize(
    ("rest", "told"),
    [
        ("try: go()\nexcept: pass\ntry: gone()\nexcept Exception: pass\n", [UNDEFINED]),
        ("try: go()\nexcept NameError: pass\n", []),
        ("try: 1 / 0\nexcept Exception: pass\n", []),
        (
            "try: time.sleepp\nexcept Exception: pass\n",
            [
                (
                    "caught",
                    "line 4: AttributeError: module 'time' has no attribute 'sleepp'. Did you mean: 'sleep'?",
                )
            ],
        ),
        ("try: None.x\nexcept Exception: pass\n", []),
        ("try: raise TypeError\nexcept Exception: pass\ntry: go()\nexcept Exception: pass\n", [UNDEFINED]),
        ("def hear():\n    global pose, at\n    pose = 1\ntry: pose\nexcept Exception: pass\n", []),
        ("def hear(node):\n    node.pose: int = 1\ntry: time.pose\nexcept: pass\n", []),
        ("time.x, time.pose = 1, 2\ndel time.pose\ntry: time.pose\nexcept: pass\n", []),
        (
            "try: time.pose == time.poses\nexcept: pass\n",
            [("caught", "line 4: AttributeError: module 'time' has no attribute 'pose'")],
        ),
        ("try: raise TypeError('no side')\nexcept Exception: pass\n", []),
        ("try: assert not go, 'no side'\nexcept Exception: pass\n", []),
        ("def again():\n    try: go()\n    except: raise\ntry: again()\nexcept: pass\n", [UNDEFINED]),
        ("try: float([])\nexcept Exception: pass\n", [WRONG]),
        ("class Late(TypeError): pass\ntry: raise Late\nexcept Exception: pass\n", []),
        ("try: time.sleep(99)\nexcept KeyboardInterrupt:\n    try: go()\n    except Exception: pass\n", []),
        ("try: go()\nfinally: time.sleep(99)\n", [UNDEFINED]),
        ("from concurrent.futures import ThreadPoolExecutor as P\nP().submit(go)\n", [UNDEFINED]),
        (
            "import asyncio\nasync def run(): go()\nasync def main():\n"
            "    asyncio.create_task(run())\n    await asyncio.sleep(1)\nasyncio.run(main())\n",
            [UNDEFINED],
        ),
    ],
)
def test_an_error_of_the_text_that_is_caught_is_told_once(
    run_bare: RunScript, rest: str, told: list[tuple[str, str]]
) -> None:
    run = run_bare("import time\ndef go():\n    oops\n" + rest, horizon_s=5)
    assert [note for note in run.notes if note[0] == "caught"] == told


@pytest.mark.parametrize(
    ("file_name", "line", "text"),
    [
        ("rclpy.py", "from rclpy.node import Node", "No module named 'rclpy.node'; 'rclpy' is not a package"),
        (
            "random.py",
            "import random; random.choice([1])",
            "partially initialized module 'random' has no attribute",
        ),
        (
            "turtlesim.py",
            "from turtlesim.msg import Pose",
            "No module named 'turtlesim.msg'; 'turtlesim' is not",
        ),
    ],
)
def test_a_script_named_like_what_it_imports_finds_itself(
    run_script: RunScript, file_name: str, line: str, text: str
) -> None:
    run = run_script(f"import rclpy, os\n{line}\n", file_name=file_name)
    assert run.exit["message"].startswith(text)
    frames = [place for place in run.stderr.splitlines() if place.startswith("  File")]
    assert [place.split('"')[1] for place in frames] == [file_name] * 2  # as a script, and as a module


def test_a_script_named_like_a_module_written_in_c_gets_that(run_script: RunScript) -> None:
    run = run_script("import time\nprint(time.sleep(1))\n", file_name="time.py")
    assert run.stdout == "None\n"


def test_at_the_end_of_python_no_message_can_be_made_and_nothing_be_logged(run_script: RunScript) -> None:
    """As recorded (style__stop_in_destructor, c27_del_log): both import something."""
    run = run_script(
        "import rclpy\nfrom rclpy.node import Node\nfrom geometry_msgs.msg import Twist\n"
        "class Careful(Node):\n    def __init__(self):\n        super().__init__('careful')\n"
        "        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)\n        self.made = Twist()\n"
        "    def __del__(self):\n        self.pub.publish(self.made)\n        print('sent')\n"
        "        self.pub.publish(Twist())\n        print('stopped')\n"
        "rclpy.init()\nnode = Careful()\n"
    )
    assert run.stdout == "sent\n"
    assert run.stderr.endswith("\nImportError: sys.meta_path is None, Python is likely shutting down\n")
    assert len(run.published("/turtle1/cmd_vel")) == 1
