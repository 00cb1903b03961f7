"""Files that a script writes: in its home and in /tmp they behave as on a PC, and nothing of them is real."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.shim.conftest import PYTHON

RunScript = Callable[..., Any]
STEPS = Path(__file__).with_name("scripts") / "file_steps.py"
COUNT = "600"


@pytest.mark.parametrize("seed", ["1", "2", "3"])
def test_random_steps_say_what_they_say_on_a_real_disk(
    run_bare: RunScript, tmp_path: Path, seed: str
) -> None:
    source = STEPS.read_text("utf-8")
    home = tmp_path / "home" / "student" / "ros2_ws"
    home.mkdir(parents=True)
    (home / "student.py").write_text(source, "utf-8")
    real = subprocess.run(
        [PYTHON, "student.py", seed, COUNT],
        cwd=home,
        capture_output=True,
        text=True,
        check=True,
        umask=0o022,
        env={"PYTHONHASHSEED": "0", "LC_ALL": "C.UTF-8"},
    )
    run = run_bare(source, args=[seed, COUNT])
    assert run.stdout.splitlines() == real.stdout.splitlines()
    assert run.stdout.count("\n") == int(COUNT)
    assert run.notes == []


SITE_PACKAGES = "sys; sys.path.append({!r})".format(
    next(path for path in sys.path if path.endswith("site-packages"))
)


def test_ordinary_ways_of_writing_a_file(run_bare: RunScript) -> None:
    run = run_bare(
        "import csv, json, logging, os, pathlib, tempfile, time\n"
        "with open('poses.csv', 'w', newline='') as file:\n"
        "    csv.writer(file).writerow(['t', 1.5])\n"
        "    file.flush(); os.fsync(file.fileno())\n"
        "    print(os.path.getsize('poses.csv'))\n"
        "json.dump({'步': 1}, open('a.json', 'w')); print(json.load(open('a.json')))\n"
        "os.makedirs('data/run1', exist_ok=True)\n"
        "pathlib.Path('data/run1/p.txt').write_text('你好', 'utf-8')\n"
        "print(pathlib.Path('data').resolve(), pathlib.Path('data/run1/p.txt').read_bytes())\n"
        "logging.basicConfig(filename='run.log', level=logging.INFO); logging.info('moved %d', 3)\n"
        "print(open('run.log').read(), end='')\n"
        "with tempfile.NamedTemporaryFile('w+') as file, tempfile.TemporaryDirectory() as folder:\n"
        "    print(os.path.dirname(file.name), os.path.dirname(folder), file.write('abc'))\n"
        "time.sleep(2.5); open('late.txt', 'w').close()\n"
        "late, early = os.path.getmtime('late.txt'), os.path.getmtime('a.json')\n"
        "print(late - early >= 2.5, late < time.time() < late + 1e-5)\n"
        "print(os.listdir('/tmp'), sorted(os.listdir()))\n"
        "print(open(__file__).readline() + os.path.abspath(__file__), os.path.expanduser('~'), end='')\n"
    )
    assert run.stderr == ""
    assert run.stdout.splitlines() == [
        "7",
        "{'步': 1}",
        "/home/student/ros2_ws/data b'\\xe4\\xbd\\xa0\\xe5\\xa5\\xbd'",
        "INFO:root:moved 3",
        "/tmp /tmp 3",
        "True True",
        "[] ['a.json', 'data', 'late.txt', 'poses.csv', 'run.log', 'student.py']",
        "import csv, json, logging, os, pathlib, tempfile, time",
        "/home/student/ros2_ws/student.py /home/student",
    ]


def test_no_file_is_made_where_a_path_names_a_folder(run_bare: RunScript) -> None:
    """As on Linux: `open(folder + "/")` of a folder that is not there, and moving a file into one."""
    run = run_bare(
        "import os, shutil\nopen('a', 'w').close()\n"
        "def show(act, *args):\n    try: act(*args)\n    except OSError as error: print(error)\n"
        "show(open, 'logs/', 'w')\nshow(os.rename, 'a', 'logs/')\nshow(shutil.copy, 'a', 'logs/')\n"
        "print(sorted(os.listdir()))\n"
    )
    assert run.stdout == (
        "[Errno 21] Is a directory: 'logs/'\n[Errno 20] Not a directory: 'a' -> 'logs/'\n"
        "Directory does not exist: logs/\n['a', 'student.py']\n"
    )


def test_an_encoding_in_the_place_of_the_buffer_is_refused_as_python_does(run_bare: RunScript) -> None:
    run = run_bare("open('log.txt', 'w', 'utf-8')\n")
    assert run.exit["message"] == "'str' object cannot be interpreted as an integer"


def test_numpy_saves_and_loads(run_bare: RunScript) -> None:
    source = (
        "import numpy as np\nnp.save('a.npy', np.eye(2)); np.savez('b.npz', a=np.arange(3))\n"
        "np.savetxt('c.txt', [[1.5, 2]], fmt='%.1f')\n"
        "print(np.load('a.npy').sum(), np.load('b.npz')['a'], np.loadtxt('c.txt'), open('c.txt').read())\n"
    )
    for preload in [(SITE_PACKAGES,), (SITE_PACKAGES, "numpy")]:  # imported by the script, and ahead of it
        run = run_bare(source, preload=preload)
        assert (run.stdout, run.stderr) == ("2.0 [0 1 2] [1.5 2. ] 1.5 2.0\n\n", "")


def test_a_full_disk_says_so(run_bare: RunScript) -> None:
    run = run_bare(
        "import os\nfile = open('big', 'wb', buffering=0)\nwritten = 0\n"
        "try:\n    while True: written += file.write(bytes(1 << 20))\nexcept OSError as error: print(error)\n"
        "print(written + os.path.getsize(__file__), os.path.getsize('big') == written)\n"
        "os.remove('big')\ntry: open('more', 'wb').write(bytes(1 << 20))\nexcept OSError as error: print(error)\n"
        "file.close(); open('more', 'wb').write(bytes(1 << 20)); print(os.path.getsize('more'))\n"
        "made = 0\ntry:\n    for made in range(2000): open(f'/tmp/{made}', 'w').close()\n"
        "except OSError as error: print(made, error)\n"
        "kept = []\ntry:\n    while True: kept.append(open('more'))\n"
        "except OSError as error: print(len(kept), error)\n"
    )
    assert run.stderr == ""
    assert run.stdout.splitlines() == [
        *(
            "[Errno 28] No space left on device",
            f"{1 << 24} True",
            "[Errno 28] No space left on device",
            "1048576",
        ),
        "993 [Errno 28] No space left on device: '/tmp/993'",
        "1024 [Errno 24] Too many open files: 'more'",
    ]


def test_folders_of_a_home_that_is_not_here_are_taken_for_granted(run_bare: RunScript) -> None:
    run = run_bare(
        "import os\n"
        "for path in ('/home/zhang/ros2_ws/log.csv', '~/桌面/log.csv', '/root/a/b/log.csv'):\n"
        "    path = os.path.expanduser(path)\n"
        "    try: open(path)\n    except OSError as error: print(error)\n"
        "    with open(path, 'w') as file: file.write('x')\n"
        "    print(open(path).read(), os.path.isfile(path))\n"
        "open('data/log.csv', 'w')\n"
    )
    assert run.stdout.count("x True\n") == 3
    assert run.stdout.count("No such file or directory: '/") == 3
    assert run.exit["message"] == "[Errno 2] No such file or directory: 'data/log.csv'"
    assert run.notes == []


def test_nothing_of_it_is_real(run_bare: RunScript, tmp_path: Path) -> None:
    name = f"{tmp_path.name}-nothing-of-it-is-real"
    run = run_bare(
        "import mmap, os\n"
        f"for path in ({name!r}, '/tmp/{name}', '/home/{name}'):\n"
        "    open(path, 'w').write('x'); print(os.path.exists(path), open(path).fileno())\n"
        f"with open({name!r}, 'r+b') as file: mmap.mmap(file.fileno(), 0)\n"
    )
    assert run.stdout == "True 1000\n" * 3
    assert run.exit["message"] == "[Errno 9] Bad file descriptor"
    assert not any(os.path.exists(f"{folder}/{name}") for folder in ("", "/tmp", "/home"))


def test_numpy_is_that_of_home(run_bare: RunScript) -> None:
    run = run_bare(
        "import numpy as np\nprint(np.float, np.int(3), np.Inf, np.product([2, 3]), np.trapz([1, 2]))\n"
        "print(isinstance(np.array([1.5], np.float32).min() * 0.5, float), np.array([200], np.uint8)[0] + 100)\n"
        "print([np.float64(1.5)])\n",
        preload=(SITE_PACKAGES,),
    )
    names, *rest = run.stdout.splitlines()
    assert names == "<class 'float'> 3 inf 6 1.5"
    if np.lib.NumpyVersion(np.__version__) < "2.0.0":
        assert rest == ["True 300", "[1.5]"]
