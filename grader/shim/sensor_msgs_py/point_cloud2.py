"""Points in and out of PointCloud2 messages. Needs numpy, which is imported when a function is called."""

from __future__ import annotations

from array import array
from collections import namedtuple
from collections.abc import Iterable
from typing import Any

from rclpy import _distro
from sensor_msgs.msg import PointCloud2, PointField

_DTYPES = {
    PointField.INT8: "i1",
    PointField.UINT8: "u1",
    PointField.INT16: "i2",
    PointField.UINT16: "u2",
    PointField.INT32: "i4",
    PointField.UINT32: "u4",
    PointField.FLOAT32: "f4",
    PointField.FLOAT64: "f8",
}


def read_points(
    cloud: Any,
    field_names: Iterable[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[int] | None = None,
    reshape_organized_cloud: bool = False,
) -> Any:
    """Return the points as a structured array.

    `field_names`: only these. `skip_nans`: leave out points with a NaN (unless the cloud says it is dense). `uvs`:
    only the points of these indices. `reshape_organized_cloud`: as (height, width) when the cloud has rows.
    """
    numpy = _numpy()
    assert isinstance(cloud, PointCloud2), "Cloud is not a sensor_msgs.msg.PointCloud2"
    layout = _layout(cloud.fields, ">" if cloud.is_bigendian else "<", cloud.point_step)
    points = numpy.ndarray((cloud.width * cloud.height,), layout, bytes(cloud.data))
    if field_names is not None:
        names = list(field_names)
        assert set(names) <= set(layout.names), "Requests field is not in the fields of the PointCloud!"
        points = points[names]
    if skip_nans and not cloud.is_dense:
        valid = numpy.ones(len(points), dtype=bool)
        for name in points.dtype.names:
            valid &= ~numpy.isnan(points[name])
        points = points[valid]
    if uvs is not None:
        points = points[numpy.fromiter(uvs, int)]
    if reshape_organized_cloud and cloud.height > 1:
        points = points.reshape(cloud.height, cloud.width)
    return points


def read_points_numpy(
    cloud: Any,
    field_names: Iterable[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[int] | None = None,
    reshape_organized_cloud: bool = False,
) -> Any:
    """Return the points as a plain array with one column per field.

    All fields must have one type; on Jazzy only those that are asked for.
    """
    names = list(field_names) if field_names is not None else None
    looked_at = names if _distro.chosen == _distro.JAZZY else None
    kinds = {field.datatype for field in cloud.fields if looked_at is None or field.name in looked_at}
    assert len(kinds) <= 1, "All fields need to have the same datatype. Use `read_points()` otherwise."
    points = read_points(cloud, names, skip_nans, uvs, reshape_organized_cloud)
    return _numpy().stack([points[name] for name in points.dtype.names], axis=-1)


def read_points_list(
    cloud: Any,
    field_names: Iterable[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[int] | None = None,
) -> list[Any]:
    """Return the points as named tuples."""
    assert isinstance(cloud, PointCloud2), "cloud is not a sensor_msgs.msg.PointCloud2"
    names = [field.name for field in cloud.fields] if field_names is None else list(field_names)
    point = namedtuple("Point", names)  # type: ignore[misc]
    return [point._make(values) for values in read_points(cloud, names, skip_nans, uvs)]


def dtype_from_fields(fields: Iterable[Any], point_step: int | None = None) -> Any:
    """Return the dtype of a point with the given fields, which is `point_step` bytes long if that is given."""
    return _layout(fields, "<", point_step)


def create_cloud(header: Any, fields: list[Any], points: Any, *step: Any, **given: Any) -> Any:
    """Return a PointCloud2 of points with the given fields, packed without gaps.

    Only Jazzy takes `point_step` besides, the bytes of a point.
    """
    if _distro.chosen == _distro.JAZZY:
        return _cloud(header, fields, points, *step, **given)
    if given:
        raise TypeError(f"create_cloud() got an unexpected keyword argument '{next(iter(given))}'")
    if step:
        raise TypeError(f"create_cloud() takes 3 positional arguments but {3 + len(step)} were given")
    return _cloud(header, fields, points)


def _cloud(header: Any, fields: list[Any], points: Any, point_step: int | None = None) -> Any:
    numpy = _numpy()
    layout = dtype_from_fields(fields, point_step)
    if isinstance(points, numpy.ndarray) and points.dtype.names is not None:
        packed = points.astype(layout)
    elif _is_table(numpy, points, fields):
        packed = numpy.empty(len(points), dtype=layout)
        for column, name in enumerate(layout.names):
            packed[name] = points[:, column]
    else:
        packed = numpy.array([tuple(point) for point in points], dtype=layout)
    data = packed.tobytes()
    return PointCloud2(
        header=header,
        height=1,
        width=len(packed),
        is_dense=False,
        is_bigendian=False,
        fields=fields,
        point_step=layout.itemsize,
        row_step=len(data),
        data=array("B", data),
    )


def _is_table(numpy: Any, points: Any, fields: list[Any]) -> bool:
    """Whether `points` is a plain array of numbers with a column for each field, and every field is a float.

    Such an array is packed column by column, which is faster. Integers are packed point by point, because only
    then numpy refuses a value that does not fit.
    """
    return (
        isinstance(points, numpy.ndarray)
        and points.dtype.kind in "fiu"
        and points.shape[1:] == (sum(field.count for field in fields),)
        and all(field.datatype in (PointField.FLOAT32, PointField.FLOAT64) for field in fields)
    )


def create_cloud_xyz32(header: Any, points: Any) -> Any:
    """Return a PointCloud2 of points (x, y, z) in single precision."""
    fields = [
        PointField(name=name, offset=4 * i, datatype=PointField.FLOAT32, count=1)
        for i, name in enumerate("xyz")
    ]
    return create_cloud(header, fields, points)


def _layout(fields: Iterable[Any], order: str, point_step: int | None) -> Any:
    """Return the dtype of a point; of a field with several values each has a name of its own."""
    numpy = _numpy()
    names, formats, offsets = [], [], []
    for i, field in enumerate(fields):
        assert field.count > 0, "Can't process fields with count = 0."
        kind = numpy.dtype(order + _DTYPES[field.datatype])
        name = field.name or f"unnamed_field_{i}"
        for a in range(field.count):
            names.append(f"{name}_{a}" if field.count > 1 else name)
            formats.append(kind)
            offsets.append(field.offset + a * kind.itemsize)
    assert len(set(names)) == len(names), "Duplicate field names are not allowed!"
    size = {} if point_step is None else {"itemsize": point_step}
    return numpy.dtype({"names": names, "formats": formats, "offsets": offsets, **size})


def _numpy() -> Any:
    import numpy

    return numpy
