"""A ROS 2 package as students hand it in: unpacked within bounds, kept in one form, read without running it."""
