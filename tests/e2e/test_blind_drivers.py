"""Nobody earns an exercise with a sensor or a goal without looking (`grader.grading.examination.blind`)."""

import pytest

from grader.catalog import Catalog, set_root
from grader.catalog.files import handed_in
from grader.contracts.grading import Grader
from grader.grading.examination import OwnScript
from grader.grading.examination.blind import MOST_PCT, driven_blindly, looks
from tests.e2e.grading_slot import catalog, grade

SETS = (Catalog(), Catalog(set_root("robot")))
EXERCISES = [one.id for each in SETS for one in each.all() if looks(one)]

SMALL_CIRCLE = """
import rclpy
from geometry_msgs.msg import Twist
rclpy.init()
node = rclpy.create_node('small_circle')
publisher = node.create_publisher(Twist, '/cmd_vel', 10)
def drive():
    message = Twist()
    message.linear.x, message.angular.z = 0.1, -1.0
    publisher.publish(message)
node.create_timer(0.1, drive)
rclpy.spin(node)
"""
SIDE_WALL = SMALL_CIRCLE.replace(
    "message.linear.x, message.angular.z = 0.1, -1.0",
    "k = int(node.get_clock().now().nanoseconds / 1e8) - start\n"
    "    message.angular.z = 0.785 if k <= 20 else 0.0\n"
    "    message.linear.x = 0.1 if 25 < k <= 68 else 0.0",
).replace("def drive", "start = int(node.get_clock().now().nanoseconds / 1e8)\ndef drive")
CORNER_THEN_RECKONING = """
import math, time
import rclpy
from geometry_msgs.msg import Twist
from rclpy.action import ActionClient
from turtlesim.action import RotateAbsolute
rclpy.init()
node = rclpy.create_node('reckoning')
publisher = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
rotation = ActionClient(node, RotateAbsolute, '/turtle1/rotate_absolute')
rotation.wait_for_server()
def leg(heading, distance, speed):
    goal = rotation.send_goal_async(RotateAbsolute.Goal(theta=heading))
    rclpy.spin_until_future_complete(node, goal)
    rclpy.spin_until_future_complete(node, goal.result().get_result_async())
    message = Twist()
    message.linear.x = speed
    for _ in range(int(distance / speed / 0.1)):
        publisher.publish(message)
        time.sleep(0.1)
    publisher.publish(Twist())
    time.sleep(0.2)
leg(math.pi, 12.0, 4.0)
leg(-math.pi / 2, 12.0, 4.0)
leg(0.0, 8.0, 2.0)
leg(math.pi / 2, 3.0, 2.0)
"""
RANDOM_POINTS = """
import math, random
import rclpy
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
rclpy.init()
node = rclpy.create_node('wander')
publisher = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
aim = [5.0, 5.0]
def steer(pose):
    if math.hypot(aim[0] - pose.x, aim[1] - pose.y) < 0.3:
        aim[:] = random.uniform(0.5, 10.5), random.uniform(0.5, 10.5)
    error = math.remainder(math.atan2(aim[1] - pose.y, aim[0] - pose.x) - pose.theta, math.tau)
    message = Twist()
    message.angular.z, message.linear.x = 4.0 * error, 2.0 if abs(error) < 0.5 else 0.0
    publisher.publish(message)
node.create_subscription(Pose, '/turtle1/pose', steer, 10)
rclpy.spin(node)
"""


@pytest.mark.parametrize(
    ("assignment", "script"),
    [
        ("follow_wall", SMALL_CIRCLE),
        ("stop_before_wall", SIDE_WALL),
        ("go_to_goal", CORNER_THEN_RECKONING),
        ("go_to_goal", RANDOM_POINTS),
    ],
)
def test_a_script_that_does_not_look_earns_little(grader: Grader, assignment: str, script: str) -> None:
    report = grade(grader, assignment, script)
    assert report.status == "graded"
    assert 5.0 <= (report.score or 0.0) <= MOST_PCT


def test_every_exercise_with_a_sensor_or_a_goal_is_tried() -> None:
    assert {"go_to_goal", "patrol", "parking", "follow_wall", "stop_before_wall", "maze"} <= set(EXERCISES)
    assert not looks(catalog().get("square"))


@pytest.mark.slow
@pytest.mark.parametrize("name", EXERCISES)
def test_no_blind_driver_earns_an_exercise(grader: Grader, name: str) -> None:
    task = catalog().get(name)
    file = catalog().own_file(task, "solution")
    solution = OwnScript(name=file.name, source=handed_in(file))
    found = driven_blindly(task, solution, grader, catalog().with_seeds(100).get(name))
    assert len(found) == 10
    assert not [one for one in found if (one.score or 0.0) > MOST_PCT]
