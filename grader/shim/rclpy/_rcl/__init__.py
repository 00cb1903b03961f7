"""What upstream has in C: rcl, rmw and rcutils, as far as rclpy and scripts notice them."""
