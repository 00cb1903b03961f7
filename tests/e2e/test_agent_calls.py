"""A chat agent asks for the next thing as soon as it has its answer, whatever else the script is busy with."""

from dataclasses import replace

import pytest

from grader.contracts.assignment import AgentStep
from grader.contracts.grading import Grader, GradingJob
from tests.e2e.grading_slot import catalog

SECOND = 1_000_000_000
SERVER = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Trigger
rclpy.init()
node = Node('server')
said = node.create_publisher(String, '/said', 10)
def answer(request, response):
    node.get_logger().info('asked')
    response.success = True
    return response
node.create_service(Trigger, '/ask', answer)
def tick():
    said.publish(String(data='here'))
node.create_timer(PERIOD, TICK)
rclpy.spin(node)
"""


def asked_at(grader: Grader, source: str, *steps: AgentStep) -> list[float]:
    task = replace(catalog().get("agent_tools"), agent=steps)
    job = GradingJob(file_name="server.py", source=source.encode(), assignment=task)
    logs = grader.grade(job).report.runs[0].outcome.logs
    return [round(record.t_ns / SECOND, 3) for record in logs if record.message == "asked"]


def call(at_s: int) -> AgentStep:
    return AgentStep(at_ns=at_s * SECOND, tool="call", target="/ask", type="std_srvs/srv/Trigger")


@pytest.mark.parametrize("period", ["0.05", "0.5", "20.0"])
def test_calls_come_at_their_times_beside_a_timer(grader: Grader, period: str) -> None:
    source = SERVER.replace("PERIOD", period).replace("TICK", "lambda: None")
    assert asked_at(grader, source, call(3), call(5), call(7)) == [3.0, 5.0, 7.0]


def test_a_message_that_the_agent_waits_for_lets_it_go_on_at_once(grader: Grader) -> None:
    source = SERVER.replace("PERIOD", "2.0").replace("TICK", "tick")
    read = AgentStep(at_ns=3 * SECOND, tool="read", target="/said", type="std_msgs/msg/String")
    assert asked_at(grader, source, read, call(3)) == [4.0]
