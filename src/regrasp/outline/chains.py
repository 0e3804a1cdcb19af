"""Pieces of a drawing joined end to end."""

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array


def joined(pieces: list[Array], tolerance: float) -> list[Array]:
    """The closed rings that pieces (k, 2), drawn in any order and direction, make together.

    Ends within ``tolerance`` are joined, the nearest first. Raises ``InvalidInput`` where a chain stays open.
    """
    ends = np.array([(piece[0], piece[-1]) for piece in pieces])  # (m, 2, 2)
    used = np.zeros(len(pieces), dtype=bool)
    rings = []
    while not used.all():
        first = int(np.argmin(used))
        used[first] = True
        chain = [pieces[first]]
        while True:
            tail, head = chain[-1][-1], chain[0][0]
            gap = float(np.hypot(*(tail - head)))
            away = np.where(used[:, None], np.inf, np.hypot(*(ends - tail).transpose(2, 0, 1)))
            piece, backwards = divmod(int(np.argmin(away)), 2)
            nearest = float(away[piece, backwards])
            is_closed = gap <= tolerance and sum(map(len, chain)) > 2
            if is_closed and gap <= nearest:
                break
            if nearest > tolerance:
                raise InvalidInput(
                    f"the outline is open: it ends at ({tail[0]:.6g}, {tail[1]:.6g}), {gap:.3g} from its "
                    f"start ({head[0]:.6g}, {head[1]:.6g}); ends within {tolerance:.3g} would be joined"
                )
            used[piece] = True
            chain.append(pieces[piece][::-1] if backwards else pieces[piece])
        rings.append(np.concatenate([piece[:-1] for piece in chain]))
    return rings
