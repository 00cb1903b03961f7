"""Arithmetic of planes with the same last bit on every processor, C library, numpy and Python.

IEEE 754 fixes the result of + - * / and of the square root, but not of a sine, an arc tangent or a hypotenuse: C
libraries round them differently with and without FMA, and numpy with AVX-512. Nor does it fix a sum of products in
BLAS, numpy's product of complex arrays, or ``sum`` of floats, which compensates from Python 3.12 on. So everything
between a recorded trajectory and its report is computed by these functions: polynomials of the operations that are
fixed, one numpy call for each, so that no compiler can fuse two. `tests/architecture/test_exact.py` forbids the
others by name.

A function takes floats or arrays, and gives the same bits for both. It is off by a few units of the last place.
"""

import math
from collections.abc import Iterable, Sequence
from typing import Final, TypeVar

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Points = NDArray[np.complex128]
Value = TypeVar("Value", float, Floats)

_QUARTERS_PER_RAD: Final = 0.6366197723675814
# Half of pi in three parts. The first two have 33 bits, so that a multiple of them below 2^20 is exact.
_QUARTER_RAD: Final = (1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21)
# Taylor series, highest power first: on an eighth of a turn the next term is below the last bit.
_SIN: Final = tuple((-1) ** k / math.factorial(2 * k + 1) for k in range(8, 0, -1))
_COS: Final = tuple((-1) ** k / math.factorial(2 * k) for k in range(9, 0, -1))
_ATAN: Final = tuple((-1) ** k / (2 * k + 1) for k in range(8, 0, -1))
_EIGHTHS: Final = (
    0.0, 0.12435499454676144, 0.24497866312686414, 0.35877067027057225, 0.4636476090008061,
    0.5585993153435624, 0.6435011087932844, 0.7188299996216245, 0.7853981633974483,
)  # fmt: skip
"""Arc tangents of 0, 1/8, ..., 1."""
_EIGHTHS_ARRAY: Final = np.array(_EIGHTHS)


def cos_sin(angle_rad: Value) -> tuple[Value, Value]:
    """Return cosine and sine."""
    if isinstance(angle_rad, np.ndarray):
        quarters = np.rint(angle_rad * _QUARTERS_PER_RAD)
        cos, sin = _near_zero(_rest(angle_rad, quarters))
        odd, third = np.mod(quarters, 2.0) == 1.0, np.mod(quarters, 4.0)
        cos, sin = np.where(odd, sin, cos), np.where(odd, cos, sin)
        flips_cos = (third == 1.0) | (third == 2.0)
        return np.where(flips_cos, -cos, cos), np.where(third >= 2.0, -sin, sin)
    angle = float(angle_rad)
    if not math.isfinite(angle):
        return math.nan, math.nan
    quarter = round(angle * _QUARTERS_PER_RAD)
    c, s = _near_zero(_rest(angle, float(quarter)))
    return ((c, s), (-s, c), (-c, -s), (s, -c))[quarter % 4]


def cos(angle_rad: Value) -> Value:
    """Return the cosine."""
    return cos_sin(angle_rad)[0]


def sin(angle_rad: Value) -> Value:
    """Return the sine."""
    return cos_sin(angle_rad)[1]


def hypot(x: Value, y: Value) -> Value:
    """Return the length of (x, y)."""
    square: Value = x * x + y * y
    if isinstance(square, np.ndarray):
        lengths: Floats = np.sqrt(square)
        return lengths
    return math.sqrt(square)


def apart(one: Sequence[float], other: Sequence[float]) -> float:
    """Return the distance between two points of the same dimension."""
    return length([a - b for a, b in zip(one, other, strict=True)])


def length(vector: Iterable[float]) -> float:
    """Return the length of a vector of any dimension; NaN where one component is no finite number."""
    return math.sqrt(total(component * component for component in vector))


def atan2(y: Value, x: Value) -> Value:
    """Return the direction of (x, y), from -pi to pi; 0 for the origin."""
    if isinstance(y, np.ndarray) or isinstance(x, np.ndarray):
        return _directions(np.asarray(y, dtype=np.float64), np.asarray(x, dtype=np.float64))
    along, up = abs(float(x)), abs(float(y))
    longer = max(along, up)
    if not math.isfinite(longer) or math.isnan(along + up):
        return math.nan
    share = min(along, up) / longer if longer > 0.0 else 0.0
    eighth = round(share * 8.0)
    angle = _EIGHTHS[eighth] + _small_atan(share, eighth / 8.0)
    angle = math.pi / 2.0 - angle if up > along else angle
    return math.copysign(math.pi - angle if x < 0.0 else angle, y)


def interpolated(at: Floats, along: Floats, values: Floats) -> Floats:
    """Return `values`, given at the places `along`, which do not fall, at the places `at`: lines between them."""
    if len(along) < 2:
        return np.full(len(at), values[0])
    after = np.clip(np.searchsorted(along, at, side="right"), 1, len(along) - 1)
    before = after - 1
    step = along[after] - along[before]
    share = np.clip((at - along[before]) / np.where(step > 0.0, step, 1.0), 0.0, 1.0)
    inner: Floats = values[before] + share * (values[after] - values[before])
    return np.where(share >= 1.0, values[after], inner)


def total(values: Floats | Iterable[float]) -> float:
    """Return the sum, rounded once; NaN where one is no number."""
    numbers = values.tolist() if isinstance(values, np.ndarray) else values
    try:
        return math.fsum(numbers)
    except (OverflowError, ValueError):  # infinities
        return math.nan


def mean(values: Floats | Sequence[float]) -> float:
    """Return the mean of at least one number."""
    return total(values) / len(values)


def products(first: Floats, second: Floats) -> float:
    """Return the sum of the products, pair by pair."""
    return total(first * second)


# ------------------------------------------------------------------------------------ points as complex numbers


def rect(distance: float, angle_rad: float) -> complex:
    """Return the point at a distance and in a direction from the origin."""
    along, up = cos_sin(angle_rad)
    return complex(distance * along, distance * up)


def phase(point: complex) -> float:
    """Return the direction of a point."""
    return atan2(point.imag, point.real)


def magnitude(points: complex) -> float:
    """Return the distance of a point from the origin."""
    return hypot(points.real, points.imag)


def magnitudes(points: Points) -> Floats:
    """Return the distance of each point from the origin."""
    return hypot(*coordinates(points))


def root_mean_square(points: Points) -> float:
    """Return the root of the mean square of the distances of at least one point from the origin."""
    x, y = coordinates(points)
    return math.sqrt(mean(x * x + y * y))


def turned(points: Points, factor: complex) -> Points:
    """Return each point times one factor; numpy's own product of complex arrays fuses operations."""
    return paired(
        points.real * factor.real - points.imag * factor.imag,
        points.real * factor.imag + points.imag * factor.real,
    )


def paired(x: Floats, y: Floats) -> Points:
    """Return points from their coordinates."""
    points = np.empty(np.broadcast(x, y).shape, dtype=np.complex128)
    points.real, points.imag = x, y
    return points


def coordinates(points: Points) -> tuple[Floats, Floats]:
    """Return the coordinates of points."""
    return np.asarray(points.real), np.asarray(points.imag)


def middle(points: Points) -> complex:
    """Return the mean of at least one point."""
    return complex(mean(points.real), mean(points.imag))


def correlation(first: Points, second: Points) -> complex:
    """Return the sum of the products of each conjugate of `first` with its partner of `second`."""
    (a, b), (c, d) = coordinates(first), coordinates(second)
    return complex(total(np.concatenate((a * c, b * d))), total(np.concatenate((a * d, -(b * c)))))


def axis(points: Points) -> float:
    """Return the direction, from -pi/2 to pi/2, of the line of least squares through points about the origin."""
    x, y = coordinates(points)
    return 0.5 * atan2(2.0 * products(x, y), total(np.concatenate((x * x, -(y * y)))))


def _rest(angle_rad: Value, quarters: Value) -> Value:
    """Return what is left of an angle without some quarter turns."""
    first, second, third = _QUARTER_RAD
    rest: Value = ((angle_rad - quarters * first) - quarters * second) - quarters * third
    return rest


def _near_zero(angle_rad: Value) -> tuple[Value, Value]:
    """Return cosine and sine of an angle of at most an eighth of a turn."""
    square: Value = angle_rad * angle_rad
    cos: Value = 1.0 + square * _polynomial(_COS, square)
    return cos, angle_rad + angle_rad * square * _polynomial(_SIN, square)


def _small_atan(share: Value, near: Value) -> Value:
    """Return the arc tangent of `share` less that of the eighth `near` it."""
    small: Value = (share - near) / (1.0 + share * near)
    square: Value = small * small
    return small + small * square * _polynomial(_ATAN, square)


def _polynomial(factors: Sequence[float], x: Value) -> Value:
    """Return a polynomial by Horner's rule."""
    value: Value = factors[0] + 0.0 * x
    for factor in factors[1:]:
        value = value * x + factor
    return value


def _directions(y: Floats, x: Floats) -> Floats:
    along, up = np.abs(x), np.abs(y)
    longer = np.maximum(along, up)
    share = np.minimum(along, up) / np.where(longer > 0.0, longer, 1.0)
    eighth = np.rint(share * 8.0)
    angle = _EIGHTHS_ARRAY[np.nan_to_num(eighth).astype(np.intp)] + _small_atan(share, eighth / 8.0)
    angle = np.where(up > along, math.pi / 2.0 - angle, angle)
    return np.copysign(np.where(x < 0.0, math.pi - angle, angle), y)
