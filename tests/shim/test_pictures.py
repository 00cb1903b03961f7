"""matplotlib without a screen: scripts that plot go on, `show` waits, `pause` sleeps, animations run."""

from collections.abc import Callable
from typing import Any

RunScript = Callable[..., Any]


def test_what_plotting_scripts_do_goes_through(run_bare: RunScript) -> None:
    run = run_bare(
        "import os, time\n"
        "import matplotlib; matplotlib.use('Agg')\n"
        "import matplotlib.pyplot as plt, mpl_toolkits.mplot3d\n"
        "from matplotlib.patches import Circle\n"
        "plt.rcParams['font.sans-serif'] = ['SimHei']; plt.style.use('ggplot'); \n"
        "fig, ax = plt.subplots(figsize=(6, 6)); line, = ax.plot([1], [2], 'r-')\n"
        "ax.add_patch(Circle((1, 1), 2))\n"
        "fig2, (left, right) = plt.subplots(1, 2); _, grid = plt.subplots(2, 2)\n"
        "left.set(title='轨迹'); grid[0, 1].axis('equal'); grid[1][0].legend(); print(len(grid.flat))\n"
        "line.set_data([1, 2], [3, 4]); xs, ys = line.get_data(); low, high = ax.get_xlim()\n"
        "with plt.style.context('dark_background'): n, bins, patches = plt.hist([1, 2])\n"
        "plt.savefig('path.png', dpi=100); print(os.listdir('.'), time.monotonic())\n"
        "plt.show(); plt.pause(0.5); print(round(time.monotonic(), 3))\n"
    )
    assert run.stderr == ""
    assert run.stdout.splitlines() == ["4", "['student.py', 'path.png'] 100000.000001", "100000.5"]
    assert run.notes == [("no_pictures", "matplotlib"), ("no_pictures", "mpl_toolkits")]


def test_a_window_is_shown_until_the_horizon(run_bare: RunScript) -> None:
    run = run_bare(
        "import threading, time\nimport matplotlib.pyplot as plt\n"
        "from matplotlib.animation import FuncAnimation\n"
        "def draw(i, name): print(name, i, round(time.monotonic(), 3))\n"
        "slow = FuncAnimation(plt.figure(), draw, frames=2, fargs=('slow',), interval=400)\n"
        "threading.Thread(target=lambda: (time.sleep(0.7), print('thread'))).start()\n"
        "plt.show(block=False)\ntry: plt.show()\nexcept KeyboardInterrupt: print('closed')\n",
        horizon_s=1.5,
    )
    assert run.stdout.splitlines() == [
        *("slow 0 100000.4", "thread", "slow 1 100000.8", "slow 0 100001.2"),
        "closed",
    ]


def test_an_animation_that_is_not_repeated_ends(run_bare: RunScript) -> None:
    run = run_bare(
        "import matplotlib.pyplot as plt\nfrom matplotlib.animation import FuncAnimation\n"
        "kept = FuncAnimation(plt.figure(), print, frames=[3, 4], interval=100, repeat=False)\nplt.show()\n",
        horizon_s=1.0,
    )
    assert run.stdout == "3\n4\n"


def test_all_names_of_pyplot_and_what_it_answers(run_bare: RunScript) -> None:
    run = run_bare(
        "from matplotlib.pyplot import *\n"
        "figure(); plot([1], [2]); low, high = xlim(); bottom, top = ylim(); grid(); legend(); savefig('a.png')\n"
        "left, right, bottom, top = axis(); axis('equal'); width, height = gcf().get_size_inches()\n"
        "handles, labels = gca().get_legend_handles_labels()\nprint(low, right, width)\n"
    )
    assert (run.stdout, run.stderr) == ("0.0 1.0 6.4\n", "")


def test_a_package_that_is_not_there_is_still_missing(run_bare: RunScript) -> None:
    assert run_bare("import matplotlib_extra\n").exit["type"] == "ModuleNotFoundError"
