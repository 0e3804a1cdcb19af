"""Contacts a little off along the surface: they move on a circle of its curvature, and their normals turn."""

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp


def moved(grasp: Grasp, offsets: Array, curvatures: Array) -> Grasp:
    """The grasp with contacts off by ``offsets`` (n, d - 1) along their tangents [m].

    curvatures: (n,) of the surface [1/m], positive where it bulges out; 0 where it is flat. With the center
    of curvature at r + n / kappa, s the offset: r' = r + sin(kappa s) / kappa t + (1 - cos(kappa s)) / kappa
    n and n' = cos(kappa s) n - sin(kappa s) t.
    """
    tangents = grasp.tangents.reshape(len(grasp), -1, grasp.dimension)
    contacts: list[Contact] = []
    for contact, tangent, offset, curvature in zip(
        grasp, tangents, offsets, curvatures.tolist(), strict=True
    ):
        s = float(np.sqrt(offset @ offset))
        if s == 0:
            contacts.append(contact)
            continue
        t, n, turn = offset @ tangent / s, contact.normal, curvature * s
        if abs(turn) < 1e-8:  # to the last digit
            along, inwards = s, turn * s / 2
        else:
            along, inwards = np.sin(turn) / curvature, 2 * np.sin(turn / 2) ** 2 / curvature
        contacts.append(
            Contact(
                contact.position + along * t + inwards * n,
                np.cos(turn) * n - np.sin(turn) * t,
                contact.friction,
                max_force=contact.max_force,
                torsion=contact.torsion,
                limits=contact.limits,
                name=contact.name,
            )
        )
    return Grasp(contacts)
