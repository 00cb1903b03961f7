"""Interface classes as a script on the shim meets them."""

from collections.abc import Callable
from typing import Any


def test_messages_can_be_imported_before_rclpy(run_bare: Callable[..., Any]) -> None:
    run = run_bare("from geometry_msgs.msg import Twist\nprint(Twist().linear.x)\n")
    assert run.stdout == "0.0\n"


def test_an_int_in_a_float_field_ends_the_script_at_its_line(run_bare: Callable[..., Any]) -> None:
    run = run_bare("from geometry_msgs.msg import Twist\nmsg = Twist()\nmsg.linear.x = 1\n")
    assert (run.exit["type"], run.exit["line"]) == ("AssertionError", 3)
    assert run.exit["message"] == "The 'x' field must be of type 'float'"


def test_a_misspelt_type_is_pythons_import_error(run_bare: Callable[..., Any]) -> None:
    run = run_bare("from geometry_msgs.msg import twist\n")
    assert (run.exit["type"], run.exit["line"]) == ("ImportError", 1)
    assert run.exit["message"].startswith(
        "cannot import name 'twist' from 'geometry_msgs.msg' (/opt/ros/humble/"
    )
