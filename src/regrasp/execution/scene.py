"""The scene as MJCF: a body with a flat pad at every contact, a sphere on slides for every finger.

Pads are flat so that normals are those of the plan, exactly. The settings are those under which contacts do
not creep; each line of ``_OPTION`` and ``_CONTACT`` says why.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from regrasp.execution.units import SIZE, Units
from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact

_OPTION = " ".join(
    [
        'cone="elliptic"',  # circular cones, as in the plan: pyramids let 0.7 of the friction slip sideways
        'impratio="1000"',  # friction as much stiffer than normals: at 1 a thousand times the slip
        'integrator="implicitfast"',  # damping of the fingers inside the step
        'tolerance="1e-12" iterations="200"',  # the solver's own default stops at a residual that creeps
        'gravity="0 0 0"',  # the plan's load is applied as a wrench, whatever it is made of
    ]
)
_CONTACT = " ".join(
    [
        'condim="{dim}"',  # 3: a point contact, no torque about the normal; 4: a soft finger's limit surface
        'solref="{stiff:.12g} 1"',  # as stiff as two timesteps allow
        'solimp="0.99 0.999 0.0001"',  # what is left to softness is a thousandth
    ]
)
_PAD = 0.002 / 0.08  # half thickness, of the size
_WIDTH = 0.25  # half width of a pad, of the size
_TURN_INERTIA, _TURN_STIFFNESS = 1e-3, 40.0  # of tips that turn along


@dataclass(frozen=True)
class Scene:
    """A model, and the numbers of its parts: k tips, n pads, the object.

    slides: of the tips along the axes; joints: of their turns, None where they have none.
    """

    model: Any
    tips: tuple[int, ...]
    pads: tuple[int, ...]
    body: int
    slides: "Joints"
    joints: "Joints | None"


@dataclass(frozen=True)
class Joints:
    """Of k tips the numbers of coordinates (k, d), of turns 1 or 4, and of speeds (k, d), of turns 1 or 3."""

    places: NDArray[np.intp]
    speeds: NDArray[np.intp]


def mjcf(
    contacts: tuple[Contact, ...],
    frictions: Array,
    tips: Array,
    units: Units,
    inertia: Array,
    *,
    turning: bool,
) -> str:
    """The scene in units of the simulation; contacts in the plan's units.

    frictions: (n,) true coefficients. tips: (k, d) where the tips' centres start. inertia: (3, 3).
    turning: whether tips have a joint to turn along with the object.
    """
    d = tips.shape[1]
    dim = 4 if any(c.torsion for c in contacts) else 3
    spin = (
        (
            '<joint name="turn{i}" type="hinge" axis="0 0 1" armature="{a}" damping="{c}"/>'
            if d == 2
            else '<joint name="turn{i}" type="ball" armature="{a}" damping="{c}"/>'
        )
        if turning
        else ""
    )
    body_joints = (
        '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/><joint type="hinge"/>'
        if d == 2
        else "<freejoint/>"
    )
    thick, wide = _PAD * SIZE, _WIDTH * SIZE
    pads = "".join(
        f'<geom name="pad{i}" type="box" size="{wide} {wide} {thick}" '
        f'pos="{_text(_three(c.position / units.length) + thick * _three(c.normal))}" '
        f'zaxis="{_text(_three(c.normal))}" contype="{group(i)}" conaffinity="0" '
        f'friction="{mu:.17g} {_torsion(c, units):.17g} 0"/>'
        for i, (c, mu) in enumerate(zip(contacts, frictions, strict=True))
    )
    wheel = {"a": _TURN_INERTIA, "c": turn_gains()[1]}
    fingers = "".join(
        f'<body name="finger{i}">'
        + "".join(
            f'<joint name="{axis}{i}" type="slide" axis="{way}" damping="{units.damping:.12g}"/>'
            for axis, way in (("x", "1 0 0"), ("y", "0 1 0"), ("z", "0 0 1"))[:d]
        )
        + spin.format(i=i, **wheel)
        + f'<geom name="tip{i}" size="{units.tip_radius:.12g}" mass="{units.finger_mass:.12g}" contype="0" '
        f'conaffinity="{(1 << 31) - 1}" friction="0 0 0"/></body>'  # all pads, or they are never looked at
        for i in range(len(tips))
    )
    moments = _text(inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]])
    return (
        f'<mujoco><option timestep="{units.timestep:.17g}" {_OPTION}/>'
        f"<default><geom {_CONTACT.format(stiff=2 * units.timestep, dim=dim)}/></default><worldbody>"
        f'<body name="object">{body_joints}'
        f'<inertial pos="0 0 0" mass="{units.mass}" fullinertia="{moments}"/>'
        f"{pads}</body>{fingers}</worldbody></mujoco>"
    )


def _torsion(contact: Contact, units: Units) -> float:
    """Torque about the normal per normal force, which MuJoCo's elliptic cones weigh as limit surfaces do."""
    return 0.0 if contact.torsion is None else contact.torsion / units.length


def loaded(mujoco: Any, xml: str, fingers: int, contacts: int, dimension: int, *, turning: bool) -> Scene:
    """The compiled scene."""
    model = mujoco.MjModel.from_xml_string(xml)

    def joints(name: str, places: int, speeds: int) -> Joints:
        found = [model.joint(f"{name}{i}") for i in range(fingers)]
        first = np.array([[int(joint.qposadr[0]), int(joint.dofadr[0])] for joint in found])
        return Joints(first[:, :1] + np.arange(places), first[:, 1:] + np.arange(speeds))

    planar = dimension == 2
    return Scene(
        model,
        tuple(model.geom(f"tip{i}").id for i in range(fingers)),
        tuple(model.geom(f"pad{i}").id for i in range(contacts)),
        model.body("object").id,
        joints("x", dimension, dimension),
        joints("turn", 1 if planar else 4, 1 if planar else 3) if turning else None,
    )


def group(contact: int) -> int:
    """The collision bit of a contact's pad: a tip meets the pad of its own contact only."""
    return 1 << contact % 31


def turn_gains() -> tuple[float, float]:
    """Stiffness and critical damping with which tips turn along."""
    return _TURN_STIFFNESS, 2 * float(np.sqrt(_TURN_STIFFNESS * _TURN_INERTIA))


def _three(v: Array) -> Array:
    return np.append(v, 0.0) if v.size == 2 else v


def _text(v: Array) -> str:
    return " ".join(f"{x:.17g}" for x in v)
