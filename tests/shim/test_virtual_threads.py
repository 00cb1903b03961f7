"""Threads, locks, queues and pools in virtual time."""

from collections.abc import Callable
from typing import Any

import pytest

S = 10**9
RunScript = Callable[..., Any]
CLOCK = "import threading, time, queue\ndef now(): return round(time.time() - 1.7e9, 3)\n"


def lines(run: Any) -> list[str]:
    assert run.stderr == ""
    out: list[str] = run.stdout.splitlines()
    return out


@pytest.mark.parametrize("preload", [(), ("threading", "queue", "concurrent.futures.thread", "logging")])
def test_threads_sleep_at_the_same_time(run_bare: RunScript, preload: tuple[str, ...]) -> None:
    run = run_bare(
        CLOCK + "def work(n):\n    time.sleep(n)\n    print(n, now())\n"
        "threads = [threading.Thread(target=work, args=(n,)) for n in (3, 1, 2)]\n"
        "for t in threads: t.start()\nfor t in threads: t.join()\nprint('end', now())\n",
        preload=preload,
    )
    assert lines(run) == ["1 1.0", "2 2.0", "3 3.0", "end 3.0"]


@pytest.mark.parametrize(("failures", "ends"), [(3, "ran 1.0"), (99, "RuntimeError")])
def test_a_thread_that_the_host_cannot_spare_is_asked_for_again(
    run_bare: RunScript, failures: int, ends: str
) -> None:
    run = run_bare(
        CLOCK
        + "from rclpy._patches import threads\nstart, left = threads._start_os_thread, FAILURES\n"
        "def refuse(*given):\n    global left\n    left -= 1\n"
        '    if left >= 0: raise RuntimeError("can\'t start new thread")\n    return start(*given)\n'
        "threads._start_os_thread, threads._PAUSE_S = refuse, 0.001\n"
        "def work():\n    time.sleep(1)\n    print('ran', now())\n"
        "try: threading.Thread(target=work).start()\nexcept RuntimeError: print('RuntimeError')\n".replace(
            "FAILURES", str(failures)
        )
    )
    assert lines(run) == [ends]


def test_a_thread_that_a_destructor_starts_in_a_wait_runs_beside_it(run_script: RunScript) -> None:
    run = run_script(
        CLOCK
        + "import gc, rclpy\nfrom rclpy._kernel import kernel\nfrom turtlesim.msg import Pose\n"
        "class Trash:\n    def __init__(self): self.me = self\n"
        "    def __del__(self): threading.Thread(target=work).start()\n"
        "def work():\n    time.sleep(1)\n    print('work', now())\n"
        "rclpy.init()\nnode = rclpy.create_node('n')\n"
        "node.create_subscription(Pose, '/turtle1/pose', print, 10)\n"
        "made = []\ndef ready():\n    if not made and now() > 0.15:\n        made.append(Trash)\n        Trash()\n"
        "        gc.collect()\n    return False\n"
        "kernel.wait(ready, 3 * S, 'test')\nprint('end', now())\n".replace("S", str(S)),
        cpu_s=3,
        feed=[(n * S // 10, "/turtle1/pose", b"\0\1\0\0" + bytes(20)) for n in range(1, 6)],
    )
    assert lines(run) == ["work 1.2", "end 3.0"]


def test_equal_deadlines_run_in_order_of_creation(run_bare: RunScript) -> None:
    run = run_bare(
        CLOCK + "def work(n):\n    for _ in range(2):\n        time.sleep(1)\n        print(n, end=' ')\n"
        "for n in range(4): threading.Thread(target=work, args=(n,)).start()\n"
    )
    assert lines(run) == ["0 1 2 3 0 1 2 3 "]


def test_event_condition_semaphore_barrier_and_timer_wait_virtually(run_bare: RunScript) -> None:
    run = run_bare(
        CLOCK + "e = threading.Event()\nthreading.Timer(2, e.set).start()\n"
        "print(e.wait(0.5), now(), e.wait(), now(), e.is_set())\n"
        "c = threading.Condition()\nwith c: print(c.wait(1), now(), c.wait_for(lambda: False, 1), now())\n"
        "s = threading.Semaphore(0)\nthreading.Timer(1, s.release).start()\n"
        "print(s.acquire(timeout=0.25), s.acquire(), now())\n"
        "b = threading.Barrier(2)\nthreading.Timer(1, b.wait).start()\nb.wait()\nprint(now())\n"
    )
    assert lines(run) == ["False 0.5 True 2.0 True", "False 3.0 False 4.0", "False True 5.0", "6.0"]


def test_queues_wait_virtually(run_bare: RunScript) -> None:
    run = run_bare(
        CLOCK + "q = queue.Queue(1)\ns = queue.SimpleQueue()\n"
        "threading.Timer(1, q.put, ['a']).start(); threading.Timer(2, s.put, ['b']).start()\n"
        "print(q.get(), now(), s.get(), now())\n"
        "for box in (q, s):\n    try: box.get(timeout=0.5)\n    except queue.Empty: print('empty', now())\n"
        "q.put(1)\ntry: q.put(2, timeout=1)\nexcept queue.Full: print('full', now())\n"
        "try: s.get_nowait()\nexcept queue.Empty: print('nothing')\n"
    )
    assert lines(run) == ["a 1.0 b 2.0", "empty 2.5", "empty 3.0", "full 4.0", "nothing"]


def test_a_thread_pool_works(run_bare: RunScript) -> None:
    run = run_bare(
        CLOCK + "from concurrent.futures import ThreadPoolExecutor, as_completed, wait, TimeoutError\n"
        "with ThreadPoolExecutor(2) as pool:\n"
        "    print(list(pool.map(lambda n: (time.sleep(n), n)[1], [3, 1, 2])), now())\n"
        "    slow = pool.submit(time.sleep, 5)\n"
        "    try: slow.result(1)\n    except TimeoutError: print('timeout', now())\n"
        "    print([f.result() for f in as_completed([pool.submit(now)])])\nprint(now())\n"
        "pool = ThreadPoolExecutor()\npool.submit(lambda: (time.sleep(1), print('last', now())))\n"
    )
    assert lines(run) == ["[3, 1, 2] 3.0", "timeout 4.0", "[4.0]", "8.0", "last 9.0"]
    assert run.exit["reason"] == 0


def test_locks_refuse_what_pythons_refuse(run_bare: RunScript) -> None:
    run = run_bare(
        "import threading\nfrom _thread import LockType\nlock, again = threading.Lock(), threading.RLock()\n"
        "def attempt(call):\n    try: print(call())\n    except Exception as e: print(type(e).__name__, e)\n"
        "attempt(lock.release); attempt(again.release)\n"
        "attempt(lambda: lock.acquire(False, 1)); attempt(lambda: lock.acquire(True, -2))\n"
        "attempt(lambda: lock.acquire(timeout=1e12))\n"
        "print(lock.acquire(), lock.acquire(False), lock.acquire(timeout=1), lock.locked())\n"
        "print(again.acquire(), again.acquire(), isinstance(lock, LockType), isinstance(lock, type(lock)))\n"
        "again.release(); again.release(); attempt(again.release)\n"
        "print(repr(lock).split(' at ')[0], repr(again).split(' at ')[0])\n"
    )
    assert lines(run) == [
        "RuntimeError release unlocked lock",
        "RuntimeError cannot release un-acquired lock",
        "ValueError can't specify a timeout for a non-blocking call",
        "ValueError timeout value must be a non-negative number",
        "OverflowError timeout value is too large",
        "True False False True",
        "True True True True",
        "RuntimeError cannot release un-acquired lock",
        "<locked _thread.lock object <unlocked _thread.RLock object owner=0 count=0",
    ]


def test_a_lock_is_held_across_a_sleep(run_bare: RunScript) -> None:
    run = run_bare(
        CLOCK + "for Lock in (threading.Lock, threading.RLock):\n    lock = Lock()\n    def work(n):\n"
        "        with lock:\n            time.sleep(1)\n            print(n, now())\n"
        "    ts = [threading.Thread(target=work, args=(n,)) for n in range(3)]\n"
        "    for t in ts: t.start()\n    for t in ts: t.join()\n"
    )
    assert lines(run) == ["0 1.0", "1 2.0", "2 3.0", "0 4.0", "1 5.0", "2 6.0"]


def test_a_non_daemon_thread_keeps_the_process_alive_and_a_daemon_does_not(run_bare: RunScript) -> None:
    run = run_bare(
        CLOCK + "def work(n):\n    time.sleep(n)\n    print(n, now())\n"
        "threading.Thread(target=work, args=(2,)).start()\n"
        "threading.Thread(target=work, args=(5,), daemon=True).start()\n"
        "import atexit; atexit.register(lambda: print('bye', now()))\nprint('main', now())\n"
    )
    assert lines(run) == ["main 0.0", "2 2.0", "bye 2.0"]
    assert (run.exit["reason"], run.exit["t_ns"] // 10**6) == (0, 2000)


def test_the_episode_is_told_of_the_first_thread_once(run_bare: RunScript) -> None:
    run = run_bare(
        "import threading, time\n"
        "for _ in range(3):\n    threading.Thread(target=time.sleep, args=(1,)).start()\n    time.sleep(2)\n"
    )
    assert [frame["code"] for frame in run.of("NOTE")] == ["started", "threads"]


def test_an_exception_in_a_thread_is_printed_and_noted_and_main_goes_on(run_bare: RunScript) -> None:
    run = run_bare(
        "import threading\ndef work():\n    1 / 0\nt = threading.Thread(target=work)\nt.start()\nt.join()\n"
        "print('on', t.is_alive())\n"
    )
    assert run.stdout == "on False\n"
    assert run.stderr == (
        "Exception in thread Thread-1 (work):\nTraceback (most recent call last):\n"
        '  File "student.py", line 3, in work\n    1 / 0\n    ~~^~~\nZeroDivisionError: division by zero\n'
    )
    assert run.notes == [("thread_exception", "Thread-1 (work), line 3: ZeroDivisionError: division by zero")]
    assert run.exit["reason"] == 0


def test_a_students_own_excepthook_is_called(run_bare: RunScript) -> None:
    run = run_bare(
        "import threading\nthreading.excepthook = lambda args: print('mine', args.exc_type.__name__)\n"
        "threading.Thread(target=lambda: 1 / 0).start()\n"
    )
    assert (run.stdout, run.stderr) == ("mine ZeroDivisionError\n", "")


def test_sys_exit_in_a_thread_ends_only_that_thread(run_bare: RunScript) -> None:
    run = run_bare(
        "import threading, sys, _thread, time\nthreading.Thread(target=sys.exit, args=(3,)).start()\n"
        "_thread.start_new_thread(sys.exit, ())\ntime.sleep(1)\nprint('on')\n"
    )
    assert lines(run) == ["on"]
    assert run.exit["code"] == 0


def test_an_exception_in_a_bare_thread_is_printed(run_bare: RunScript) -> None:
    run = run_bare("import _thread, time\n_thread.start_new_thread(lambda: 1 / 0, ())\ntime.sleep(1)\n")
    assert run.stderr.startswith("Exception ignored in thread started by: <function <lambda> at ")
    assert run.stderr.endswith("ZeroDivisionError: division by zero\n")


def test_thread_identity_is_consistent_and_repeatable(run_bare: RunScript) -> None:
    source = (
        "import threading\nmain = threading.main_thread()\n"
        "print(threading.current_thread() is main, main.ident == threading.get_ident(), main)\n"
        "def work():\n    me = threading.current_thread()\n"
        "    print(me.name, me.ident == threading.get_ident(), me.native_id, main.is_alive())\n"
        "t = threading.Thread(target=work, name='w'); t.start(); t.join()\n"
        "print(threading.active_count(), threading.enumerate() == [main], t)\n"
    )
    first, second = run_bare(source), run_bare(source, preload=("threading",))
    assert lines(first) == lines(second)
    assert lines(first)[:1] == ["True True <_MainThread(MainThread, started 139637976731648)>"]
    assert lines(first)[1:2] == ["w True 4243 True"]
    assert lines(first)[2].startswith("1 True <Thread(w, stopped ")


def test_a_thread_may_join_the_main_thread(run_bare: RunScript) -> None:
    run = run_bare(
        CLOCK + "def work():\n    threading.main_thread().join()\n    print('main has ended', now())\n"
        "threading.Thread(target=work).start()\ntime.sleep(1)\n",
    )
    assert lines(run) == ["main has ended 1.0"]


def test_threads_started_while_others_are_blocked(run_bare: RunScript) -> None:
    run = run_bare(
        CLOCK
        + "def outer():\n    time.sleep(1)\n    t = threading.Thread(target=inner); t.start(); t.join()\n"
        "    print('outer', now())\ndef inner():\n    time.sleep(1)\n    print('inner', now())\n"
        "t = threading.Thread(target=outer); t.start()\ntime.sleep(1.5)\nprint('main', now())\nt.join()\n"
    )
    assert lines(run) == ["main 1.5", "inner 2.0", "outer 2.0"]


def test_there_is_a_bound_on_threads(run_bare: RunScript) -> None:
    run = run_bare(
        "import threading, time\ntry:\n    while True:\n"
        "        threading.Thread(target=time.sleep, args=(1,)).start()\n"
        "except RuntimeError as e: print(e, threading.active_count())\n"
    )
    assert run.stdout == "can't start new thread 64\n"


def test_a_destructor_may_wait(run_bare: RunScript) -> None:
    run = run_bare(
        CLOCK + "import gc\nclass Slow:\n    def __init__(self): self.me = self\n"
        "    def __del__(self):\n        time.sleep(0.25)\n        print('gone', now())\n"
        "def work():\n    for _ in range(2):\n        Slow(); gc.collect()\n"
        "t = threading.Thread(target=work); t.start()\nSlow(); gc.collect(); t.join()\nprint(now())\n"
    )
    out = lines(run)
    assert [line.split()[0] for line in out[:3]] == ["gone"] * 3
    assert out[3] == "0.75"


def test_deep_recursion_into_a_wait_keeps_the_threads_going(run_bare: RunScript) -> None:
    run = run_bare(
        CLOCK + "def ping():\n    for _ in range(20): time.sleep(0.1)\n    print('pinged', now())\n"
        "t = threading.Thread(target=ping); t.start()\n"
        "def dive(n):\n    time.sleep(0.001)\n    dive(n + 1)\n"
        "for _ in range(3):\n    try: dive(0)\n    except RecursionError: print('too deep')\n"
        "t.join()\n"
    )
    out = lines(run)
    assert out.count("too deep") == 3
    assert any(line.startswith("pinged") for line in out)


def test_a_run_with_many_threads_is_repeatable(run_bare: RunScript) -> None:
    source = (
        CLOCK + "import random\nlog = []\ndef work(n):\n    for i in range(20):\n"
        "        time.sleep(random.random() / 10)\n        q.put((n, i)); log.append((n, now()))\n"
        "q = queue.Queue()\nts = [threading.Thread(target=work, args=(n,)) for n in range(8)]\n"
        "for t in ts: t.start()\nfor _ in range(160): log.append(q.get())\nprint(log)\n"
    )
    first, second = run_bare(source, seed=5), run_bare(source, seed=5)
    assert first.raw == second.raw
    assert first.stdout == second.stdout != run_bare(source, seed=6).stdout


def test_logging_and_imports_work_in_threads(run_bare: RunScript) -> None:
    run = run_bare(
        CLOCK
        + "import logging, sys\nlogging.basicConfig(stream=sys.stdout, format='%(relativeCreated)d %(message)s')\n"
        "class Slow(logging.Handler):\n    def emit(self, record): time.sleep(1)\n"
        "logging.getLogger().addHandler(Slow())\n"
        "def work(n):\n    import json, decimal\n    logging.warning('%s', n)\n"
        "ts = [threading.Thread(target=work, args=(n,)) for n in range(3)]\n"
        "for t in ts: t.start()\nfor t in ts: t.join()\nprint(now())\n"
    )
    assert [line.split()[-1] for line in lines(run)] == ["0", "1", "2", "3.0"]


def test_locks_and_queues_of_multiprocessing_keep_threads_apart(run_bare: RunScript) -> None:
    """Where no process can be started, a ThreadPool is what is left of multiprocessing, and it is made of them."""
    run = run_bare(
        CLOCK
        + """
import multiprocessing
from multiprocessing.pool import ThreadPool

def nap(seconds):
    time.sleep(seconds)
    return seconds

with ThreadPool(2) as pool:
    print(pool.map(nap, [1.0, 1.0, 2.0]), now())
semaphore = multiprocessing.Semaphore(1)
print(semaphore.acquire(), semaphore.acquire(False), semaphore.acquire(timeout=1.5), now())
condition = multiprocessing.Condition()
def notify():
    time.sleep(2.0)
    with condition:
        condition.notify()
threading.Thread(target=notify).start()
with condition:
    print(condition.wait(5.0), condition.acquire(), now())
for lock in (multiprocessing.Lock(), multiprocessing.RLock()):
    try:
        lock.release()
    except (AssertionError, ValueError) as error:
        print(type(error).__name__, error)
q = multiprocessing.Queue()
q.put('x' * 200_000)
print(len(q.get()), q.empty())
try:
    q.get(timeout=3.0)
except queue.Empty:
    print('empty', now())
"""
    )
    assert lines(run) == [
        "[1.0, 1.0, 2.0] 3.0",
        "True False False 4.5",
        "True True 6.5",
        "ValueError semaphore or lock released too many times",
        "AssertionError attempt to release recursive lock not owned by thread",
        "200000 True",
        "empty 9.5",
    ]


def test_old_names_warn(run_bare: RunScript) -> None:
    run = run_bare("import threading\nprint(threading.Event().isSet())\nthreading.activeCount()\n")
    assert run.stdout == "False\n"
    assert [line.partition(": ")[2] for line in run.stderr.splitlines()[::2]] == [
        "DeprecationWarning: isSet() is deprecated, use is_set() instead",
        "DeprecationWarning: activeCount() is deprecated, use active_count() instead",
    ]


def test_threads_whose_stacks_would_take_the_memory_cannot_start(run_bare: RunScript) -> None:
    run = run_bare(
        "import threading\nthreading.stack_size(512 * 1024 * 1024)\n"
        "try:\n    threading.Thread(target=print).start()\nexcept RuntimeError as error:\n    print(error)\n"
    )
    assert run.stdout == "can't start new thread\n"


def test_starting_a_thread_leaves_the_size_of_stacks_alone(run_bare: RunScript) -> None:
    run = run_bare(
        "import threading\nthreading.stack_size(1 << 20)\nthreading.Thread(target=print).start()\n"
        "print(threading.stack_size())\n"
    )
    assert "1048576" in run.stdout
