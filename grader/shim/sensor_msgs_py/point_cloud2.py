"""Points in and out of PointCloud2 messages. Needs numpy, which is imported when a function is called."""

from __future__ import annotations

from array import array
from collections import namedtuple
from collections.abc import Iterable
from typing import Any

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

    Args:
        cloud: the PointCloud2.
        field_names: only these fields; all when left out.
        skip_nans: leave out points with a NaN (unless the cloud says it is dense).
        uvs: only the points of these indices.
        reshape_organized_cloud: as (height, width) when the cloud has rows.
    """
    numpy = _numpy()
    assert isinstance(cloud, PointCloud2), "Cloud is not a sensor_msgs.msg.PointCloud2"
    layout = _layout(cloud)
    points = numpy.ndarray((cloud.width * cloud.height,), layout, bytes(cloud.data))
    if field_names is not None:
        wanted = list(field_names)
        assert set(wanted) <= set(layout.names), "Requests field is not in the fields of the PointCloud!"
        points = points[wanted]
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
    """Return the points as a plain array with one column per field; all fields must have one type."""
    assert len({field.datatype for field in cloud.fields}) <= 1, (
        "All fields need to have the same datatype. Use `read_points()` otherwise."
    )
    points = read_points(cloud, field_names, skip_nans, uvs, reshape_organized_cloud)
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


def create_cloud(header: Any, fields: list[Any], points: Any) -> Any:
    """Return a PointCloud2 of points with the given fields, packed without gaps."""
    numpy = _numpy()
    layout = numpy.dtype(
        {
            "names": [field.name for field in fields],
            "formats": ["<" + _DTYPES[field.datatype] for field in fields],
            "offsets": [field.offset for field in fields],
        }
    )
    if isinstance(points, numpy.ndarray) and points.dtype.names is not None:
        packed = points.astype(layout)
    elif _is_table(numpy, points, fields):
        packed = numpy.empty(len(points), dtype=layout)
        for column, field in enumerate(fields):
            packed[field.name] = points[:, column]
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
        and points.shape[1:] == (len(fields),)
        and all(field.datatype in (PointField.FLOAT32, PointField.FLOAT64) for field in fields)
    )


def create_cloud_xyz32(header: Any, points: Any) -> Any:
    """Return a PointCloud2 of points (x, y, z) in single precision."""
    fields = [
        PointField(name=name, offset=4 * i, datatype=PointField.FLOAT32, count=1)
        for i, name in enumerate("xyz")
    ]
    return create_cloud(header, fields, points)


def _layout(cloud: Any) -> Any:
    """Return the dtype of one point of a cloud."""
    names = [field.name or f"unnamed_field_{i}" for i, field in enumerate(cloud.fields)]
    assert len(set(names)) == len(names), "Duplicate field names are not allowed!"
    order = ">" if cloud.is_bigendian else "<"
    return _numpy().dtype(
        {
            "names": names,
            "formats": [order + _DTYPES[field.datatype] for field in cloud.fields],
            "offsets": [field.offset for field in cloud.fields],
            "itemsize": cloud.point_step,
        }
    )


def _numpy() -> Any:
    import numpy

    return numpy
