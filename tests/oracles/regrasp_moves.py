"""How fingers move in the set-points of a regrasp."""

import numpy as np


def check_moves(points: np.ndarray, forces: np.ndarray, step: np.ndarray, moves: int) -> np.ndarray:
    """One finger at a time, between steps and without force; returns which rows are the last of a step.

    points, forces: (N, fingers, d). step: (N,). moves: how many there are.
    """
    moved = (np.diff(points, axis=0) != 0).any(axis=-1)
    joints = np.diff(step) == 1
    assert not moved[~joints].any()
    assert (moved.sum(axis=1) <= 1).all()
    assert moved.sum() == moves
    for row, finger in np.argwhere(moved):
        assert not forces[row, finger].any()
        assert not forces[row + 1, finger].any()
    return joints
