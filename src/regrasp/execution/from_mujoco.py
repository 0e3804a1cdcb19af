"""A grasp read from a running MuJoCo simulation: contacts, load and measured forces of one body."""

from typing import Any

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.execution.engine import engine
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench


def grasp_from_mujoco(model: Any, data: Any, body: str | int) -> GraspState:
    """Contacts of a body, its load and the forces measured, in the body's frame at its centre of mass.

    Everything that touches the body is a finger, named by its geom. Contacts of condim 4 and 6 are soft
    fingers, whose torsion is MuJoCo's torsional friction [m]; of condim 1 frictionless; where a contact has
    two sliding coefficients the smaller counts. The load is the weight and what ``xfrc_applied`` adds. The
    state is what was measured: in equilibrium if the body is at rest, as far as the solver brought it;
    ``state.balanced()`` is the nearest that is.
    model, data: an ``MjModel`` and its ``MjData`` after ``mj_step`` or ``mj_forward``. body: name or number.
    Raises ``InvalidInput`` for a body that is not there or that nothing touches.
    """
    mujoco = engine("grasp_from_mujoco")
    number = _number(mujoco, model, body)
    R, centre = data.xmat[number].reshape(3, 3), data.xipos[number]
    soft = any(data.contact[k].dim >= 4 for k in _touching(model, data, number))
    contacts, forces, six = list[Contact](), list[list[float]](), np.zeros(6)
    names: dict[str, int] = {}
    for k in _touching(model, data, number):
        contact = data.contact[k]
        mujoco.mj_contactForce(model, data, k, six)
        normal, force = contact.frame[:3], contact.frame.reshape(3, 3).T @ six[:3]  # on the second geom
        second = int(model.geom_bodyid[contact.geom[1]]) == number
        if not second:
            normal, force = -normal, -force
        other = int(contact.geom[0 if second else 1])
        slides = contact.friction[:2].min() if contact.dim >= 3 else 0.0
        torsion = float(contact.friction[2]) if contact.dim >= 4 and contact.friction[2] > 0 else None
        contacts.append(
            Contact(
                R.T @ (contact.pos - centre),
                R.T @ normal,
                float(slides),
                torsion=torsion,
                name=_named(mujoco, model, other, names),
            )
        )
        # The torque about the normal has one sign on both bodies: axis and torque turn over together.
        forces.append([*(R.T @ force).tolist(), *([six[3] if torsion else 0.0] if soft else [])])
    if not contacts:
        raise InvalidInput(f"nothing touches body {shown(body)} at this instant")
    weight = model.body_mass[number] * model.opt.gravity
    applied = data.xfrc_applied[number]
    load = Wrench(R.T @ (weight + applied[:3]), R.T @ applied[3:])
    return GraspState(Grasp(contacts), load, forces)


def _number(mujoco: Any, model: Any, body: str | int) -> int:
    if isinstance(body, str):
        found = int(mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, body))
        if found < 0:
            names = [model.body(i).name for i in range(1, model.nbody) if model.body(i).name]
            raise InvalidInput(f"no body {shown(body)} in this model; it has {', '.join(names)}")
        return found
    if isinstance(body, bool) or not isinstance(body, (int, np.integer)) or not 0 < body < model.nbody:
        raise InvalidInput(f"body must be a name or a number from 1 to {model.nbody - 1}, got {shown(body)}")
    return int(body)


def _touching(model: Any, data: Any, body: int) -> list[int]:
    """Numbers of the contacts between a body and others that carry force."""
    found = []
    for k in range(data.ncon):
        pair = [int(model.geom_bodyid[geom]) for geom in data.contact[k].geom]
        if (pair[0] == body) != (pair[1] == body) and data.contact[k].efc_address >= 0:
            found.append(k)
    return found


def _named(mujoco: Any, model: Any, geom: int, names: dict[str, int]) -> str:
    """The geom's name; with a number where it touches again."""
    name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_GEOM, geom) or f"geom {geom}"
    names[name] = names.get(name, 0) + 1
    return str(name) if names[name] == 1 else f"{name} {names[name]}"
