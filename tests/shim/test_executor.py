"""Executors: what one spin_once does, threads, tasks, futures, custom executors, deadlocks."""

from textwrap import dedent

PREFIX = """
import time
import rclpy
from rclpy.node import Node
from rclpy.executors import *
from rclpy.callback_groups import *
from std_msgs.msg import String
from std_srvs.srv import Trigger
rclpy.init()
node = Node("n")
def at(*what):
    print(round((time.time() - 1_700_000_000) * 1000), *what)
"""


def run_lines(run_script, source, **options):
    run = run_script(PREFIX + dedent(source), **options)
    assert run.exit["type"] == "", run.stderr
    assert run.exit["reason"] == 0, run.exit["text"]
    return run.stdout.splitlines()


def test_spin_once_runs_at_most_one_callback(run_script):
    source = """
        node.create_timer(0.1, lambda: at("a"))
        node.create_timer(0.1, lambda: at("b"))
        rclpy.spin_once(node)
        rclpy.spin_once(node)
        rclpy.spin_once(node, timeout_sec=0.05)
        at("timeout")
        rclpy.spin_once(node, timeout_sec=0)
        at("poll")
    """
    assert run_lines(run_script, source) == ["100 a", "100 b", "150 timeout", "150 poll"]


def test_an_exception_leaves_the_spin(run_script):
    run = run_script(PREFIX + "node.create_timer(0.1, lambda: 1 / 0)\nrclpy.spin(node)\n")
    assert (run.exit["type"], run.exit["line"], run.exit["code"]) == ("ZeroDivisionError", 13, 1)
    assert run.exit["text"].count("File ") == 2  # the script's frames, not ours


def test_an_executor_of_threads_overlaps_reentrant_callbacks(run_script):
    source = """
        group = {group}()
        def slow(name):
            at(name, "begins")
            time.sleep(0.3)
            at(name, "ends")
        node.create_timer(0.1, lambda: (a.cancel(), slow("a")), callback_group=group)
        node.create_timer(0.2, lambda: (b.cancel(), slow("b")), callback_group=group)
        a, b = node.timers
        executor = MultiThreadedExecutor(2)
        executor.add_node(node)
        for _ in range(40):
            executor.spin_once(timeout_sec=0.02)
    """
    reentrant = run_lines(run_script, source.format(group="ReentrantCallbackGroup"))
    assert reentrant == ["100 a begins", "200 b begins", "400 a ends", "500 b ends"]
    exclusive = run_lines(run_script, source.format(group="MutuallyExclusiveCallbackGroup"))
    assert exclusive == ["100 a begins", "400 a ends", "400 b begins", "700 b ends"]


def test_coroutines_wait_for_futures(run_script):
    source = """
        node.create_service(Trigger, "s", lambda q, a: (at("asked"), setattr(a, "message", "yes"), a)[2])
        client = node.create_client(Trigger, "s", callback_group=ReentrantCallbackGroup())
        other = ReentrantCallbackGroup()
        async def tick():
            timer.cancel()
            at("calls")
            answer = await client.call_async(Trigger.Request())
            at(answer.message)
            rclpy.shutdown()
        timer = node.create_timer(1.0, tick, callback_group=other)
        rclpy.spin(node)
    """
    assert run_lines(run_script, source) == ["1000 calls", "1000 asked", "1000 yes"]


def test_spin_until_future_complete(run_script):
    source = """
        future = rclpy.Future()
        node.create_timer(0.5, lambda: future.set_result(42) if not future.done() else None)
        print(rclpy.spin_until_future_complete(node, future), future.result())
        at()
        never = rclpy.Future()
        print(rclpy.spin_until_future_complete(node, never, timeout_sec=1.0), never.done())
        at()
    """
    assert run_lines(run_script, source) == ["None 42", "500", "None False", "1500"]


def test_tasks_and_done_callbacks(run_script):
    source = """
        executor = SingleThreadedExecutor()
        task = executor.create_task(lambda x: x * 2, 21)
        task.add_done_callback(lambda done: print("done", done.result()))
        print(task.done(), task.result())
        executor.spin_until_future_complete(task)
        print(task.done(), task.result())
        executor.spin_once(timeout_sec=0)
        executor.spin_once(timeout_sec=0)
    """
    assert run_lines(run_script, source) == ["False None", "True 42", "done 42"]


def test_nodes_move_between_executors(run_script):
    source = """
        one, two = SingleThreadedExecutor(), SingleThreadedExecutor()
        print(one.add_node(node), one.add_node(node), two.add_node(node))
        print(len(one.get_nodes()), two.get_nodes() == [node], node.executor is two)
        two.shutdown()
        print(two.get_nodes())
    """
    assert run_lines(run_script, source) == ["True False True", "0 True True", "[]"]


def test_a_custom_executor(run_script):
    source = """
        class Urgent(Executor):
            def can_execute(self, entity):
                return super().can_execute(entity) and entity is not blocked
            def spin_once(self, timeout_sec=None):
                try:
                    handler, entity, served = self.wait_for_ready_callbacks(timeout_sec=timeout_sec)
                except TimeoutException:
                    return at("timeout")
                print(type(entity).__name__, served is node)
                handler()
        blocked = node.create_timer(0.1, lambda: at("never"))
        node.create_timer(0.3, lambda: at("served"))
        executor = Urgent()
        executor.add_node(node)
        executor.spin_once(1.0)
        executor.spin_once(0.1)
    """
    assert run_lines(run_script, source) == ["Timer True", "300 served", "400 timeout"]


def test_calling_a_service_in_a_callback_is_a_deadlock(run_script):
    run = run_script(
        PREFIX
        + dedent("""
            node.create_service(Trigger, "s", lambda q, a: a)
            client = node.create_client(Trigger, "s")
            node.create_timer(1.0, lambda: client.call(Trigger.Request()))
            rclpy.spin(node)
        """)
    )
    assert run.exit["reason"] == 2
    assert "client.call() of 's' waits for an answer" in run.exit["text"]
    assert run.exit["t_ns"] < 1_100_000_000


def test_spin_once_with_nothing_to_wait_for_is_a_deadlock(run_script):
    run = run_script(PREFIX + "node.create_publisher(String, 'a', 1)\nrclpy.spin_once(node)\n")
    assert run.exit["reason"] == 2
    assert "spin_once() waits for a timer, a message or a request" in run.exit["text"]


def test_a_listener_without_talkers_idles_until_the_horizon(run_script):
    source = "node.create_subscription(String, 'a', print, 1)\nwhile rclpy.ok():\n    rclpy.spin_once(node)\n"
    run = run_script(PREFIX + source, horizon_s=5)
    assert (run.exit["reason"], run.exit["t_ns"], run.exit["after_interrupt"]) == (0, 5_000_000_000, 1)


def test_the_end_of_the_program_waits_for_callbacks_under_way(run_script):
    run = run_script(
        """
import time
import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
rclpy.init()
node = rclpy.create_node("n")
group = ReentrantCallbackGroup()
def slow():
    first.cancel()
    time.sleep(3)
    print("slow", round(time.time() - 1.7e9, 2))
first = node.create_timer(0.1, slow, group)
node.create_timer(0.5, rclpy.shutdown, group)
executor = MultiThreadedExecutor()
executor.add_node(node)
try:
    executor.spin()
except ExternalShutdownException:
    pass
print("main", round(time.time() - 1.7e9, 2))
""",
        horizon_s=10,
    )
    assert run.stdout.splitlines() == ["main 0.5", "slow 3.1"]
    assert (run.exit["reason"], run.exit["t_ns"] // 10**8) == (0, 31)


def test_a_callback_that_raises_system_exit_is_not_resumed(run_script):
    """Upstream's task stays `_executing` (task.py:229-256), and executors skip it (executors.py:496)."""
    source = """
        def tick():
            ticks.append(1)
            at(len(ticks))
            if len(ticks) == 2:
                raise {error}
        ticks = []
        node.create_timer(0.1, tick)
        try:
            rclpy.spin(node)
        except {error}:
            at("stopped", rclpy.ok())
        for _ in range(3):
            rclpy.spin_once(node)
        at("end")
    """
    for error in ("SystemExit", "KeyboardInterrupt"):
        lines = run_lines(run_script, source.format(error=error))
        assert lines == ["100 1", "200 2", "200 stopped True", "300 3", "400 4", "500 5", "500 end"], error


def test_a_service_whose_callback_exits_never_answers(run_script):
    source = """
        def serve(request, response):
            at("served")
            raise SystemExit(3)
        node.create_service(Trigger, "t", serve)
        future = node.create_client(Trigger, "t").call_async(Trigger.Request())
        try:
            rclpy.spin_until_future_complete(node, future)
        except SystemExit as error:
            at("exit", error.code)
        rclpy.spin_once(node, timeout_sec=0.2)
        at(future.done())
    """
    assert run_lines(run_script, source) == ["0 served", "0 exit 3", "200 False"]


def test_an_executor_of_threads_loses_system_exit_and_goes_on(run_script):
    """A pool's future keeps the exception (executors.py, MultiThreadedExecutor) and nobody asks for it."""
    source = """
        def tick():
            at("tick")
            raise SystemExit
        node.create_timer(0.1, tick)
        executor = MultiThreadedExecutor(2)
        executor.add_node(node)
        while node.get_clock().now().nanoseconds < 1_700_000_000_350_000_000:
            executor.spin_once(timeout_sec=0.05)
        print(len(executor._tasks) < 3)
    """
    assert run_lines(run_script, source) == ["100 tick", "200 tick", "300 tick", "True"]


def test_spinning_once_after_ctrl_c_fails_as_its_timer_or_wait_set_does(run_script):
    """A timeout is measured by a timer (executors.py:479); rcl refuses both in a context that was shut down."""
    source = """
        try:
            rclpy.spin(node)
        except KeyboardInterrupt:
            pass
        for timeout_sec in (0.1, 0, None):
            try:
                rclpy.spin_once(node, timeout_sec=timeout_sec)
            except RuntimeError as error:
                print(type(error).__name__, error)
    """
    invalid = "the given context is not valid, either rcl_init() was not called or rcl_shutdown() was called."
    assert run_script(PREFIX + dedent(source), horizon_s=1).stdout.splitlines() == [
        f"RCLError failed to create timer: {invalid}, at ./src/rcl/guard_condition.c:67",
        *[f"RCLError failed to initialize wait set: {invalid}, at ./src/rcl/wait.c:130"] * 2,
    ]


def test_a_timer_that_was_reset_or_joins_later_is_served_in_time(run_script):
    run = run_script(
        "import rclpy\n"
        "rclpy.init(); node = rclpy.create_node('a'); calls = []\n"
        "def now(): return round(node.get_clock().now().nanoseconds / 1e9 - 1.7e9, 2)\n"
        "def slow(): calls.append(('slow', now()))\n"
        "def fast():\n"
        "    calls.append(('fast', now()))\n"
        "    if len(calls) == 1: late.reset()\n"
        "    if len(calls) == 2: node.create_timer(0.15, slow)\n"
        "    if len(calls) == 4: timer.cancel()\n"
        "late = node.create_timer(5.0, lambda: calls.append(('late', now()))); late.cancel()\n"
        "timer = node.create_timer(0.3, fast)\n"
        "while not calls or calls[-1][0] != 'late': rclpy.spin_once(node)\n"
        "print([call for call in calls if call[1] < 1.0], calls[-1], len(calls))\n"
    )
    times = [("fast", 0.3), ("fast", 0.6), ("slow", 0.75), ("fast", 0.9), ("slow", 0.9)]
    assert run.stdout == f"{times} ('late', 5.3) {len(times) + 30}\n"


def test_what_is_destroyed_in_a_callback_is_not_served_any_more(run_script):
    run = run_script(
        "import rclpy\nfrom std_msgs.msg import Int32\n"
        "rclpy.init(); node = rclpy.create_node('a'); calls = []\n"
        "def first():\n    calls.append('first'); node.destroy_timer(second); node.destroy_subscription(heard)\n"
        "publisher = node.create_publisher(Int32, 'x', 10)\n"
        "heard = node.create_subscription(Int32, 'x', lambda m: calls.append('heard'), 10)\n"
        "node.create_timer(0.1, first)\n"
        "second = node.create_timer(0.1, lambda: calls.append('second'))\n"
        "node.create_timer(0.1, lambda: calls.append('third'))\n"
        "import time; time.sleep(0.1); publisher.publish(Int32())\n"
        "for _ in range(2): rclpy.spin_once(node, timeout_sec=0)\n"
        "print(calls)\n"
    )
    assert run.stdout == "['first', 'third']\n"


def test_a_future_awaited_in_asyncio_costs_no_question_per_microsecond(run_script):
    run = run_script(
        "import asyncio, rclpy\n"
        "rclpy.init(); node = rclpy.create_node('a'); done = rclpy.Future(); turns = 0\n"
        "node.create_timer(5.0, lambda: done.set_result(1))\n"
        "async def spinning():\n"
        "    while rclpy.ok():\n        rclpy.spin_once(node, timeout_sec=0.01); await asyncio.sleep(0.001)\n"
        "async def main():\n    asyncio.create_task(spinning()); print(await done)\n"
        "class Counted(rclpy.Future):\n"
        "    def __await__(self):\n"
        "        global turns\n        for _ in super().__await__(): turns += 1; yield\n"
        "        return self.result()\n"
        "done.__class__ = Counted\n"
        "asyncio.run(main())\n"
        "print(100 < turns < 10_000, round(node.get_clock().now().nanoseconds / 1e9 - 1.7e9, 1))\n"
    )
    assert run.stdout == "1\nTrue 5.0\n"


LONG_WAY = (
    "import rclpy.executors\n"
    "rclpy.executors.SingleThreadedExecutor._wait_for_lone_callback = lambda self, timeout_sec: None\n"
    "rclpy.executors.SingleThreadedExecutor._spin_on = lambda self: None\n"
)
TIMERS = """
import rclpy, random, time
from rclpy._kernel import kernel
from std_msgs.msg import Int32
rclpy.init()
node = rclpy.create_node('n')
out = node.create_publisher(Int32, 'heard', 10)
node.create_subscription(Int32, 'heard', lambda m: said('heard', m.data), 10)
chance, count, shown = random.Random(1), [0], []
def said(*what): shown.append((kernel.now_ns, kernel.steps, *what))
def act(name):
    count[0] += 1
    dice = chance.randrange(40)
    said(name, dice)
    if dice == 0: out.publish(Int32(data=count[0]))
    elif dice == 1: timers[chance.randrange(1, 3)].cancel()
    elif dice == 2: timers[chance.randrange(3)].reset()
    elif dice == 3: node.get_clock().now()
    elif dice == 4: time.sleep(chance.choice((0.0001, 0.002)))
    elif dice == 5 and not spinning: rclpy.spin_once(node, timeout_sec=0.0005)
    elif dice == 5: rclpy.get_global_executor().spin_once(timeout_sec=0.0005)
    elif dice == 6: rclpy.get_global_executor().create_task(lambda: said('task'))
    elif dice == 7: node.destroy_timer(node.create_timer(0.001, lambda: None))
    elif dice == 8: raise ValueError(name)
    elif dice == 9: raise StopIteration
    elif dice == 10: rclpy.get_global_executor().add_node(other)
    elif dice == 11: rclpy.get_global_executor().remove_node(other)
    elif dice == 12: timers[0].callback = later if timers[0].callback is fast else fast
async def later(): act('async')
other = rclpy.create_node('other')
other.create_timer(0.002, lambda: act('other'))
timers = [node.create_timer(period_s, lambda name=period_s: act(name)) for period_s in (0.0003, 0.001, 0.007)]
fast = timers[0].callback
while count[0] < 3000:
    spinning = False
    try:
        for _ in range(30): rclpy.spin_once(node)
        for _ in range(30): rclpy.spin_once(node, timeout_sec=0.0004)
        done = rclpy.Future()
        rclpy.spin_until_future_complete(node, done, timeout_sec=0.01)
        spinning = True
        rclpy.spin(node)
    except (ValueError, RuntimeError) as error:
        said(repr(error))
print(*shown, sep='\\n')
"""


def test_the_short_way_to_a_lone_timer_comes_to_the_same(run_script):
    """Timers that are cancelled, reset, destroyed, late, raise or spin: each call at the same instant and step."""
    short = run_script(TIMERS)
    assert short.stdout.count("\n") > 3000
    assert run_script(LONG_WAY + TIMERS).stdout == short.stdout


def test_a_timer_made_while_a_callback_is_under_way_counts_and_few_watches_are_made(run_script):
    source = """
        import rclpy.executors
        made = 0
        class Watch(rclpy.executors.Watch):
            def __init__(self, *args):
                global made
                made += 1
                super().__init__(*args)
        rclpy.executors.Watch = Watch
        group = ReentrantCallbackGroup()
        ticks = 0
        def tick():
            global ticks
            ticks += 1
            if ticks == 50:
                node.create_timer(0.25, late, callback_group=group)
                time.sleep(0.4)
        def late():
            at(ticks, made < 60)
            rclpy.shutdown()
        node.create_timer(0.1, tick, callback_group=group)
        executor = MultiThreadedExecutor()
        executor.add_node(node)
        executor.spin()
    """
    assert run_lines(run_script, source) == ["5250 52 True"]


def test_a_coroutine_object_is_a_task(run_script):
    """As with asyncio; upstream looks at what it is given when it runs it (task.py:236)."""
    run = run_script(
        "import rclpy\nfrom rclpy.executors import SingleThreadedExecutor\nrclpy.init()\n"
        "async def seven():\n    return 7\n"
        "executor = SingleThreadedExecutor()\ntask = executor.create_task(seven())\n"
        "executor.spin_once(timeout_sec=0.1)\nprint(task.done(), task.result())\n"
    )
    assert run.stdout == "True 7\n"


def test_a_timer_that_another_thread_destroys_when_it_is_due_is_not_called(run_script):
    run = run_script("""
import rclpy, threading, time
rclpy.init()
node = rclpy.create_node("n")
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
rate = node.create_rate(10)
for _ in range(3):
    rate.sleep()
timer = node.create_timer(0.25, lambda: print("tick"))
time.sleep(0.8)
timer.cancel()
time.sleep(0.5)
timer.reset()
time.sleep(0.4)
rate.sleep()
node.destroy_rate(rate)  # its timer is due at this instant, and the executor's thread has not got the turn yet
time.sleep(0.5)
""")
    assert run.notes == []
    assert run.stdout == "tick\n" * 6


def test_a_cancelled_timer_that_another_thread_resets_wakes_the_waiting_executor(run_script):
    run = run_script("""
import rclpy, threading, time
rclpy.init()
node = rclpy.create_node("n")
begun = time.monotonic()
timer = node.create_timer(0.5, lambda: print(round(time.monotonic() - begun, 3)))
timer.cancel()
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
time.sleep(1)
timer.reset()
time.sleep(0.7)
""")
    assert run.stdout == "1.5\n"


def test_a_triggered_guard_condition_is_not_put_off_by_a_wait_with_another_timeout(run_script):
    run = run_script("""
import rclpy, time
rclpy.init()
node = rclpy.create_node("n")
begun = time.monotonic()
def tell(what):
    return lambda: print(what, round(time.monotonic() - begun, 1))
guard = node.create_guard_condition(tell("guard"))
timers = [node.create_timer(0.1, tell("timer")), node.create_timer(0.1, tell("timer"))]
time.sleep(0.15)
guard.trigger()
rclpy.spin_once(node, timeout_sec=1.0)
for timer in timers:
    timer.cancel()
rclpy.spin_once(node, timeout_sec=2.0)
""")
    assert run.stdout.splitlines()[-1] == "guard 0.2"


def test_a_coroutine_may_end_in_another_thread_than_it_began_in(run_script):
    run = run_script("""
import rclpy, time
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.task import Future
rclpy.init()
node = rclpy.create_node("n")
group = ReentrantCallbackGroup()
executor = MultiThreadedExecutor(2)
executor.add_node(node)
asked = Future()
async def ask():
    timers[0].cancel()
    await asked
    print("answered")
def occupy():
    timers[1].cancel()
    time.sleep(1)
def answer():
    timers[2].cancel()
    asked.set_result(1)
timers = [
    node.create_timer(at, callback, callback_group=group)
    for at, callback in ((0.1, ask), (0.2, occupy), (0.3, answer), (0.35, lambda: None))
]
end = time.time() + 2
while time.time() < end:
    executor.spin_once(timeout_sec=0.2)
print("end")
""")
    assert run.stdout == "answered\nend\n", run.stderr


def test_a_timeout_of_the_timers_period_loses_no_tick(run_script):
    """Upstream makes the timer of the timeout after the node's own (a01_thread_spin_main_spin_once_timeout)."""
    source = """
        import rclpy, time
        rclpy.init()
        node, ticks = rclpy.create_node("n"), []
        node.create_timer(0.1, lambda: ticks.append(time.time()))
        for _ in range(30):
            rclpy.spin_once(node, timeout_sec=0.1)
        print(len(ticks))
    """
    assert run_script(dedent(source)).stdout == "30\n"


def test_the_second_thread_that_waits_in_an_executor_fails_and_its_node_is_not_served(run_script):
    source = """
        import rclpy, threading, time
        rclpy.init()
        ticks = {"a": 0, "b": 0}
        def spin(name):
            node = rclpy.create_node(name)
            node.create_timer(0.1, lambda: ticks.update({name: ticks[name] + 1}))
            try:
                rclpy.spin(node)
            except ValueError as error:
                print(name, error)
        for name in ticks:
            threading.Thread(target=spin, args=[name], daemon=True).start()
        time.sleep(1.05)
        print(ticks)
    """
    assert run_script(dedent(source)).stdout == "b generator already executing\n{'a': 10, 'b': 0}\n"
