"""sensor_msgs_py.point_cloud2: points in and out."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import PointField
from sensor_msgs_py import point_cloud2
from std_msgs.msg import Header, String

from tests.shim.test_files import SITE_PACKAGES

POINTS = [(1.0, 2.0, 3.0), (4.0, 5.0, math.nan)]


def test_points_come_back() -> None:
    cloud = point_cloud2.create_cloud_xyz32(Header(frame_id="laser"), POINTS)
    assert (cloud.header.frame_id, cloud.height, cloud.width, cloud.point_step) == ("laser", 1, 2, 12)
    points = point_cloud2.read_points(cloud)
    assert points.dtype.names == ("x", "y", "z")
    assert points["y"].tolist() == [2.0, 5.0]
    assert point_cloud2.read_points_list(cloud, ["z", "x"])[0] == (3.0, 1.0)
    assert point_cloud2.read_points_list(cloud)[0].x == 1.0
    assert point_cloud2.read_points_numpy(cloud, ["x", "y"]).tolist() == [[1.0, 2.0], [4.0, 5.0]]


def test_selection() -> None:
    cloud = point_cloud2.create_cloud_xyz32(Header(), POINTS)
    assert len(point_cloud2.read_points(cloud, skip_nans=True)) == 1
    assert point_cloud2.read_points(cloud, uvs=[1])["x"].tolist() == [4.0]
    with pytest.raises(AssertionError, match="Requests field is not in the fields of the PointCloud!"):
        point_cloud2.read_points(cloud, ["intensity"])
    with pytest.raises(AssertionError, match="Cloud is not"):
        point_cloud2.read_points(String())


def test_mixed_types_and_rows() -> None:
    fields = [
        PointField(name="x", offset=0, datatype=PointField.FLOAT64, count=1),
        PointField(name="ring", offset=8, datatype=PointField.UINT16, count=1),
    ]
    cloud = point_cloud2.create_cloud(Header(), fields, [(0.5, 1), (1.5, 2)])
    assert (cloud.point_step, cloud.row_step, len(cloud.data)) == (10, 20, 20)
    cloud.height, cloud.width = 2, 1
    rows = point_cloud2.read_points(cloud, reshape_organized_cloud=True)
    assert rows.shape == (2, 1)
    assert rows["ring"].tolist() == [[1], [2]]
    with pytest.raises(AssertionError, match="same datatype"):
        point_cloud2.read_points_numpy(cloud)
    again = point_cloud2.create_cloud(
        Header(), fields, np.array([(0.5, 1)], dtype=[("x", "f4"), ("ring", "i4")])
    )
    assert point_cloud2.read_points_list(again) == [(0.5, 1)]


@pytest.mark.parametrize("kind", ["f8", "f4", "i8"])
def test_an_array_is_packed_as_its_rows_are(kind: str) -> None:
    rows = np.arange(12).reshape(4, 3).astype(kind) / 1 if kind != "i8" else np.arange(12).reshape(4, 3)
    whole = point_cloud2.create_cloud_xyz32(Header(), rows)
    assert whole == point_cloud2.create_cloud_xyz32(Header(), rows.tolist())
    assert point_cloud2.read_points_list(whole)[1] == (3.0, 4.0, 5.0)
    with pytest.raises((ValueError, TypeError)):
        point_cloud2.create_cloud_xyz32(Header(), rows[:, :2])


MIXED = """
from sensor_msgs.msg import PointField
from sensor_msgs_py import point_cloud2
from std_msgs.msg import Header
fields = [
    PointField(name='x', offset=0, datatype=PointField.FLOAT32, count=2),
    PointField(name='ring', offset=8, datatype=PointField.UINT16, count=1),
]
print(point_cloud2.dtype_from_fields(fields, point_step=12))
try:
    cloud = point_cloud2.create_cloud(Header(), fields, [(0.5, 1.5, 1)], point_step=16)
    print(cloud.point_step, len(cloud.data), point_cloud2.read_points(cloud)[0])
except TypeError as error:
    print(error)
cloud = point_cloud2.create_cloud(Header(), fields, [(0.5, 1.5, 1)])
cloud.fields = [PointField(name='x', datatype=PointField.FLOAT32, count=1), fields[1]]
try:
    print(point_cloud2.read_points_numpy(cloud, ['x']))
except AssertionError as error:
    print(error)
"""


def test_jazzy_takes_the_size_of_a_point_and_asks_less_of_the_fields(run_script: Callable[..., Any]) -> None:
    layout = (
        "{'names': ['x_0', 'x_1', 'ring'], 'formats': ['<f4', '<f4', '<u2'], 'offsets': [0, 4, 8], 'itemsize': 12}"
    )
    assert run_script(MIXED, distro="jazzy", preload=[SITE_PACKAGES]).stdout.splitlines() == [
        layout, "16 16 (0.5, 1.5, 1)", "[[0.5]]",
    ]  # fmt: skip
    assert run_script(MIXED, preload=[SITE_PACKAGES]).stdout.splitlines() == [
        layout,
        "create_cloud() got an unexpected keyword argument 'point_step'",
        "All fields need to have the same datatype. Use `read_points()` otherwise.",
    ]
