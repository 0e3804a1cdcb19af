"""Whether three fingers in space hold a load, with which forces, and with what angle to spare."""

from math import cos, inf, nan, pi

from regrasp.closed_form.dual_simplex import NONE, UNDECIDED, Answer
from regrasp.closed_form.pyramid import facet_angles, write_facets, write_load
from regrasp.closed_form.triple import (
    COLLINEAR,
    Frame,
    Three,
    Vector,
    centroid_moment,
    particular_forces,
    scaled,
    squeezed,
    triple_frame,
)
from regrasp.closed_form.triple_extremes import least_peak, widest
from regrasp.closed_form.triple_program import (
    FACETS,
    Fingers,
    Workspace,
    attained,
    is_state,
    largest,
    solve,
    workspace,
    write_limits,
    write_triple,
)

HOLDS, NO_STATE, LINE, OPEN = 0, 1, 2, 3
"""A state; none, proven by four rows; points on a line; left open by rounding, which is no hold either."""

Hold = tuple[int, float, Three]
"""(verdict, tangent of the margin, forces); margin and forces are NaN without a state."""

_NO_FORCES = ((nan, nan, nan), (nan, nan, nan), (nan, nan, nan))


def three_finger_hold(
    fingers: Fingers,
    force: Vector,
    torque: Vector,
    facets: int = 8,
    peak_ratio: float = 3.0,
    with_margin: bool = True,
) -> Hold:
    """The verdict on three fingers under a load, the tangent of the margin, and the forces (f_1, f_2, f_3).

    facets: of the inner pyramids, even, at least 4.

    The margin is the widest angle by which all pyramids can be narrowed while every force stays below its
    limit; where a contact has none, below ``peak_ratio`` times the least peak of f_i.n_i / cos(atan mu_i).
    The exact margin of the forces is at least as wide. Without it, the forces are those of the least sum of
    normal forces, and the margin is theirs.
    """
    frame = triple_frame(*fingers.points)
    if frame[7] <= COLLINEAR:
        return LINE, nan, _NO_FORCES
    work = workspace(facets)
    write_triple(work, frame, fingers.normals, facet_angles(facets))
    moment = centroid_moment(frame, force, torque)
    return judged(work, frame, fingers, force, torque, moment, cos(pi / facets), peak_ratio, with_margin)[0]


def judged(
    work: Workspace,
    frame: Frame,
    fingers: Fingers,
    force: Vector,
    torque: Vector,
    moment: Vector,
    cos_half: float,
    peak_ratio: float,
    with_margin: bool,
) -> tuple[Hold, Answer]:
    """The hold of a triple that has been written into ``work``, and the program's last answer."""
    normals, mu, limits = fingers.normals, fingers.usable_mu, fingers.usable_limits
    start = particular_forces(frame, force, moment)
    size = largest(start)
    if size == 0.0:
        size = 1.0
    start = scaled(1.0 / size, start[0]), scaled(1.0 / size, start[1]), scaled(1.0 / size, start[2])
    own = limits[0] / size, limits[1] / size, limits[2] / size
    write_load(normals, work.tangents, start, work.ahead, work.sideways)
    write_limits(work, mu, own)
    write_facets(work.ahead, work.sideways, mu, 0.0, cos_half, FACETS, work.rows)
    answer = solve(work, work.basis)
    if answer[0] == NONE:
        return (NO_STATE, nan, _NO_FORCES), answer
    if answer[0] == UNDECIDED:
        return (OPEN, nan, _NO_FORCES), answer
    forces = _forces(frame, start, size, answer)
    sound = is_state(fingers, force, torque, forces)
    if sound and not with_margin:
        return (HOLDS, max(attained(normals, fingers.mu, forces), 0.0), forces), answer
    for c in range(3):
        work.narrow[c] = work.basis[c]
    p = inf
    if max(limits[0], limits[1], limits[2]) == inf:
        p, answer = least_peak(work, mu, own, answer)
        p *= peak_ratio
        write_limits(work, mu, (min(own[0], p), min(own[1], p), min(own[2], p)))
    if p == p:
        # A force that is small beside the others meets the edge of its cone with their rounding. Away from
        # the edge it need not.
        narrowed, answer = widest(work, mu, cos_half, answer)
        better = _forces(frame, start, size, answer)
        if is_state(fingers, force, torque, better):
            return (HOLDS, min(narrowed, max(attained(normals, fingers.mu, better), 0.0)), better), answer
    if sound:
        return (HOLDS, 0.0, forces), answer
    return (OPEN, nan, _NO_FORCES), answer


def _forces(frame: Frame, start: Three, size: float, answer: Answer) -> Three:
    f1, f2, f3 = squeezed(frame, start, answer[3])
    return scaled(size, f1), scaled(size, f2), scaled(size, f3)
