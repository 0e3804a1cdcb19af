"""Formulas of planar grasps on plain numbers. Imports nothing of the project.

Frame of two contacts, used by every file here: u is the unit vector from P_1 to P_2 and p = (-u_y, u_x).

    f_1 = x u + a p                the squeeze x is free,
    f_2 = -(x + phi) u + b p       phi, a and b are fixed by the load.

Functions take and return floats, so that each is called directly for one grasp and compiled for millions;
``path`` takes arrays of instants.
"""
