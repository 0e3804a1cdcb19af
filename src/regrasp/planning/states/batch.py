"""Closed forms for millions of two-finger grasps at once."""

import sys
from collections.abc import Iterator
from math import inf, prod

import numpy as np

from regrasp.closed_form.choice import best_squeeze
from regrasp.closed_form.locus import squeeze_interval
from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, number, numbers_in
from regrasp.planning.states.criteria import PEAK_RATIO
from regrasp.planning.states.objectives import Objective, objective_of

_FEW, _FEW_ALONE = 8, 1_000
# The arguments of a batch in order, each with the size of its last axis (1: a number).
_SIZES = {
    "r1": 2, "n1": 2, "mu1": 1, "r2": 2, "n2": 2, "mu2": 1, "force": 2, "torque": 1, "limit1": 1, "limit2": 1,
}  # fmt: skip


def locus_intervals(
    r1: ArrayLike,
    n1: ArrayLike,
    mu1: ArrayLike,
    r2: ArrayLike,
    n2: ArrayLike,
    mu2: ArrayLike,
    force: ArrayLike,
    torque: ArrayLike = 0.0,
) -> tuple[Array, Array]:
    """Ends (lo, hi) of the squeeze interval of many pairs of planar contacts [N].

    Leading shapes broadcast; lo and hi have that shape. An empty locus is lo = inf, hi = -inf. The same
    function as ``EquilibriumLocus.interval``, where there are more than a few compiled by Numba (seconds on
    the first call, then kept) and run on all cores.

    Args:
        r1: (..., 2) positions of the first contacts, object frame [m].
        n1: (..., 2) normals into the object, of any length [-].
        mu1: (...) frictions [-].
        r2: (..., 2) positions of the second contacts [m].
        n2: (..., 2) their normals [-].
        mu2: (...) their frictions [-].
        force: (..., 2) of the load, object frame [N].
        torque: (...) of the load about the centre of mass [N m].

    Raises:
        InvalidInput: For wrong shapes, numbers that are not finite, zero normals, negative frictions and
            coincident contacts.
    """
    arrays, whole, shape = _prepared(r1, n1, mu1, r2, n2, mu2, force, torque)
    if _are_few(shape):
        _refuse_bad_values(arrays)
        each = [squeeze_interval(*pair) for pair in _one_by_one(arrays, shape)]
        ends = np.array(each).reshape(*shape, 2)
        return ends[..., 0].copy(), ends[..., 1].copy()
    from regrasp.closed_form.compiled import two_fingers as compiled

    lo, hi = np.empty(shape), np.empty(shape)
    if compiled.intervals(*_blocks(arrays, compiled.BLOCK), whole, lo.reshape(-1), hi.reshape(-1)):
        _refuse_bad_values(arrays)
    return lo, hi


def best_squeezes(
    r1: ArrayLike,
    n1: ArrayLike,
    mu1: ArrayLike,
    r2: ArrayLike,
    n2: ArrayLike,
    mu2: ArrayLike,
    force: ArrayLike,
    torque: ArrayLike = 0.0,
    *,
    objective: str | Objective = "angle",
    max_force: ArrayLike | tuple[ArrayLike, ArrayLike] | None = None,
    peak_ratio: float = PEAK_RATIO,
) -> Array:
    """The best squeeze of many pairs of planar contacts [N]; NaN where no state exists.

    Arguments as for ``locus_intervals``. ``max_force`` limits the forces: (...) for both, or a tuple of two
    (...), one for each contact; infinite for none. Without it the objectives ``angle`` and ``force`` limit
    them to ``peak_ratio`` times the least peak force of each pair. The full friction is used: pass
    ``mu * (1 - reserve)`` to keep a reserve.

    Args:
        r1: (..., 2) positions of the first contacts, object frame [m].
        n1: (..., 2) normals into the object, of any length [-].
        mu1: (...) frictions [-].
        r2: (..., 2) positions of the second contacts [m].
        n2: (..., 2) their normals [-].
        mu2: (...) their frictions [-].
        force: (..., 2) of the load, object frame [N].
        torque: (...) of the load about the centre of mass [N m].
        objective: a word, or an objective with a closed form.
        max_force: (...) limit on both forces, or a tuple of two (...), one for each contact; infinite for
            none [N].
        peak_ratio: limit on forces that could grow without end, as a multiple of the least peak force [-].
    """
    sought = objective_of(objective)
    if sought.closed_form is None:
        raise InvalidInput(f"objective {shown(sought.name)} has no closed form, so it has no batch")
    number(peak_ratio, "peak_ratio", least=1)
    limits: tuple[ArrayLike, ...] = max_force if isinstance(max_force, tuple) else (max_force, max_force)
    if len(limits) != 2:
        raise InvalidInput(f"max_force must be one limit or a tuple of two, got a tuple of {len(limits)}")
    limit1, limit2 = (inf if limit is None else limit for limit in limits)
    arrays, whole, shape = _prepared(r1, n1, mu1, r2, n2, mu2, force, torque, limit1, limit2)
    code, ratio = sought.closed_form, float(peak_ratio)
    if _are_few(shape):
        _refuse_bad_values(arrays)
        if sought.unbounded:
            _refuse_endless(sought.name, *arrays[6:])
        squeezes = (
            best_squeeze(*p[:13], code, *p[13:], ratio)[0]  # type: ignore[arg-type, call-arg]
            for p in _one_by_one(arrays, shape)
        )
        return np.array(list(squeezes)).reshape(shape)
    from regrasp.closed_form.compiled import two_fingers as compiled

    x = np.empty(shape)
    blocks = _blocks(arrays, compiled.BLOCK)
    if compiled.squeezes(*blocks, code, ratio, whole, x.reshape(-1)):
        _refuse_bad_values(arrays)
        if sought.unbounded:
            _refuse_endless(sought.name, *arrays[6:])
    return x


def _are_few(shape: tuple[int, ...]) -> bool:
    """Whether the formulas themselves are quicker than a call of the compiled ones, or than loading these."""
    return 0 < prod(shape) <= (_FEW if "numba" in sys.modules else _FEW_ALONE)


def _one_by_one(arrays: list[Array], shape: tuple[int, ...]) -> Iterator[tuple[float, ...]]:
    """The numbers of one pair after the other, as the closed forms take them."""
    count = prod(shape)
    columns = []
    for flat, size in zip(arrays, _SIZES.values(), strict=False):
        of_each = np.broadcast_to(flat.reshape(-1, size), (count, size)).T
        columns += of_each.tolist()
    return zip(*columns, strict=True)


def _prepared(*arguments: ArrayLike) -> tuple[list[Array], Array, tuple[int, ...]]:
    """Flat arrays of one value, or one for every grasp; which of them are whole; the common shape."""
    arrays, leading = [], []
    for (name, size), argument in zip(_SIZES.items(), arguments, strict=False):
        if isinstance(argument, np.ndarray) and argument.dtype == np.float64:
            value = argument  # millions of numbers are not copied
        else:
            try:
                value = numbers_in(argument, name)
            except InvalidInput:
                kind = type(argument).__name__
                raise InvalidInput(f"{name} must be an array of numbers, got {kind}") from None
        if size == 2 and (value.ndim == 0 or value.shape[-1] != 2):
            raise InvalidInput(f"{name} must have shape (..., 2), got {value.shape}")
        arrays.append(value)
        leading.append(value.shape[:-1] if size == 2 else value.shape)
    try:
        shape = np.broadcast_shapes(*leading)
    except ValueError:
        shapes = ", ".join(f"{n} {s}" for n, s in zip(_SIZES, leading, strict=False))
        raise InvalidInput(f"leading shapes must broadcast, got {shapes}") from None
    flat, whole = [], []
    for value, lead, size in zip(arrays, leading, _SIZES.values(), strict=False):
        single = int(np.prod(lead)) == 1 and shape != ()
        if not single:
            value = np.broadcast_to(value, (*shape, 2) if size == 2 else shape)
        flat.append(np.ascontiguousarray(value).reshape(-1))
        whole.append(0 if single else 1)
    return flat, np.array(whole), shape


def _refuse_bad_values(arrays: list[Array]) -> None:
    """Name what is wrong with the numbers; the compiled loops say only that something may be."""
    for (name, size), flat in zip(_SIZES.items(), arrays, strict=False):
        value = flat.reshape(-1, size)
        if name.startswith("limit"):
            if not (value > 0).all():
                raise InvalidInput("max_force must be greater than 0 everywhere")
            continue
        if not np.isfinite(value).all():
            raise InvalidInput(
                f"{name} must be finite, got {int((~np.isfinite(value)).sum())} entries that are not"
            )
        if name in ("n1", "n2") and not value.any(axis=-1).all():
            raise InvalidInput(f"{name} must not be zero; give the direction that points into the object")
        if name in ("mu1", "mu2") and (value < 0).any():
            raise InvalidInput(f"{name} must be at least 0 everywhere")
    if (arrays[0].reshape(-1, 2) == arrays[3].reshape(-1, 2)).all(axis=-1).any():
        raise InvalidInput("r1 and r2 coincide in at least one pair; place contacts at different points")


def _refuse_endless(objective: str, force: Array, torque: Array, limit1: Array, limit2: Array) -> None:
    idle = ~force.reshape(-1, 2).any(axis=-1) & (torque == 0)
    if (idle & (np.isinf(limit1) | np.isinf(limit2))).any():
        raise InvalidInput(f"objective {shown(objective)} under a zero load needs max_force")


def _blocks(arrays: list[Array], size: int) -> list[Array]:
    """One value becomes a block of equal values, which serves every block of grasps.

    All read-only, whether ours or a view of the caller's: Numba compiles anew for every mix of both.
    """
    blocks = [np.tile(v, size) if v.size == w else v for v, w in zip(arrays, _SIZES.values(), strict=False)]
    for block in blocks:
        block.setflags(write=False)
    return blocks
