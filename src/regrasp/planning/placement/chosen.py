"""A grasp chosen from a shape."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from hashlib import sha256
from math import inf
from typing import Any, Self

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, array, number
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.plain import entries, listed
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.value import ArrayValue
from regrasp.mesh.mesh import Mesh
from regrasp.outline.outline import Outline
from regrasp.planning.placement.laws import LARGEST, measured_in, without_rounding
from regrasp.planning.placement.proofs.patch_proof import PatchProof
from regrasp.planning.placement.proofs.placement_proof import PlacementProof
from regrasp.planning.placement.proofs.shape_data import shape_data, shape_of

_ROUNDING = 1e-12  # of the largest coordinate, which is printed as 0


@dataclass(frozen=True, eq=False, repr=False)
class OtherGrasp(ArrayValue):
    """A grasp that was passed over.

    Args:
        grasp: its contacts, relative to the centre of mass.
        places: (k,) arc lengths of its fingers, or (k, 3) their points in the mesh's coordinates [m].
        value: of its worst load, as the search computed it, in the unit of the objective.
    """

    grasp: Grasp
    places: Array
    value: float

    def __repr__(self) -> str:
        places = _words(self.places)
        return f"OtherGrasp(value {self.value:.6g}, at {places})"


@dataclass(frozen=True, eq=False, repr=False)
class ChosenGrasp(ArrayValue):
    """Where fingers go on a shape, what that reaches, and the proof that nothing better exists.

    Args:
        shape: the outline or mesh.
        objective: its word.
        grasp: the contacts, F1, F2, ... along the boundary, relative to the centre of mass.
        states: the best forces for every load asked: of a round set for a polygon around it; of ``answered``
            and ``wrench`` for the load, then under each deviation, of ``wrench`` what set-points turn into.
        value: of the worst load, in the unit of the objective.
        bound: no placement reaches less; of a margin or a factor, which are largest at best, more.
        places: (k,) arc lengths of the fingers, or (k, 3) their points in the mesh's coordinates [m].
        others: the best of the grasps tried that differ in a finger by a twentieth of the length, or of the
            root of the mesh's area, or more; on an outline also from all images by symmetries of it and of
            the loads.
        certificate: the proof of ``bound``; ``regrasp.verify`` checks it.
        max_force: limit on every force that was given [N]; None where none was.
        min_normal: with which every finger pushes at the least [N].
        length: by which torques are divided, of ``wrench_ball`` [m].
        deviations: (m, 3) of ``answered`` and ``wrench``, whose multiple by ``value`` is held on top of the
            load [N, N m].
    """

    shape: Outline | Mesh
    objective: str
    grasp: Grasp
    states: tuple[GraspState, ...]
    value: float
    bound: float
    places: Array
    others: tuple[OtherGrasp, ...]
    certificate: PlacementProof | PatchProof
    max_force: float | None = None
    min_normal: float = 0.0
    deviations: Array | None = None
    length: float | None = None

    @property
    def gap(self) -> float:
        """How much better than ``value`` the best placement can be at most, as a fraction of it [-].

        Of ``friction_use`` and ``angle`` as a fraction of at least 0.001; of others infinite where the
        value is 0 and the bound is not.
        """
        least = 1e-3 if self.objective in ("friction_use", "angle") else 0.0
        off, size = abs(self.value - self.bound), max(abs(self.value), least)
        return off / size if size else (inf if off else 0.0)

    def to_dict(self) -> dict[str, Any]:
        """The choice as plain data, which JSON can hold; ``from_dict`` gives back an equal one.

        With a digest of all of it: what is touched no longer fits.
        """
        data = {
            "shape": shape_data(self.shape),
            "objective": self.objective,
            "grasp": self.grasp.to_dict(),
            "states": [state.to_dict() for state in self.states],
            "value": self.value,
            "bound": self.bound,
            "places": self.places.tolist(),
            "others": [
                {"grasp": o.grasp.to_dict(), "places": o.places.tolist(), "value": o.value}
                for o in self.others
            ],
            "certificate": self.certificate.to_dict(),
            "max_force": self.max_force,
            "min_normal": self.min_normal,
            "deviations": None if self.deviations is None else self.deviations.tolist(),
            "length": self.length,
        }
        return {**data, "digest": _digest(data)}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Self:
        """The choice of plain data; whether it is one ``regrasp.verify`` says.

        Args:
            data: what ``to_dict`` returned, or JSON made of it.

        Raises:
            InvalidInput: For other keys, for entries that are not what they must be, and for a digest that
                does not fit; data of versions that wrote none have none.
        """
        keys = ("shape", "objective", "grasp", "states", "value", "bound", "places", "others", "certificate")
        given = entries(
            data, "a chosen grasp", keys, ("max_force", "min_normal", "deviations", "length", "digest")
        )
        limit, deviations = given.get("max_force"), given.get("deviations")
        grasp = Grasp.from_dict(given["grasp"])
        others = [
            entries(o, "others", ("grasp", "places", "value")) for o in listed(given["others"], "others")
        ]
        shape = shape_of(given["shape"])
        flat = isinstance(shape, Outline)
        if not isinstance(given["objective"], str):
            raise InvalidInput(f"objective must be a word, got {given['objective']!r}")
        found = cls(
            shape,
            given["objective"],
            grasp,
            tuple(GraspState.from_dict(state) for state in listed(given["states"], "states")),
            number(given["value"], "value"),
            number(given["bound"], "bound"),
            array(given["places"], "places", (len(grasp),) if flat else (len(grasp), 3)),
            tuple(
                OtherGrasp(
                    Grasp.from_dict(o["grasp"]),
                    array(o["places"], "places", (None,) if flat else (None, 3)),
                    number(o["value"], "value"),
                )
                for o in others
            ),
            (PlacementProof if flat else PatchProof).from_dict(given["certificate"]),
            None if limit is None else number(limit, "max_force", above=0),
            number(given.get("min_normal", 0.0), "min_normal", least=0),
            None if deviations is None else array(deviations, "deviations", (None, 3 if flat else 6)),
            None if given.get("length") is None else number(given["length"], "length", above=0),
        )
        if "digest" in given and given.pop("digest") != _digest(given):
            raise InvalidInput("the digest of a chosen grasp does not fit: something in it was changed")
        return found

    def __str__(self) -> str:
        arcs = [f"{s:14.6g}" for s in self.places] if self.places.ndim == 1 else [""] * len(self.places)
        width = 26 if arcs[0] else 36
        head = f"{'arc length':>14}" if arcs[0] else ""
        rows = [f"{'':10}{head}{'position':>{width}}{'inward normal':>{width - 4}}"]
        positions, centre = self.grasp.positions, self.shape.centre_of_mass
        size = np.abs(positions).max()
        positions, centre = (np.where(np.abs(at) < _ROUNDING * size, 0.0, at) for at in (positions, centre))
        for contact, s, position in zip(self.grasp, arcs, positions, strict=True):
            at = ", ".join(f"{v:.6g}" for v in position)
            normal = ", ".join(f"{v + 0.0:.4f}" for v in contact.normal)
            rows.append(f"{contact.name or '':10}{s}  {f'({at})':>{width - 2}}  {f'({normal})':>{width - 6}}")
        better = "above" if self.objective in LARGEST else "below"
        of = f" {words}" if (words := measured_in(self.objective)) else ""
        value, bound, gap = self._printed()
        last = f"{self.objective} {value:.6g}{of}; no placement is {better} {bound:.6g}, a gap of {gap:.2g}"
        own = ", ".join(f"{v:.6g}" for v in centre)
        about = f"positions are relative to the centre of mass, ({own}) in the shape's own coordinates"
        return "\n".join([*rows, about, last])

    def __repr__(self) -> str:
        value, bound, gap = self._printed()
        words = f"{self.objective} {value:.6g}, bound {bound:.6g}, gap {gap:.2g}"
        return f"ChosenGrasp({words}, fingers at {_words(self.places)})"

    def _printed(self) -> tuple[float, float, float]:
        """The value, the bound and the gap, 0 where only rounding is left."""
        value, bound = (without_rounding(self.objective, found) for found in (self.value, self.bound))
        return value, bound, 0.0 if value == bound else self.gap


def _digest(data: Mapping[str, Any]) -> str:
    """Of plain data as JSON has them, the proof's own in the place of the proof."""
    short = {**data, "certificate": data["certificate"]["digest"]}
    return sha256(json.dumps(short, sort_keys=True).encode()).hexdigest()


def _words(places: Array) -> str:
    if places.ndim == 1:
        return ", ".join(f"{s:.6g}" for s in places)
    return ", ".join("(" + ", ".join(f"{v:.6g}" for v in p) + ")" for p in places)
