"""Which part of a grid of triangles others cover, by hand."""

import numpy as np
import pytest

from regrasp.verification.placed.meshes.areas import share_of

pytestmark = pytest.mark.oracle

UP = np.array([0, 0, 1.0])
MOVED = np.array([3.0, 10, -40])


def grid() -> tuple[np.ndarray, np.ndarray]:
    """Four squares of area 1 about (1, 1, 0), each two triangles with their inward normal up."""
    points = np.array([[x, y, 0.0] for y in range(3) for x in range(3)])
    faces = []
    for y in range(2):
        for x in range(2):
            a = x + 3 * y
            faces += [[a, a + 3, a + 1], [a + 1, a + 3, a + 4]]
    return points, np.array(faces)


def share(*triangles, normal=UP, scale=1.0, move=MOVED) -> float:
    points, faces = grid()
    corners = scale * (np.array(triangles, dtype=float) + move)
    return share_of(
        corners, np.repeat(np.array([normal]), len(triangles), axis=0), scale * (points + move), faces
    )


MIDDLE = [[0.25, 0.25, 0], [1.75, 0.25, 0], [1, 1.75, 0]]  # of area 1.125, over all squares
REACH = 40.0


@pytest.mark.parametrize("scale", [1.0, 1e-6, 1e4])
@pytest.mark.parametrize("move", [MOVED, -MOVED, np.array([-2.0, 0, 40]), np.array([40.0, 0, -2])])
def test_a_triangle_over_all_squares(scale, move) -> None:
    for order in [0, 1, 2], [2, 1, 0], [1, 0, 2]:
        turned = np.array(MIDDLE)[order]
        assert share(turned, scale=scale, move=move) == pytest.approx(1.125 / 4, rel=1e-9)
    whole = grid()[0][grid()[1]]
    assert share(*whole, scale=scale, move=move) == pytest.approx(1, rel=1e-9)
    assert share(whole[0], whole[5], scale=scale, move=move) == pytest.approx(0.25, rel=1e-9)
    assert share(MIDDLE, [[0, 0, 0], [0.2, 0, 0], [0, 0.2, 0]], scale=scale, move=move) == pytest.approx(
        1.145 / 4, rel=1e-9
    )
    assert share(whole[0], whole[0], scale=scale, move=move) == -1
    assert share(whole[0], whole[0] * [0.5, 0.5, 1], scale=scale, move=move) == -1
    assert share(MIDDLE, MIDDLE, scale=scale, move=move) == -1
    for k in range(3):  # a corner moved out, over the end of the grid
        out = np.array([[0, 0, 0], [2, 0, 0], [0, 2.0, 0]])
        assert share(out, scale=scale, move=move) == pytest.approx(0.5, rel=1e-9)
        out[k] += 0.05 * (out[k] - [0.6, 0.6, 0])
        assert share(out, scale=scale, move=move) == -1
    larger = whole[0] + 0.01 * (whole[0] - whole[0].mean(axis=0))
    assert share(larger, scale=scale, move=move) == -1  # nearly a triangle of the grid


@pytest.mark.parametrize("scale", [1.0, 1e-4, 1e4])
def test_triangles_are_in_the_plane_to_a_part_of_the_reach(scale) -> None:
    for sign in 1, -1:
        for off, good in (0.9e-9 * REACH, True), (1.1e-9 * REACH, False), (0.5, False), (5.0, False):
            lifted = np.array(MIDDLE) + sign * off * UP
            assert (share(lifted, scale=scale) > 0) == good, (sign, off)
        for off, good in (1.4e-9 * REACH, True), (1.6e-9 * REACH, False):  # 2/3 of it from the middle
            bent = np.array(MIDDLE)
            bent[1, 2] += sign * off
            assert (share(bent, scale=scale) > 0) == good, (sign, off)
    for turn, good in (0.9e-9, True), (1.1e-9, False), (2.0, False):
        normal = [turn, 0, 1] if turn < 1 else [0, 0, -1]
        assert (share(MIDDLE, normal=normal, scale=scale) > 0) == good


def test_a_face_itself_seen_from_the_other_side_is_none() -> None:
    whole = grid()[0][grid()[1]]
    assert share(*whole, normal=[0, 0, 1]) == pytest.approx(1, rel=1e-9)
    for k in range(len(whole)):
        assert share(whole[k], normal=[0, 0, -1]) == -1


def test_oblique_planes() -> None:
    """All of it turned, so that boxes around triangles of planes one above the other share places."""
    turn = np.array([[0.6, -0.8, 0], [0.48, 0.36, -0.8], [0.64, 0.48, 0.6]])
    points, faces = grid()
    for lift, good in (0.0, True), (0.3, False), (-0.3, False):
        corners = np.add([MIDDLE], (0, 0, lift)) @ turn.T
        found = share_of(corners, (turn @ UP)[None], points @ turn.T, faces)
        assert found == pytest.approx(1.125 / 4 if good else -1, rel=1e-9)


def test_triangles_beside_one_another() -> None:
    beside = [[0.3, 1.5, 0], [0.4, 1.5, 0], [0.3, 1.7, 0]]
    assert share(MIDDLE, beside) == pytest.approx((1.125 + 0.01) / 4, rel=1e-9)
    over = [[0.9, 1.5, 0], [1.0, 1.5, 0], [0.9, 1.7, 0]]
    assert share(MIDDLE, over) == share(over, MIDDLE) == -1


def test_of_many_triangles_on_many_planes_none_is_missed() -> None:
    """A strip of 12 planes of 3 by 3 squares, and triangles over half of a plane."""
    turn = np.array([[0.6, -0.8, 0], [0.48, 0.36, -0.8], [0.64, 0.48, 0.6]])
    angles = np.repeat(0.3 * np.sin(2.0 * np.arange(12)), 3)
    across = np.vstack([np.zeros(2), np.cumsum(np.stack([np.cos(angles), np.sin(angles)], axis=1), axis=0)])
    points = np.array([[x, y, z] for x, z in across for y in range(4)]) @ turn.T
    faces = np.array(
        [
            half
            for a in (4 * x + y for x in range(36) for y in range(3))
            for half in ([a, a + 1, a + 4], [a + 1, a + 5, a + 4])
        ]
    )
    planes = np.stack([-np.sin(angles), 0 * angles, np.cos(angles)], axis=1) @ turn.T
    normals, corners = np.repeat(planes, 6, axis=0), points[faces]

    def on(which: list[int], more=corners[:0], facing=normals[:0]) -> float:
        return share_of(
            np.concatenate([corners[which], more]), np.concatenate([normals[which], facing]), points, faces
        )

    every = list(range(216))
    shuffled = np.random.default_rng(0).permutation(216).tolist()
    assert on(every) == pytest.approx(1, rel=1e-9)
    assert on(shuffled) == pytest.approx(1, rel=1e-9)
    assert on(shuffled[:54]) == pytest.approx(0.25, rel=1e-9)
    for k in 0, 215:
        assert on([*every, k]) == -1
        lifted = corners[[k]] + 1e-3 * normals[k]
        assert on([j for j in every if j != k], lifted, normals[[k]]) == -1
        assert on([j for j in every if j != k], corners[[k]], normals[[(k + 18) % 216]]) == -1
    for plane in 0, 7:
        large = points[[12 * plane, 12 * plane + 3, 12 * plane + 12]][None]
        rest = [j for j in shuffled if j // 18 != plane]
        facing = normals[[18 * plane]]
        assert on(rest, large, facing) == pytest.approx(1 - 0.5 / 12, rel=1e-9)
        assert on([*rest, 18 * plane], large, facing) == -1
        assert on([*rest, 18 * plane + 17], large, facing) == pytest.approx(1 - (9 - 1) / 18 / 12, rel=1e-9)


@pytest.mark.parametrize("size", [3e-4, 1e-5])
def test_a_face_left_out_is_missed_however_small(size) -> None:
    """Of a pyramid without its tip; what triangles are over one another makes nothing up for it."""
    low, high = np.array([[0.0, 0, 0], [3, 0, 0], [0, 3, 0]]), np.array([1.0, 1, 2])
    vertices = np.concatenate([low, high + size * (low - high)])
    faces = [[0, 2, 1], [3, 4, 5]]
    faces += [half for i, j in ((0, 1), (1, 2), (2, 0)) for half in ([i, j, j + 3], [i, j + 3, i + 3])]
    corners = vertices[faces]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = -across / np.linalg.norm(across, axis=1)[:, None]
    assert share_of(corners, inward, vertices, faces) == pytest.approx(1, rel=1e-14)
    rest = [0, *range(2, 8)]
    a, b, c = np.moveaxis(corners[rest], 1, 0)
    for over in 0.0, 4e-7:
        halves = [(a, a + (0.5 + over / 2) * (b - a), c), (a + (0.5 - over / 2) * (b - a), b, c)]
        parts = np.concatenate([np.stack(half, axis=1) for half in halves])
        for left, facing in (corners[rest], inward[rest]), (parts, np.tile(inward[rest], (2, 1))):
            found = share_of(left, facing, vertices, faces)
            assert 1 - 1e-6 < found < 1 - 1.9e-9
        normals = np.concatenate([np.tile(inward[rest], (2, 1)), inward[[1]]])
        whole = share_of(np.concatenate([parts, corners[[1]]]), normals, vertices, faces)
        assert whole == pytest.approx(1, rel=1e-12 + 2 * over)
