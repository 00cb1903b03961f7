"""rosbridge v2 (RobotWebTools, ROS 2): what JSON clients such as roslibpy, roslib and chat agents speak.

The protocol without sockets and without a clock: frames in, frames out, at instants that the caller names. In
``grader live`` these are real, in the exercises with an agent virtual. docs/live.md says what is imitated.
"""
