"""Reading and writing sensor_msgs, with the public names of sensor_msgs_py (ROS 2 Humble)."""
