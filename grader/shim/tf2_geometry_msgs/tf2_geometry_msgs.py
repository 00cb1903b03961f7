"""What `Buffer.transform` does to each type of geometry_msgs."""

from __future__ import annotations

from typing import Any

import tf2_ros
from geometry_msgs.msg import (
    Point,
    Point32,
    PointStamped,
    PolygonStamped,
    Pose,
    PoseStamped,
    PoseWithCovarianceStamped,
    Quaternion,
    TransformStamped,  # noqa: F401 - upstream passes it on
    Vector3,
    Vector3Stamped,
)
from tf2_py import _algebra


def to_msg_msg(msg: Any) -> Any:
    """Return the message itself."""
    return msg


def from_msg_msg(msg: Any) -> Any:
    """Return the message itself."""
    return msg


def do_transform_point(point: Any, transform: Any) -> Any:
    """Return a PointStamped moved by a TransformStamped."""
    x, y, z = _rigid(transform).apply((point.point.x, point.point.y, point.point.z))
    return PointStamped(header=transform.header, point=Point(x=x, y=y, z=z))


def do_transform_vector3(vector3: Any, transform: Any) -> Any:
    """Return a Vector3Stamped turned by a TransformStamped."""
    vector = vector3.vector
    x, y, z = _algebra.rotate(_rigid(transform).rotation, (vector.x, vector.y, vector.z))
    return Vector3Stamped(header=transform.header, vector=Vector3(x=x, y=y, z=z))


def do_transform_pose(pose: Any, transform: Any) -> Any:
    """Return a Pose moved by a TransformStamped."""
    p, o = pose.position, pose.orientation
    moved = _rigid(transform) @ _algebra.Rigid((p.x, p.y, p.z), _algebra.normalize((o.x, o.y, o.z, o.w)))
    (x, y, z), q = moved
    qx, qy, qz, qw = (-part for part in q) if q[3] < 0.0 else q  # upstream tells the rotation with w >= 0
    return Pose(position=Point(x=x, y=y, z=z), orientation=Quaternion(x=qx, y=qy, z=qz, w=qw))


def do_transform_pose_stamped(pose: Any, transform: Any) -> Any:
    """Return a PoseStamped moved by a TransformStamped."""
    return PoseStamped(header=transform.header, pose=do_transform_pose(pose.pose, transform))


def do_transform_pose_with_covariance_stamped(pose: Any, transform: Any) -> Any:
    """Return a PoseWithCovarianceStamped moved by a TransformStamped."""
    moved = PoseWithCovarianceStamped(header=transform.header)
    moved.pose.pose = do_transform_pose(pose.pose.pose, transform)
    moved.pose.covariance = transform_covariance(pose.pose.covariance, transform)
    return moved


def do_transform_polygon_stamped(polygon: Any, transform: Any) -> Any:
    """Return a PolygonStamped moved by a TransformStamped."""
    rigid = _rigid(transform)
    moved = PolygonStamped(header=transform.header)
    for point in polygon.polygon.points:
        x, y, z = rigid.apply((point.x, point.y, point.z))
        moved.polygon.points.append(Point32(x=x, y=y, z=z))
    return moved


def transform_covariance(cov_in: Any, transform: Any) -> list[float]:
    """Return a 6 x 6 covariance (row by row) turned by a TransformStamped."""
    rotation = _rigid(transform).rotation
    axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    columns = [_algebra.rotate(rotation, axis) for axis in axes]
    full = [[0.0] * 6 for _ in range(6)]
    for block in (0, 3):
        for row in range(3):
            for column in range(3):
                full[block + row][block + column] = columns[column][row]
    cov = [[float(cov_in[6 * row + column]) for column in range(6)] for row in range(6)]
    half = [[sum(full[i][k] * cov[k][j] for k in range(6)) for j in range(6)] for i in range(6)]
    return [sum(half[i][k] * full[j][k] for k in range(6)) for i in range(6) for j in range(6)]


def _rigid(transform: Any) -> _algebra.Rigid:
    t, q = transform.transform.translation, transform.transform.rotation
    return _algebra.Rigid((t.x, t.y, t.z), _algebra.normalize((q.x, q.y, q.z, q.w)))


for _type in (Vector3Stamped, PoseStamped, PointStamped):
    tf2_ros.ConvertRegistration().add_to_msg(_type, to_msg_msg)
    tf2_ros.ConvertRegistration().add_from_msg(_type, from_msg_msg)
for _type, _function in {
    PointStamped: do_transform_point,
    Vector3Stamped: do_transform_vector3,
    PoseStamped: do_transform_pose_stamped,
    PoseWithCovarianceStamped: do_transform_pose_with_covariance_stamped,
    PolygonStamped: do_transform_polygon_stamped,
}.items():
    tf2_ros.TransformRegistration().add(_type, _function)
