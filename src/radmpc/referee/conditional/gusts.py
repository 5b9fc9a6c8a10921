r"""What measurements tell of a fleet, where vehicles have disturbances in common.

Of vehicles that share disturbances λ holds everything that measurements leave open: the state's
deviation of those that estimate it, each one's own disturbance where it lasts, and the shared ones
that do. Over a step it moves to :math:`M \lambda + v`, and beside what was expected the states of
those that know theirs move by :math:`E \lambda + v'`, which is measured; of the others
:math:`y = H \lambda^+ + r` is. All of these are Gaussian together, so that the one is conditioned
on the other.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix, Tensor
from radmpc.model.vehicle import Vehicle
from radmpc.records import dataclass, field

__all__ = ["Gusts", "gusts_of"]

_NOTHING = 1e-12
"""Share of a measurement's own variance up to which what is left beside others is rounding [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Gusts:
    """What measurements leave open of vehicles that share disturbances.

    Attributes
    ----------
    members : tuple of int
        The vehicles.
    picks : (N, n, q) array
        Where in the loop's state of each vehicle λ stands.
    transition : (q + p, q) array
        M, and E of all vehicles that know their states.
    fresh : (q + p, q + p) array
        Covariance of v and v'.
    sees : (s, q) array
        H, of all vehicles that do not.
    errors : (s, s) array
        Covariance of r.
    unknown : list of (q, q) array
        Covariance of λ given all that is measured up to each step, as far as it was asked for.
    """

    members: tuple[int, ...]
    picks: Tensor
    transition: Matrix
    fresh: Matrix
    sees: Matrix
    errors: Matrix
    unknown: list[Matrix] = field(default_factory=list)

    def left_open(self, step: int) -> Tensor:
        """Return what standard normals make of loops, given all measured to a step, (N, n, q).

        Parameters
        ----------
        step : int
            0..T.
        """
        while len(self.unknown) <= step:
            moved = self.transition @ self.unknown[-1] @ self.transition.T + self.fresh
            self.unknown.append(self.updated(moved))
        values, vectors = np.linalg.eigh(self.unknown[step])
        return np.asarray(self.picks @ (vectors * np.sqrt(values.clip(min=0.0))))

    def updated(self, joint: Matrix) -> Matrix:
        """Return the covariance of λ given what is measured of it.

        Parameters
        ----------
        joint : (q + p, q + p) array
            Of λ, and of what is measured without error.
        """
        q, size = self.picks.shape[2], len(joint)
        seen = np.zeros((size - q + len(self.sees), size))
        seen[: size - q, q:] = np.eye(size - q)
        seen[size - q :, :q] = self.sees
        crossed = seen @ joint
        told = crossed @ seen.T
        told[size - q :, size - q :] += self.errors
        units = np.sqrt(np.diag(told))
        has_any = units > 0.0
        scaled = told[np.ix_(has_any, has_any)] / np.outer(units[has_any], units[has_any])
        values, vectors = np.linalg.eigh(scaled)
        tells = values > _NOTHING
        of_rest = crossed[has_any, :q] / units[has_any, None]
        root = (vectors[:, tells] / np.sqrt(values[tells])).T @ of_rest
        left = joint[:q, :q] - root.T @ root
        return np.asarray(0.5 * (left + left.T))


@dataclass(slots=True, eq=False)
class _Places:
    """Where everything stands: in λ by name, and after it the states that are known exactly."""

    states: dict[str, slice]
    own: dict[str, slice]
    shared: dict[str, slice]
    exact: dict[str, slice]
    q: int
    size: int


def gusts_of(vehicles: Sequence[Vehicle], size: int) -> Gusts | None:
    """Return what is left open of vehicles that share disturbances, None where nothing is.

    Parameters
    ----------
    vehicles : sequence of Vehicle
        Of the fleet.
    size : int
        Length of the longest loop's state.
    """
    members = [i for i, vehicle in enumerate(vehicles) if vehicle.shared]
    sharing = [vehicles[i] for i in members]
    places = _places(sharing)
    if not places.q:
        return None
    transition, fresh = _moving(sharing, places)
    sees, errors = _sensors(sharing, places)
    picks = np.zeros((len(vehicles), size, places.q))
    for i, vehicle in zip(members, sharing, strict=True):
        rows = _rows(vehicle, places)
        row = 0 if vehicle.measurement is not None else vehicle.start.size
        picks[i, row + np.arange(len(rows)), rows] = 1.0
    found = Gusts(tuple(members), picks, transition, fresh, sees, errors)
    begun = _begun(sharing, places)
    if any(vehicle.belief is not None for vehicle in sharing):
        found.unknown.append(begun)
    else:
        exact = np.zeros_like(fresh)
        exact[: places.q, : places.q] = begun
        found.unknown.append(found.updated(exact))
    return found


def _places(vehicles: Sequence[Vehicle]) -> _Places:
    """Return where everything stands of vehicles that share disturbances."""
    end = 0
    found: list[dict[str, slice]] = [{}, {}, {}, {}]
    for kind, blocks in enumerate(
        (
            {v.name: v.start.size for v in vehicles if v.measurement is not None},
            {v.name: v.start.size for v in vehicles if v.disturbance_correlation > 0.0},
            {p.name: p.size for v in vehicles for p in v.shared if p.correlation > 0.0},
            {v.name: v.start.size for v in vehicles if v.measurement is None},
        )
    ):
        q = end
        for name, count in blocks.items():
            found[kind][name] = slice(end, end + count)
            end += count
    states, own, shared, exact = found
    return _Places(states, own, shared, exact, q, end)


def _rows(vehicle: Vehicle, places: _Places) -> list[int]:
    """Return where in λ what is left open of a vehicle stands, in the order of its loop."""
    blocks = [places.states.get(vehicle.name), places.own.get(vehicle.name)]
    blocks += [places.shared.get(part.name) for part in vehicle.shared]
    return [row for at in blocks if at is not None for row in range(at.start, at.stop)]


def _begun(vehicles: Sequence[Vehicle], places: _Places) -> Matrix:
    """Return the covariance of λ at k = 0."""
    result = np.zeros((places.q, places.q))
    root = np.zeros((places.q, 0))
    for vehicle in vehicles:
        if vehicle.name in places.states:
            at = places.states[vehicle.name]
            result[at, at] = vehicle.initial_covariance
        if vehicle.name in places.own:
            at = places.own[vehicle.name]
            result[at, at] = vehicle.disturbance_covariance
        for part in vehicle.shared:
            if part.name in places.shared:
                at = places.shared[part.name]
                result[at, at] = part.covariance
        if vehicle.belief is None or vehicle.belief.common is None:
            continue
        # What is known of it is known together with the others: that is all there is.
        n, rows, common = vehicle.start.size, _rows(vehicle, places), vehicle.belief.common
        if not root.shape[1]:
            root = np.zeros((places.q, common.shape[1]))
        kept = np.zeros(len(common), dtype=bool)
        kept[:n], kept[2 * n :] = vehicle.name in places.states, True
        kept[n : 2 * n] = vehicle.name in places.own
        root[rows] = common[kept]
        result[rows] = result[:, rows] = 0.0
    return np.asarray(result + root @ root.T)


def _moving(vehicles: Sequence[Vehicle], places: _Places) -> tuple[Matrix, Matrix]:
    """Return what λ makes of itself and of known states over a step, and what is new in both."""
    transition, fresh = np.zeros((places.size, places.q)), np.zeros((places.size, places.size))
    new: dict[str, tuple[Matrix, Matrix]] = {}
    for vehicle in vehicles:
        n, name = vehicle.start.size, vehicle.name
        if name in places.states:
            mine = places.states[name]
            transition[mine, mine] = vehicle.system.A
        else:
            mine = places.exact[name]
        if name in places.own:
            at, rho = places.own[name], vehicle.disturbance_correlation
            transition[mine, at], transition[at, at] = np.eye(n), rho * np.eye(n)
            fresh[at, at] = (1.0 - rho * rho) * vehicle.disturbance_covariance
        else:
            fresh[mine, mine] += vehicle.disturbance_covariance
        for part in vehicle.shared:
            if part.name in places.shared:
                at, rho = places.shared[part.name], part.correlation
                transition[mine, at], transition[at, at] = part.matrix, rho * np.eye(part.size)
                fresh[at, at] = (1.0 - rho * rho) * part.covariance
                continue
            acts = new.setdefault(part.name, (np.zeros((places.size, part.size)), part.covariance))[
                0
            ]
            acts[mine] = part.matrix
    for acts, covariance in new.values():
        fresh += acts @ covariance @ acts.T
    return transition, fresh


def _sensors(vehicles: Sequence[Vehicle], places: _Places) -> tuple[Matrix, Matrix]:
    """Return what sensors see of λ, and the covariance of their errors."""
    sensors = [(v.name, v.measurement) for v in vehicles if v.measurement is not None]
    ends = np.cumsum([0, *(len(sensor.matrix) for _, sensor in sensors)])
    sees, errors = np.zeros((ends[-1], places.q)), np.zeros((ends[-1], ends[-1]))
    for (name, sensor), start, end in zip(sensors, ends[:-1], ends[1:], strict=True):
        sees[start:end, places.states[name]] = sensor.matrix
        errors[start:end, start:end] = sensor.covariance
    return sees, errors
