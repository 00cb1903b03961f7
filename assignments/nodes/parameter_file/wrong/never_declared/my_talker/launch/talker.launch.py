import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    file = os.path.join(get_package_share_directory('my_talker'), 'config', 'talker.yaml')
    return LaunchDescription([Node(package='my_talker', executable='talker', parameters=[file])])
