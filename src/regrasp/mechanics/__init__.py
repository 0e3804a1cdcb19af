"""Contacts, wrenches, grasps and the forces in them. Imports no solver."""

from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.margins import Margins
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench

__all__ = ["Contact", "Grasp", "GraspState", "Margins", "Wrench"]
