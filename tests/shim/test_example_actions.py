"""The actions that ROS 2 courses show, client and server in one process: feedback, cancelling, refusing."""

from collections.abc import Callable
from typing import Any

from tests.shim.course_nodes import ACTIONS, HEAD, said

RunScript = Callable[..., Any]


def test_an_action_gives_feedback_and_a_result(run_script: RunScript) -> None:
    run = run_script(
        HEAD + ACTIONS + "spin_in_thread(Server())\nnode = Client()\nnode.result(node.send(4))\n"
    )
    lines = said(run)
    assert sorted(lines[:2]) == ["0.0 client: accepted", "0.0 client: feedback [0, 1, 1]"]
    assert lines[2:] == [
        "1.0 client: feedback [0, 1, 1, 2]",
        "2.0 client: feedback [0, 1, 1, 2, 3]",
        "3.0 client: status 4 [0, 1, 1, 2, 3]",
    ]


def test_an_action_is_canceled(run_script: RunScript) -> None:
    run = run_script(
        HEAD + ACTIONS + "spin_in_thread(Server(cancel_callback=lambda goal: CancelResponse.ACCEPT),"
        " MultiThreadedExecutor())\nnode = Client()\nhandle = node.send(9)\n"
        "node.create_timer(1.5, lambda: handle.cancel_goal_async())\nnode.result(handle)\n"
    )
    assert said(run)[-1] == "2.0 client: status 5 [0, 1, 1, 2]"
    assert len(said(run)) == 4


def test_an_action_refuses_a_goal(run_script: RunScript) -> None:
    run = run_script(
        HEAD + ACTIONS + "def judge(goal):\n"
        "    return GoalResponse.ACCEPT if goal.order < 5 else GoalResponse.REJECT\n"
        "spin_in_thread(Server(goal_callback=judge))\nnode = Client()\nnode.send(7)\nnode.result(node.send(2))\n"
    )
    lines = said(run)
    assert lines[0] == "0.0 client: rejected"
    assert sorted(lines[1:3]) == ["0.0 client: accepted", "0.0 client: feedback [0, 1, 1]"]
    assert lines[3:] == ["1.0 client: status 4 [0, 1, 1]"]


def test_a_goal_is_executed_later(run_script: RunScript) -> None:
    run = run_script(
        HEAD + ACTIONS + "def accepted(goal):\n    server.goal = goal\n"
        "    server.timer = server.create_timer(2.0, start)\n"
        "def start():\n    server.timer.cancel()\n    server.goal.execute()\n"
        "server = Server(handle_accepted_callback=accepted)\nspin_in_thread(server)\n"
        "node = Client()\nnode.result(node.send(3))\n"
    )
    assert said(run)[0] == "0.0 client: accepted"
    assert said(run)[1] == "2.0 client: feedback [0, 1, 1]"
    assert said(run)[-1] == "4.0 client: status 4 [0, 1, 1, 2]"


def test_a_new_goal_aborts_the_one_before(run_script: RunScript) -> None:
    run = run_script(
        HEAD + ACTIONS + "current = None\ndef accepted(goal):\n    global current\n"
        "    if current is not None and current.is_active:\n        current.abort()\n"
        "    current = goal\n    goal.execute()\n"
        "spin_in_thread(Server(handle_accepted_callback=accepted), MultiThreadedExecutor())\n"
        "node = Client()\nfirst = node.send(8)\ntime.sleep(1.5)\nsecond = node.send(3)\n"
        "node.result(first)\nnode.result(second)\n"
    )
    results = [line for line in said(run) if "status" in line]
    assert results == ["2.0 client: status 6 []", "3.5 client: status 4 [0, 1, 1, 2]"]


def test_two_goals_run_side_by_side(run_script: RunScript) -> None:
    run = run_script(
        HEAD + ACTIONS + "import asyncio\n"
        "async def spin():\n    while rclpy.ok():\n        rclpy.spin_once(node, timeout_sec=0)\n"
        "        await asyncio.sleep(0.001)\n"
        "async def ask(order):\n"
        "    handle = await node.client.send_goal_async(Fibonacci.Goal(order=order))\n"
        "    result = await handle.get_result_async()\n    return list(result.result.sequence)\n"
        "async def main():\n    spinning = asyncio.ensure_future(spin())\n"
        "    print(await asyncio.gather(ask(3), ask(5)), round(time.time() % 10, 1))\n    spinning.cancel()\n"
        "spin_in_thread(Server(), MultiThreadedExecutor())\nnode = Client()\nasyncio.run(main())\n"
    )
    assert run.stdout == "[[0, 1, 1, 2], [0, 1, 1, 2, 3, 5]] 4.0\n"
