"""Packages as ``ros2 pkg create --build-type ament_python`` and their readers leave them, and zips of them."""

import io
import zipfile
from collections.abc import Mapping

MANIFEST = """<?xml version="1.0"?>
<package format="3">
  <name>{name}</name>
  <version>0.0.0</version>
  <depend>rclpy</depend>
  <depend>geometry_msgs</depend>
  <export><build_type>ament_python</build_type></export>
</package>
"""
SETUP = """import os
from glob import glob
from setuptools import find_packages, setup

package_name = '{name}'

setup(
    name=package_name,
    version='0.0.0',
    packages=find_packages(exclude=['test']),
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
        (os.path.join('share', package_name, 'config'), glob('config/*.yaml')),
        (os.path.join('share', package_name, 'launch'), glob('launch/*.launch.py')),
    ],
    entry_points={{
        'console_scripts': [
            'drive = {name}.drive:main',
        ],
    }},
)
"""
CONFIG = "[develop]\nscript_dir=$base/lib/{name}\n[install]\ninstall_scripts=$base/lib/{name}\n"
DRIVE = """import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from {name}.helper import forward


class Drive(Node):
    def __init__(self):
        super().__init__('drive')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.speed = self.declare_parameter('speed', 1.0).value
        self.create_timer(0.1, self.tick)

    def tick(self):
        self.pub.publish(forward(self.speed))


def main():
    rclpy.init()
    rclpy.spin(Drive())
"""
HELPER = """from geometry_msgs.msg import Twist


def forward(speed):
    msg = Twist()
    msg.linear.x = speed
    return msg
"""
NAME = "my_turtle"


def package_files(name: str = NAME, **changed: str | None) -> dict[str, str]:
    """Return a right package below its folder; `changed` are other contents, by path with ``__`` for ``/``.

    A content of None takes the file away.
    """
    files: dict[str, str | None] = {
        "package.xml": MANIFEST.format(name=name),
        "setup.py": SETUP.format(name=name),
        "setup.cfg": CONFIG.format(name=name),
        f"resource/{name}": "",
        f"{name}/__init__.py": "",
        f"{name}/drive.py": DRIVE.format(name=name),
        f"{name}/helper.py": HELPER,
    }
    return below(name, {path: text for path, text in {**files, **changed}.items() if text is not None})


def below(folder: str, files: Mapping[str, str]) -> dict[str, str]:
    """Return files as they are inside a folder."""
    return {f"{folder}/{path}": text for path, text in files.items()}


def zipped(files: Mapping[str, str | bytes], method: int = zipfile.ZIP_DEFLATED) -> bytes:
    """Return files as a zip, in their order; packed lightly, since bombs of 300 MB are among them."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", method, compresslevel=1) as archive:
        for path, content in files.items():
            archive.writestr(path, content)
    return out.getvalue()
