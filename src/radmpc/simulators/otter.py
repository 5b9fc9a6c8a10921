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

import numpy as np

from radmpc.records import dataclass

__all__ = ["OTTER", "Triple", "Vessel", "accelerations", "thrust_of"]

_GRAVITY = 9.81
"""Acceleration of gravity that bollard pulls are told in kilograms with [m/s²]."""

_WATER = 1025.0
"""Density of sea water [kg/m³]."""

_STRIPS = tuple(zip(*(part.tolist() for part in np.polynomial.legendre.leggauss(8)), strict=True))
"""Places and weights along the hull, from -1 to 1 [-], at which cross-flow drag is summed."""

Triple = tuple[float, float, float]
"""Surge, sway and yaw."""


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
    def mass_inverse(self) -> tuple[float, float, float, float]:
        """Entries of the inverse of M: surge, sway, sway with yaw, yaw."""
        surge, sway, yaw = self.inertia
        coupling = self.mass * self.lead
        determinant = sway * yaw - coupling**2
        return 1.0 / surge, yaw / determinant, -coupling / determinant, sway / determinant


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


def thrust_of(vessel: Vessel, surge: float, yaw: float) -> tuple[float, float]:
    """Return what the left and the right propeller are to give, within what they can [N].

    Parameters
    ----------
    vessel : Vessel
        Whose they are.
    surge : float
        Force ahead that is wanted [N].
    yaw : float
        Moment to the left that is wanted [N m]; it comes first where both cannot be had.
    """
    low, high = -vessel.thrust_astern, vessel.thrust_ahead
    most = 0.5 * (high - low)
    half = min(max(0.5 * yaw / vessel.lever, -most), most)
    middle = min(max(0.5 * surge, low + abs(half)), high - abs(half))
    return middle - half, middle + half


def accelerations(vessel: Vessel, speeds: Triple, forces: Triple) -> Triple:
    """Return how fast the velocities relative to the water change [m/s², rad/s²].

    Parameters
    ----------
    vessel : Vessel
        The boat's kind.
    speeds : tuple of float
        Surge, sway [m/s] and yaw [rad/s].
    forces : tuple of float
        Surge, sway [N] and yaw [N m], of propellers, wind and waves.
    """
    u, v, r = speeds
    surge, sway = vessel.mass + vessel.added[0], vessel.mass + vessel.added[1]
    lead = vessel.mass * vessel.lead
    across = yawing = 0.0
    for place, weight in _STRIPS:
        along = 0.5 * vessel.length * place
        flow = v + r * along
        drag = weight * abs(flow) * flow
        across += drag
        yawing += drag * along
    scale = 0.25 * _WATER * vessel.draft * vessel.cross_flow * vessel.length
    x = forces[0] + sway * v * r + lead * r * r - vessel.damping[0] * u
    y = forces[1] - surge * u * r - vessel.damping[1] * v - scale * across
    n = forces[2] + (surge - sway) * u * v - lead * u * r - scale * yawing
    n -= (vessel.damping[2] + vessel.yaw_damping * abs(r)) * r
    first, second, mixed, third = vessel.mass_inverse
    return first * x, second * y + mixed * n, mixed * y + third * n
