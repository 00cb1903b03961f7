"""Action clients and servers."""

from textwrap import dedent

PREFIX = """
import time, threading
import rclpy
from rclpy.action import *
from rclpy.action.client import ClientGoalHandle, GoalStatus
from rclpy.executors import MultiThreadedExecutor
from rclpy.callback_groups import ReentrantCallbackGroup
from example_interfaces.action import Fibonacci
rclpy.init()
node = rclpy.create_node("n")
group = ReentrantCallbackGroup()
executor = MultiThreadedExecutor(4)
executor.add_node(node)
def at(*what):
    print(int(time.time() - 1_700_000_000), *what)
def work(goal):
    for step in range(goal.request.order):
        if goal.is_cancel_requested:
            goal.canceled()
            return Fibonacci.Result()
        goal.publish_feedback(Fibonacci.Feedback(sequence=[step]))
        time.sleep(1)
    goal.succeed()
    return Fibonacci.Result(sequence=[7])
client = ActionClient(node, Fibonacci, "fib", callback_group=group)
def wait(future):
    executor.spin_until_future_complete(future)
    return future.result()
"""


def run_lines(run_script, source, **options):
    run = run_script(PREFIX + dedent(source), **options)
    assert run.exit["reason"] == 0, run.stderr + run.exit["text"]
    return run.stdout.splitlines()


def test_goal_feedback_and_result(run_script):
    source = """
        print(client.wait_for_server(0.5))
        server = ActionServer(node, Fibonacci, "fib", work, callback_group=group)
        print(client.wait_for_server(), get_action_names_and_types(node))
        goal = wait(client.send_goal_async(Fibonacci.Goal(order=2), lambda m: at(list(m.feedback.sequence))))
        print(goal.accepted)
        answer = wait(goal.get_result_async())
        at(answer.status, answer.result.sequence, goal.status)
    """
    assert run_lines(run_script, source) == [
        "False",
        "True [('/fib', ['example_interfaces/action/Fibonacci'])]",
        "True",
        "0 [0]",
        "1 [1]",
        "2 4 array('i', [7]) 4",
    ]


def test_cancelling(run_script):
    source = """
        server = ActionServer(
            node, Fibonacci, "fib", work, callback_group=group,
            cancel_callback=lambda goal: CancelResponse.ACCEPT,
        )
        goal = wait(client.send_goal_async(Fibonacci.Goal(order=9)))
        result = goal.get_result_async()
        executor.spin_until_future_complete(result, 2.5)
        print(result.done(), len(wait(goal.cancel_goal_async()).goals_canceling))
        at(wait(result).status)
    """
    assert run_lines(run_script, source) == ["False 1", "3 5"]


def test_rejection_abortion_and_errors(run_script):
    source = """
        def broken(goal):
            return Fibonacci.Result()
        server = ActionServer(
            node, Fibonacci, "fib", broken, callback_group=group,
            goal_callback=lambda goal: GoalResponse.ACCEPT if goal.order else GoalResponse.REJECT,
        )
        print(wait(client.send_goal_async(Fibonacci.Goal(order=0))).accepted)
        goal = wait(client.send_goal_async(Fibonacci.Goal(order=1)))
        print(wait(goal.get_result_async()).status)
        for bad in (None, Fibonacci.Result()):
            try:
                client.send_goal_async(bad)
            except TypeError:
                print("refused")
    """
    assert run_lines(run_script, source) == ["False", "6", "refused", "refused"]


def test_blocking_calls_need_another_thread(run_script):
    source = """
        server = ActionServer(node, Fibonacci, "fib", work, callback_group=group)
        threading.Thread(target=executor.spin, daemon=True).start()
        at(client.send_goal(Fibonacci.Goal(order=3)).status)
    """
    assert run_lines(run_script, source) == ["3 4"]


def test_goal_ids_are_the_same_in_every_run(run_script):
    source = """
        server = ActionServer(node, Fibonacci, "fib", work, callback_group=group)
        goals = [client.send_goal_async(Fibonacci.Goal()) for _ in range(2)]
        print([bytes(wait(goal).goal_id._uuid).hex() for goal in goals])
    """
    first = run_lines(run_script, source)
    assert first == run_lines(run_script, source)
    assert len(set(eval(first[0]))) == 2


def test_a_name_that_cannot_be_is_refused_as_upstreams_c_code_refuses_it(run_script):
    run = run_script("""
import rclpy
from rclpy.action import ActionClient, ActionServer
from turtlesim.action import RotateAbsolute
rclpy.init()
node = rclpy.create_node("n")
for name in ("a b", ""):
    for make in (ActionClient, lambda *args: ActionServer(*args, print)):
        try:
            make(node, RotateAbsolute, name)
        except ValueError as error:
            print(error)
""")
    assert run.stdout.splitlines() == [
        "Failed to create action client due to invalid topic name 'a b' : topic name is invalid, at "
        "./src/rcl/expand_topic_name.c:73",
        "Failed to create action server due to invalid topic name 'a b' : : topic name is invalid, at "
        "./src/rcl/expand_topic_name.c:73",
        "Failed to create action client: failed to get goal service name, at ./src/rcl_action/action_client.c:217",
        "Failed to create action server due to invalid topic name '' : : invalid empty action name, at "
        "./src/rcl_action/names.c:36",
    ]


def test_what_comes_while_the_server_runs_waits_for_the_clients_next_turn(run_script):
    run = run_script("""
import rclpy
from rclpy.action import ActionClient, ActionServer
from example_interfaces.action import Fibonacci
rclpy.init()
node = rclpy.create_node("n")
handles = []
def work(goal):
    if handles:
        handles[0].cancel_goal_async().add_done_callback(lambda future: print("cancelled"))
    goal.succeed()
    return Fibonacci.Result()
server = ActionServer(node, Fibonacci, "fib", work)
client = ActionClient(node, Fibonacci, "fib")
def accepted(future):
    print("accepted")
    handles.append(future.result())
for _ in range(2):
    client.send_goal_async(Fibonacci.Goal()).add_done_callback(accepted)
    for _ in range(12):
        rclpy.spin_once(node, timeout_sec=0.01)
""")
    assert run.stdout == "accepted\naccepted\ncancelled\n"
