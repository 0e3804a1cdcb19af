"""Regions on the sides of a rectangle, made by hand: arcs, places and corners at their limits."""

from itertools import product
from math import inf, nan
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from regrasp.verification.exact import RESOLUTION
from regrasp.verification.placed.regions import verify_regions

pytestmark = pytest.mark.oracle

CORNERS = np.array([[-2.0, -1], [2, -1], [2, 1], [-2, 1]])
"""Around from the lower left, 12 long: the lower side from 0 to 4, the right one to 6, the upper to 10."""
SLACK = 12 * float(RESOLUTION)
SHAPE = SimpleNamespace(cubics=lambda: None, polygon=lambda: CORNERS)


def squeeze(one, other, off=0.0, *, normals=((0, 1), (0, -1)), friction=3.0) -> rg.GraspState:
    """Both push along the line between them, the first a part ``off`` more."""
    contacts = [rg.Contact(p, n, friction) for p, n in zip((one, other), normals, strict=True)]
    f = np.subtract(other, one)
    return rg.GraspState(rg.Grasp(contacts), rg.Wrench([0, 0]), [(1 + off) * f, -f])


def low(s):
    return [s - 2, -1]


def high(s):
    return [8 - s, 1]


def made(arcs=((1, 3), (7, 9)), places=(2, 8), turn=(0, 0), grasp=None, **changes):
    """Fingers on the lower and the upper side; ``turn``: so often around the outline besides."""
    (a, b), (c, d) = arcs
    given = {
        "shape": SHAPE,
        "grasp": squeeze(low(places[0]), high(places[1])).grasp if grasp is None else grasp,
        "places": np.add(places, 12.0 * np.array(turn)),
        "arcs": np.add(arcs, 12.0 * np.array(turn)[:, None]),
        "spans": None,
        "widest": None,
        "cells": None,
        "half_width": 0.0,
        "max_force": 99.0,
        "corners": tuple(squeeze(low(s), high(t)) for s, t in product((a, b), (c, d))),
    }
    return SimpleNamespace(**given | changes)


def said(regions) -> str:
    return "; ".join(verify_regions(regions).violations)


@pytest.mark.parametrize("turn", [(0, 0), (1, 0), (0, -1), (-2, 3)])
def test_arcs_are_on_one_side(turn) -> None:
    assert said(made(turn=turn)) == ""
    assert said(made(arcs=((2, 2), (8, 8)), turn=turn)) == ""
    for k, end, (part, good) in product((0, 1), (0, 1), ((0.0, True), (0.9, True), (1.1, False))):
        arcs = np.array([[1.0, 3], [7, 9]])
        arcs[k, end] = ((0, 4), (6, 10))[k][end] + (-1, 1)[end] * part * SLACK
        found = said(made(arcs=arcs, turn=turn))
        assert (found == "") == good, (k, end, part)
        assert good or found == f"arc {k + 1} is not on one straight side"
    for far in ((-1, 3), (1, 5)):
        assert said(made(arcs=(far, (7, 9)), turn=turn)) == "arc 1 is not on one straight side"
    assert said(made(arcs=((3, 1), (7, 9)), turn=turn)) == "arc 1 must not end before it begins"
    for end, wrong in (1, nan), (1, inf), (0, -inf), (0, nan):
        regions = made(turn=turn)
        regions.arcs[0, end] = wrong
        assert said(regions) == "arc 1 must not end before it begins"


def test_the_outline_ends_where_it_begins() -> None:
    """-1e-17 of a turn of 12 is 12 in doubles: the end of the last side, not the beginning of one more."""
    sides = ((1, 0), (-1, 0))
    state = squeeze([-2, -1], [2, -1], normals=sides)
    for s in (-1e-17, 11.999999999999998):
        regions = made(((s, s), (4, 4)), (s, 4), grasp=state.grasp, corners=(state,))
        assert said(regions) == "", s
    state = squeeze([-2, -1], [2, 0.5], normals=sides)
    for s in (0.0, 12.0):  # where the first side begins, its normal counts
        regions = made(((s, s), (5.5, 5.5)), (s, 5.5), grasp=state.grasp, corners=(state,))
        assert said(regions) == "contact 1 is not at its place"


def test_contacts_are_at_their_places() -> None:
    for k, axis, sign in product((0, 1), (0, 1), (-1, 1)):
        for part, good in (0.8, True), (1.2, False):
            at = [low(2.0), high(8.0)]
            at[k][axis] += sign * part * SLACK
            found = said(made(grasp=squeeze(*at).grasp))
            assert found == ("" if good else f"contact {k + 1} is not at its place")
    for k, sign in product((0, 1), (-1, 1)):
        for part, good in (0.9, True), (1.1, False):
            normals = [[0, 1.0], [0, -1.0]]
            normals[k][0] = sign * part * 4 * float(RESOLUTION)
            found = said(made(grasp=squeeze(low(2), high(8), normals=normals).grasp))
            assert found == ("" if good else f"contact {k + 1} is not at its place")
    for places in ((2.5, 8), (2, 8.5)):
        found = said(made(places=places, grasp=squeeze(low(2), high(8)).grasp))
        assert "is not at its place" in found


def test_half_widths_reach_to_the_ends_of_sides() -> None:
    for k, end in product((0, 1), (0, 1)):
        for part, good in (0.8, True), (1.2, False):
            arcs = np.array([[1.0, 3], [7, 9]])
            arcs[k, end] += (1, -1)[end] * part * SLACK
            found = said(made(arcs=arcs, half_width=1.0))
            assert found == ("" if good else f"arc {k + 1} is less than the half width 1 about its place")
        for part, good in (1.9995e-6, True), (2.0005e-6, False):  # a place 0.5 from the end of a side
            arcs, places, away = np.array([[1.0, 3], [7, 9]]), np.array([2.0, 8.0]), (-1, 1)[end]
            side = ((0, 4), (6, 10))[k][end]
            places[k] = side - away * 0.5
            arcs[k] = sorted((side - away * 0.5 * part, side - away * 1.6))
            found = said(made(arcs=arcs, places=places, half_width=1.0))
            assert (found == "") == good, (k, end, part)
    for half in (-1e-300, inf, nan):
        assert "is less than the half width" in said(made(((0, 4), (6, 10)), half_width=half))
    assert said(made(((0, 4), (6, 10)), half_width=1e300)) == ""


def test_what_regions_need() -> None:
    for name, value in ("arcs", np.zeros((1, 2))), ("arcs", np.zeros((2, 3))), ("places", np.zeros(1)):
        regions = made()
        setattr(regions, name, value)
        assert said(regions) == "an arc and a place for each finger are needed"
    assert said(made(corners=())) == "no corner has a state"
    for k in range(4):
        corners = [state for number, state in enumerate(made().corners) if number != k]
        assert said(made(corners=tuple(corners))) == "1 states of corners are missing"
    three = rg.Grasp([*corners[0].grasp, rg.Contact([2, 0], [-1, 0], 3.0)])
    other = rg.GraspState(three, rg.Wrench([0, 0]), [*corners[0].forces, [0, 0]])
    assert said(made(corners=(*corners, other))) == "1 states of corners are missing"
    assert said(made(corners=made().corners[:1])) == "3 states of corners are missing"


def test_no_force_is_above_the_limit() -> None:
    state = squeeze(low(2), high(8))
    still = rg.GraspState(state.grasp, rg.Wrench([0, 0]), np.zeros((2, 2)))
    light = rg.GraspState(state.grasp, rg.Wrench([0, 0]), state.forces / 8)  # 2 / 8
    more = squeeze(low(2), high(8), 0.25)
    for corner, limit, above in (
        (still, 0.0, False), (still, -5e-324, True), (light, 0.25, False),
        (light, np.nextafter(0.25, 0), True), (more, 2.5, False), (more, 2.25, True),
    ):  # fmt: skip
        found = said(made(((2, 2), (8, 8)), corners=(corner,), max_force=limit))
        assert ("corner state 1: a force of" in found) == above, limit
        assert ("is above" in found) == above


def test_margins_are_those_of_the_worst_corner() -> None:
    good = made()
    verdict = verify_regions(good)
    assert verdict.least_angle == pytest.approx(np.arctan(3) - np.arctan(1), rel=1e-12)
    assert verdict.least_cone_slack == pytest.approx(9 - 1, rel=1e-12)
    for k in range(4):
        s, t = ((1, 7), (1, 9), (3, 7), (3, 9))[k]
        corners = list(good.corners)
        corners[k] = squeeze(low(s), high(t), 1e-14)
        verdict = verify_regions(made(corners=tuple(corners)))
        assert verdict.ok
        assert 1e-16 < verdict.worst_residual < 1e-13
