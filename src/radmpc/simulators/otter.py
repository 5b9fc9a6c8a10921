r"""The Otter, a small uncrewed catamaran with two propellers, in surge, sway and yaw.

Equations of motion after T. I. Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*,
2nd ed., Wiley 2021, chapter 6, for the velocity relative to the water
:math:`\nu_r = [u_r, v_r, r]` in an irrotational current :math:`V_c`:

.. math:: M \dot\nu_r + C(\nu_r)\, \nu_r + D(\nu_r)\, \nu_r = \tau, \qquad
          \dot\eta = R(\psi)\, \nu_r + [V_c; 0].

The numbers are those that Fossen publishes for the Otter of Maritime Robotics in the Marine Systems
Simulator and its Python version: mass, payload, added mass, time constants, bollard pull and shaft
speeds. Roll, pitch and heave are left out. Axes are the scenario's: x and y in meters, headings
from x toward y.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from radmpc.arrays import Matrix, Vector

__all__ = ["OTTER", "Vessel", "accelerations", "heading_vectors", "thrust_of"]

_GRAVITY = 9.81
"""Acceleration of gravity that bollard pulls are told in kilograms with [m/s²]."""

_WATER = 1025.0
"""Density of sea water [kg/m³]."""

_STRIPS = np.polynomial.legendre.leggauss(8)
"""Places and weights along the hull, from -1 to 1 [-], at which cross-flow drag is summed."""


@dataclass(frozen=True, slots=True)
class Vessel:
    """A catamaran's data.

    Attributes
    ----------
    length, draft : float
        Of a hull in the water [m].
    inertia : tuple of float
        Rigid body and added mass together: surge [kg], sway [kg], yaw [kg m²].
    added : tuple of float
        Added mass alone, in surge and sway [kg].
    mass : float
        With payload [kg].
    lead : float
        Center of gravity ahead of the origin [m].
    damping : tuple of float
        Linear: surge [N s/m], sway [N s/m], yaw [N m s].
    yaw_damping : float
        Quadratic, on ``|r| r`` [N m s²].
    cross_flow : float
        Drag coefficient of the hull across [-].
    lever : float
        Of each propeller from the middle [m].
    thrust_ahead, thrust_astern : float
        Largest of one propeller [N].
    propeller_time : float
        Time constant of the thrust [s].
    """

    length: float
    draft: float
    inertia: tuple[float, float, float]
    added: tuple[float, float]
    mass: float
    lead: float
    damping: tuple[float, float, float]
    yaw_damping: float
    cross_flow: float
    lever: float
    thrust_ahead: float
    thrust_astern: float
    propeller_time: float

    @property
    def mass_inverse(self) -> Matrix:
        """Inverse of M, (3, 3)."""
        coupling = self.mass * self.lead
        surge, sway, yaw = self.inertia
        mass = np.array([[surge, 0.0, 0.0], [0.0, sway, coupling], [0.0, coupling, yaw]])
        return np.asarray(np.linalg.inv(mass), dtype=np.float64)


def _otter(hull: float = 55.0, payload: float = 25.0) -> Vessel:
    """Return the Otter's data: hull of 2.0 by 1.08 m, masses in kg."""
    length, beam_of_hull, block = 2.0, 0.25, 0.4
    mass = hull + payload
    hull_lead, payload_lead = 0.2, 0.05
    lead = (hull * hull_lead + payload * payload_lead) / mass
    # The hull's radius of gyration is a quarter of its length; the payload counts as a point.
    about_center = hull * ((0.25 * length) ** 2 + (hull_lead - lead) ** 2)
    about_center += payload * (payload_lead - lead) ** 2
    surge, sway, yaw = 0.1 * hull, 1.5 * hull, 1.7 * about_center
    inertia = (mass + surge, mass + sway, about_center + mass * lead**2 + yaw)
    fastest, sway_time, yaw_time = 6.0 * 0.5144, 1.0, 1.0
    return Vessel(
        length=length,
        draft=mass / _WATER / (2.0 * block * beam_of_hull * length),
        inertia=inertia,
        added=(surge, sway),
        mass=mass,
        lead=lead,
        damping=(24.4 * _GRAVITY / fastest, inertia[1] / sway_time, inertia[2] / yaw_time),
        yaw_damping=10.0 * inertia[2] / yaw_time,
        cross_flow=1.0,  # Hoerner's curve at half the beam over the draft, 0.64
        lever=0.395,
        thrust_ahead=0.5 * 24.4 * _GRAVITY,
        thrust_astern=0.5 * 13.6 * _GRAVITY,
        propeller_time=0.1,
    )


OTTER = _otter()
"""With the payload of 25 kg; at full thrust 3.1 m/s through the water."""


def heading_vectors(headings: Vector) -> tuple[Matrix, Matrix]:
    """Return unit vectors ahead and to the left, (N, 2) each.

    Parameters
    ----------
    headings : (N,) array
        From x toward y [rad].
    """
    ahead = np.stack([np.cos(headings), np.sin(headings)], axis=1)
    return ahead, np.stack([-ahead[:, 1], ahead[:, 0]], axis=1)


def thrust_of(vessel: Vessel, surge: Vector, yaw: Vector) -> Matrix:
    """Return what both propellers are to give, within what they can, (N, 2) [N].

    Parameters
    ----------
    vessel : Vessel
        Whose they are.
    surge : (N,) array
        Force ahead that is wanted [N].
    yaw : (N,) array
        Moment to the left that is wanted [N m]; it comes first where both cannot be had.
    """
    low, high = -vessel.thrust_astern, vessel.thrust_ahead
    half = np.clip(0.5 * yaw / vessel.lever, -0.5 * (high - low), 0.5 * (high - low))
    middle = np.clip(0.5 * surge, low + np.abs(half), high - np.abs(half))
    return np.stack([middle - half, middle + half], axis=1)


def accelerations(vessel: Vessel, inverse: Matrix, speeds: Matrix, forces: Matrix) -> Matrix:
    """Return how fast the velocities relative to the water change, (N, 3) [m/s², rad/s²].

    Parameters
    ----------
    vessel : Vessel
        The boats' kind.
    inverse : (3, 3) array
        Its `mass_inverse`.
    speeds : (N, 3) array
        Surge, sway [m/s] and yaw [rad/s].
    forces : (N, 3) array
        Surge, sway [N] and yaw [N m], of propellers, wind and waves.
    """
    u, v, r = speeds.T
    surge, sway = vessel.mass + vessel.added[0], vessel.mass + vessel.added[1]
    lead = vessel.mass * vessel.lead
    places, weights = _STRIPS
    along = 0.5 * vessel.length * places
    across = v[:, None] + r[:, None] * along
    scale = 0.5 * _WATER * vessel.draft * vessel.cross_flow * 0.5 * vessel.length
    drag = scale * weights * np.abs(across) * across
    yawing = vessel.damping[2] + vessel.yaw_damping * np.abs(r)
    total = np.stack(
        [
            sway * v * r + lead * r * r - vessel.damping[0] * u,
            -surge * u * r - vessel.damping[1] * v - drag.sum(axis=1),
            (surge - sway) * u * v - lead * u * r - yawing * r - drag @ along,
        ],
        axis=1,
    )
    return np.asarray((forces + total) @ inverse.T)
