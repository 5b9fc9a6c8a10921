"""How fast a double integrator may go at every step: in time at its goal, noise aside.

Each axis is driven by a control of its own, so that the velocities it may have at a step form an
interval, which follows from both ends: full throttle from the start, and back from the goal. Where
all intervals hold something, some controls lead through the upper ends of all of them, and some
through the lower ends: positions at the horizon are reached from one to the other, and no others.
"""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.model.vehicle import Vehicle
from radmpc.records import dataclass

__all__ = ["ARRIVED", "Envelope", "Pace"]

ARRIVED = 1e-6
"""What a mean may miss its goal by [m], as for planners."""

_HALVINGS = 50
"""Bisections of a speed: known to a rounding [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Envelope:
    """Velocities from which the start is behind and the goal ahead.

    Attributes
    ----------
    lower, upper : (T+1, d) array
        Least and largest velocity at each step, in time at the goal [m/s]; crossed where there is
        none.
    """

    lower: Matrix
    upper: Matrix

    @property
    def is_open(self) -> bool:
        """Whether there is a velocity at every step."""
        return bool(np.all(self.lower <= self.upper + 1e-9))


@dataclass(frozen=True, slots=True, eq=False)
class Pace:
    """A double integrator whose axes have a control each.

    Attributes
    ----------
    vehicle : Vehicle
        The vehicle.
    dt : float
        Step [s].
    controls : (d,) int array
        The control of each axis.
    gains : (d,) array
        Velocity that a unit of control held over a step adds [m/s per unit].
    place, speed : (d,) array
        Position [m] and velocity [m/s] at the start.
    limit, last : (d,) array
        Largest speed after the start, and at the goal [m/s]; inf without a limit.
    """

    vehicle: Vehicle
    dt: float
    controls: Indices
    gains: Vector
    place: Vector
    speed: Vector
    limit: Vector
    last: Vector

    @classmethod
    def of(cls, vehicle: Vehicle) -> Pace | None:
        """Read it off a vehicle.

        Parameters
        ----------
        vehicle : Vehicle
            Any.

        Returns
        -------
        Pace or None
            None for other dynamics, under a drift or what is known to last, and where axes
            share controls.
        """
        rates = vehicle.system.rates
        if rates is None or vehicle.pushes(1) is not None:
            return None
        if vehicle.system.velocity not in {None, rates[0]}:
            return None
        velocity, dt = list(rates[0]), rates[1]
        pushes = np.abs(vehicle.system.B[velocity])
        controls = pushes.argmax(axis=1)
        is_own = np.count_nonzero(pushes) == len(controls) == len(set(controls.tolist()))
        if not is_own or pushes.shape[1] != len(controls):
            return None
        limit = np.full(len(controls), np.inf)
        if vehicle.speed_limit is not None:
            limit = vehicle.speed_limit
        last = limit if vehicle.goal.speed is None else np.minimum(limit, vehicle.goal.speed)
        gains = pushes[np.arange(len(controls)), controls]
        start = vehicle.start
        return cls(
            vehicle, dt, controls, gains, vehicle.start_position, start[velocity], limit, last
        )

    def envelope(self, bounds: Matrix) -> Envelope:
        """Return the velocities at each step that obey the limits, in time at the goal's speed.

        Parameters
        ----------
        bounds : (T, m) array
            Largest control at each step, >= 0.

        Returns
        -------
        Envelope
            Exactly those that some controls lead through.
        """
        spent = np.zeros((len(bounds) + 1, self.gains.size))
        np.cumsum(bounds[:, self.controls] * self.gains, axis=0, out=spent[1:])
        back = np.minimum(self.last + spent[-1] - spent, self.limit)
        # Speed limits begin one step after the start.
        back[0] = np.minimum(self.last + spent[-1], self.limit + spent[1])
        upper = np.minimum(self.speed + spent, self.limit)
        lower = np.maximum(self.speed - spent, -self.limit)
        upper[0] = lower[0] = self.speed
        return Envelope(np.maximum(lower, -back), np.minimum(upper, back))

    def positions(self, velocities: Matrix) -> Matrix:
        """Return the positions at each step under velocities that change evenly in between.

        Parameters
        ----------
        velocities : (T+1, d) array
            Velocities at the steps [m/s].

        Returns
        -------
        (T+1, d) array
            Positions [m].
        """
        places = np.zeros_like(velocities)
        np.cumsum(0.5 * self.dt * (velocities[:-1] + velocities[1:]), axis=0, out=places[1:])
        return np.asarray(self.place + places)

    def arrives(self, bounds: Matrix) -> bool:
        """Whether some controls lead to the goal at the horizon, through empty space.

        Parameters
        ----------
        bounds : (T, m) array
            Largest control at each step, >= 0.
        """
        envelope = self.envelope(bounds)
        if not envelope.is_open:
            return False
        goal = self.vehicle.goal
        most = self.positions(envelope.upper)[-1]
        least = self.positions(envelope.lower)[-1]
        return bool(np.all((least <= goal.upper + ARRIVED) & (most >= goal.lower - ARRIVED)))

    def cheapest(self, bounds: Matrix) -> Matrix | None:
        """Return controls of the least effort, summed as absolute values, through empty space.

        Full throttle up to a cruising speed, and full throttle from there to the goal's: no other
        controls get as far with less.

        Parameters
        ----------
        bounds : (T, m) array
            Largest control at each step, >= 0.

        Returns
        -------
        (T, m) array or None
            None where the goal is out of reach.
        """
        if not self.arrives(bounds):
            return None
        envelope = self.envelope(bounds)
        low, high = envelope.lower.min(axis=0), envelope.upper.max(axis=0)
        goal = self.vehicle.goal
        # As it comes, if that ends in the goal, else to its nearer side.
        target = np.clip(self._end(envelope, self.speed), goal.lower, goal.upper)
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            falls_short = self._end(envelope, middle) < target
            low, high = np.where(falls_short, middle, low), np.where(falls_short, high, middle)
        velocities = np.clip(0.5 * (low + high), envelope.lower, envelope.upper)
        controls = np.zeros_like(bounds)
        controls[:, self.controls] = np.diff(velocities, axis=0) / self.gains
        return controls

    def _end(self, envelope: Envelope, cruise: Vector) -> Vector:
        """Return the position at the horizon at a cruising speed, as far as it is allowed [m]."""
        return np.asarray(self.positions(np.clip(cruise, envelope.lower, envelope.upper))[-1])

    def reach(self, bounds: Matrix) -> tuple[Matrix, Matrix]:
        """Return boxes that hold the mean at each step, in time at the goal.

        Parameters
        ----------
        bounds : (T, m) array
            Largest control at each step, >= 0.

        Returns
        -------
        lower, upper : (T+1, d) array
            Corners [m]; crossed where the goal is out of reach.
        """
        envelope, goal = self.envelope(bounds), self.vehicle.goal
        most, least = self.positions(envelope.upper), self.positions(envelope.lower)
        lower = np.maximum(least, goal.lower - (most[-1] - most))
        upper = np.minimum(most, goal.upper - (least[-1] - least))
        return lower, upper
