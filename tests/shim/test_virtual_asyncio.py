"""asyncio and the ways to wait for descriptors, in virtual time."""

from collections.abc import Callable
from typing import Any

import pytest

RunScript = Callable[..., Any]
CLOCK = "import asyncio, threading, time\ndef now(): return round(time.time() - 1.7e9, 2)\n"


def lines(run: Any) -> list[str]:
    assert run.stderr == ""
    out: list[str] = run.stdout.splitlines()
    return out


@pytest.mark.parametrize("preload", [(), ("asyncio",)])
def test_asyncio_sleeps_virtually(run_bare: RunScript, preload: tuple[str, ...]) -> None:
    run = run_bare(
        CLOCK + "async def work(n):\n    await asyncio.sleep(n)\n    print(n, now())\n"
        "async def main():\n    await asyncio.gather(work(3), work(1), work(2))\n"
        "    try: await asyncio.wait_for(work(10), 1)\n    except asyncio.TimeoutError: print('late', now())\n"
        "    e = asyncio.Event(); asyncio.get_running_loop().call_later(1, e.set); await e.wait()\n"
        "    print(now())\nasyncio.run(main())\n",
        preload=preload,
    )
    assert lines(run) == ["1 1.0", "2 2.0", "3 3.0", "late 4.0", "5.0"]
    assert run.exit["reason"] == 0


def test_where_there_is_neither_epoll_nor_linux_clocks(run_bare: RunScript) -> None:
    """As on macOS, whose kqueue would wait in real time."""
    run = run_bare(
        CLOCK + "asyncio.run(asyncio.sleep(3600)); print(now())\n"
        "print(time.clock_gettime(time.CLOCK_MONOTONIC) - time.monotonic() < 1)\n",
        horizon_s=4000,
        preload=("select, time; del select.epoll, time.CLOCK_BOOTTIME; import asyncio",),
    )
    assert lines(run) == ["3600.0", "True"]


def test_asyncio_beside_threads(run_bare: RunScript) -> None:
    run = run_bare(
        CLOCK + "async def main():\n    loop = asyncio.get_running_loop(); done = asyncio.Event()\n"
        "    threading.Timer(2, loop.call_soon_threadsafe, [done.set]).start()\n"
        "    await done.wait(); print('set', now())\n"
        "    print(await loop.run_in_executor(None, lambda: time.sleep(1) or 7), now())\n"
        "    print(await asyncio.to_thread(now))\n"
        "asyncio.run(main())\n"
        "loop = asyncio.new_event_loop()\nt = threading.Thread(target=loop.run_forever); t.start()\n"
        "print(asyncio.run_coroutine_threadsafe(asyncio.sleep(1, 'x'), loop).result(), now())\n"
        "loop.call_soon_threadsafe(loop.stop); t.join(); loop.close()\n"
    )
    assert lines(run) == ["set 2.0", "7 3.0", "3.0", "x 4.0"]


def test_ctrl_c_cancels_the_main_task(run_bare: RunScript) -> None:
    run = run_bare(
        CLOCK + "async def main():\n    try:\n        while True: await asyncio.sleep(1)\n"
        "    finally: print('cancelled', now())\n"
        "try: asyncio.run(main())\nexcept KeyboardInterrupt: print('ctrl-c', now())\n",
        horizon_s=5,
    )
    assert lines(run) == ["cancelled 5.0", "ctrl-c 5.0"]
    assert (run.exit["reason"], run.exit["after_interrupt"]) == (0, 1)


@pytest.mark.parametrize(("distro", "ok"), [("humble", "False"), ("jazzy", "True")])
def test_only_from_python_3_11_on_asyncio_takes_ctrl_c_from_rclpy(
    run_script: RunScript, distro: str, ok: str
) -> None:
    run = run_script(
        "import asyncio, rclpy\nrclpy.init()\n"
        "try: asyncio.run(asyncio.sleep(9))\nexcept KeyboardInterrupt: print(rclpy.ok())\n",
        horizon_s=5,
        distro=distro,
    )
    assert lines(run) == [ok]


def test_a_loop_signal_handler_is_called(run_bare: RunScript) -> None:
    run = run_bare(
        CLOCK + "import signal\nasync def main():\n    stop = asyncio.Event()\n"
        "    asyncio.get_running_loop().add_signal_handler(signal.SIGINT, stop.set)\n"
        "    await stop.wait(); print('stopped', now())\nasyncio.run(main())\n",
        horizon_s=5,
    )
    assert run.exit["t_ns"] == 5 * 10**9
    assert lines(run) == ["stopped 5.0"]


@pytest.mark.parametrize(
    "wait",
    [
        "select.select([], [], [], 2.5)",
        "select.select([r], [], [], 2.5)",
        "p = select.poll(); p.register(r); p.poll(2500)",
        "e = select.epoll(); e.register(r); e.poll(2.5)",
        "s = selectors.DefaultSelector(); s.register(r, selectors.EVENT_READ); s.select(2.5)",
    ],
)
def test_waiting_for_a_descriptor_takes_virtual_time(run_bare: RunScript, wait: str) -> None:
    run = run_bare(f"import os, select, selectors, time\nr, w = os.pipe()\n{wait}\nprint(time.time())\n")
    assert run.exit["t_ns"] // 10**6 == 2500


def test_a_descriptor_that_another_thread_writes_to_ends_the_wait(run_bare: RunScript) -> None:
    run = run_bare(
        CLOCK + "import os, select\nr, w = os.pipe()\nthreading.Timer(1, os.write, [w, b'x']).start()\n"
        "print(select.select([r], [], [], 5) == ([r], [], []), now())\n"
        "print(select.select([r], [w], [], 5) == ([r], [w], []), now())\n"
    )
    assert lines(run) == ["True 1.0", "True 1.0"]
