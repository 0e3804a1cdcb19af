"""Three contacts in space, not on one line: the forces that balance a load, up to three squeezes.

    f_1 = f0_1 + x12 u12 - x31 u31
    f_2 = f0_2 + x23 u23 - x12 u12        u12 the unit vector from P_1 to P_2, and so on round the triangle
    f_3 = f0_3 + x31 u31 - x23 u23

Balance of moments about each side fixes the force of the third contact across the plane; balance within the
plane leaves the squeezes x12, x23, x31 free. With the load F and its moment M about the centroid of the
triangle, k the plane's unit normal, A the area, s_i the side opposite to P_i, d_i from the centroid to P_i,

    f0_i = -F/3 - k (M . s_i) / (2 A) - (k x d_i) (M . k) / (|d_1|^2 + |d_2|^2 + |d_3|^2)

is the particular solution with the least sum of squares within the plane.
"""

from math import sqrt

Vector = tuple[float, float, float]
Three = tuple[Vector, Vector, Vector]
Frame = tuple[Vector, Three, Three, Three, Vector, float, float, float]
"""(k, (u12, u23, u31), (s_1, s_2, s_3), (d_1, d_2, d_3), centroid, 1 / 2A, 1 / sum |d_i|^2, thinness)."""

COLLINEAR = 2.0**-30
"""A triangle with 2 A below this fraction of its longest side squared is a line."""
_EPS = 2.0**-52


def dot(a: Vector, b: Vector) -> float:
    """The scalar product a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """The vector product a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def plus(a: Vector, scale: float, b: Vector) -> Vector:
    """The sum a + scale b."""
    return a[0] + scale * b[0], a[1] + scale * b[1], a[2] + scale * b[2]


def scaled(scale: float, a: Vector) -> Vector:
    """The vector scale a."""
    return scale * a[0], scale * a[1], scale * a[2]


def triple_frame(r1: Vector, r2: Vector, r3: Vector) -> Frame:
    """The frame of three points.

    The last number says how thin the triangle is: 2 A over the longest side squared, less what rounding of
    the coordinates may have given it. At ``COLLINEAR`` or below (it may be negative) the points are on a
    line, and nothing else of the frame has a meaning.
    """
    s1, s2, s3 = plus(r3, -1.0, r2), plus(r1, -1.0, r3), plus(r2, -1.0, r1)
    q1, q2, q3 = dot(s1, s1), dot(s2, s2), dot(s3, s3)
    longest = max(q1, q2, q3)
    across = cross(s3, s1)  # equal for each two sides; the two shorter ones lose least
    if q3 == longest:
        across = cross(s1, s2)
    elif q1 == longest:
        across = cross(s2, s3)
    area2 = sqrt(dot(across, across))
    if longest == 0.0 or area2 == 0.0:
        return across, (s3, s1, s2), (s1, s2, s3), (s1, s2, s3), r1, 0.0, 0.0, -1.0
    far = abs(r1[0]) + abs(r1[1]) + abs(r1[2]) + abs(r2[0]) + abs(r2[1]) + abs(r2[2])
    thin = area2 / longest - 4.0 * _EPS * far / sqrt(longest)
    c = scaled(1.0 / 3.0, plus(plus(r1, 1.0, r2), 1.0, r3))
    d1 = scaled(1.0 / 3.0, plus(s2, -1.0, s3))
    d2 = scaled(1.0 / 3.0, plus(s3, -1.0, s1))
    d3 = scaled(1.0 / 3.0, plus(s1, -1.0, s2))
    u12, u23, u31 = scaled(1.0 / sqrt(q3), s3), scaled(1.0 / sqrt(q1), s1), scaled(1.0 / sqrt(q2), s2)
    inertia = dot(d1, d1) + dot(d2, d2) + dot(d3, d3)
    k = scaled(1.0 / area2, across)
    return k, (u12, u23, u31), (s1, s2, s3), (d1, d2, d3), c, 1.0 / area2, 1.0 / inertia, thin


def centroid_moment(frame: Frame, force: Vector, torque: Vector) -> Vector:
    """The moment of the load about the centroid of the triangle."""
    return plus(torque, -1.0, cross(frame[4], force))


def particular_forces(frame: Frame, force: Vector, moment: Vector) -> Three:
    """(f0_1, f0_2, f0_3) for the load F and its ``moment`` about the centroid."""
    k, _, sides, arms, _, per_area2, per_inertia, _ = frame
    turn = dot(moment, k) * per_inertia
    share = scaled(-1.0 / 3.0, force)
    f1 = plus(plus(share, -dot(moment, sides[0]) * per_area2, k), -turn, cross(k, arms[0]))
    f2 = plus(plus(share, -dot(moment, sides[1]) * per_area2, k), -turn, cross(k, arms[1]))
    f3 = plus(plus(share, -dot(moment, sides[2]) * per_area2, k), -turn, cross(k, arms[2]))
    return f1, f2, f3


def squeezed(frame: Frame, forces: Three, squeezes: Vector) -> Three:
    """The particular forces with the squeezes (x12, x23, x31) added."""
    x12, x23, x31 = squeezes
    u12, u23, u31 = frame[1]
    return (
        plus(plus(forces[0], x12, u12), -x31, u31),
        plus(plus(forces[1], x23, u23), -x12, u12),
        plus(plus(forces[2], x31, u31), -x23, u23),
    )


def along_squeezes(frame: Frame, i: int, a: Vector) -> Vector:
    """How a . f_i grows with x12, x23 and x31, for contact i = 0, 1, 2."""
    u12, u23, u31 = frame[1]
    if i == 0:
        return dot(a, u12), 0.0, -dot(a, u31)
    if i == 1:
        return -dot(a, u12), dot(a, u23), 0.0
    return 0.0, -dot(a, u23), dot(a, u31)


def rigid_motion(frame: Frame, a: Three) -> tuple[Vector, Vector]:
    """(v, omega) with sum a_i . f_i = -(v . F + omega . M) for all forces in balance.

    The a_i must be blind to the squeezes. They are then the velocities of the contacts in a motion of the
    rigid object with velocity v of the centroid and angular velocity omega.
    """
    k, _, sides, arms, _, per_area2, per_inertia, _ = frame
    v = scaled(1.0 / 3.0, plus(plus(a[0], 1.0, a[1]), 1.0, a[2]))
    turn = dot(a[0], cross(k, arms[0])) + dot(a[1], cross(k, arms[1])) + dot(a[2], cross(k, arms[2]))
    omega = scaled(turn * per_inertia, k)
    omega = plus(omega, dot(a[0], k) * per_area2, sides[0])
    omega = plus(omega, dot(a[1], k) * per_area2, sides[1])
    return v, plus(omega, dot(a[2], k) * per_area2, sides[2])
