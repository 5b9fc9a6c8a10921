r"""What measured states tell of disturbances that last, where vehicles have some in common.

Of vehicles that share disturbances λ holds everything that lasts: each one's own, and the shared
ones. Over a step the states of all of them move by :math:`E \lambda + v` beside what was expected,
with v new at every step, own and shared. That is what is measured, so that with P for what is not
known of λ before,

.. math:: P^+ = R \, \bigl(P - P E^\top (E P E^\top + V)^{-1} E P\bigr) R + Q,

R being the correlations from step to step and Q what is new in λ.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.model.vehicle import Vehicle
from radmpc.records import dataclass, field

__all__ = ["Gusts", "gusts_of"]

_NOTHING = 1e-12
"""Share of a measurement's own variance up to which what is left beside others is rounding [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Gusts:
    """What lasts of vehicles that share disturbances.

    Attributes
    ----------
    members : tuple of int
        The vehicles.
    picks : (N, n, q) array
        Where in the loop's state of each vehicle λ stands.
    keeps : (q,) array
        Correlations from step to step [-].
    renewed : (q, q) array
        Covariance of what is new in λ at every step.
    effects : (p, q) array
        What λ adds to the states of all members over a step.
    fresh : (p, p) array
        Covariance of all that is added besides.
    unknown : list of (q, q) array
        Covariance of λ given the states up to each step, as far as it was asked for.
    """

    members: tuple[int, ...]
    picks: Tensor
    keeps: Vector
    renewed: Matrix
    effects: Matrix
    fresh: Matrix
    unknown: list[Matrix] = field(default_factory=list)

    def left_open(self, step: int) -> Tensor:
        """Return what standard normals make of loops, given all states up to a step, (N, n, q).

        Parameters
        ----------
        step : int
            0..T.
        """
        while len(self.unknown) <= step:
            self.unknown.append(self._later(self.unknown[-1]))
        values, vectors = np.linalg.eigh(self.unknown[step])
        return np.asarray(self.picks @ (vectors * np.sqrt(values.clip(min=0.0))))

    def _later(self, unknown: Matrix) -> Matrix:
        """Return the covariance of λ a step later, once states are measured."""
        crossed = self.effects @ unknown
        told = crossed @ self.effects.T + self.fresh
        units = np.sqrt(np.diag(told))
        moves = units > 0.0
        seen = crossed[moves] / units[moves, None]
        values, vectors = np.linalg.eigh(told[np.ix_(moves, moves)] / np.outer(*2 * [units[moves]]))
        tells = values > _NOTHING
        root = (vectors[:, tells] / np.sqrt(values[tells])).T @ seen
        left = self.keeps[:, None] * (unknown - root.T @ root) * self.keeps
        return np.asarray(0.5 * (left + left.T) + self.renewed)


def gusts_of(vehicles: Sequence[Vehicle], size: int) -> Gusts | None:
    """Return what lasts of vehicles that share disturbances, None where nothing does.

    Parameters
    ----------
    vehicles : sequence of Vehicle
        Of the fleet, their states known exactly.
    size : int
        Length of the longest loop's state.
    """
    members = [i for i, vehicle in enumerate(vehicles) if vehicle.shared]
    sharing = [vehicles[i] for i in members]
    rho, blocks = _lasting(sharing)
    if not rho:
        return None
    ends = np.cumsum([0, *(len(covariance) for covariance in blocks.values())])
    places = {key: slice(*ends[k : k + 2]) for k, key in enumerate(blocks)}
    picks = np.zeros((len(vehicles), size, ends[-1]))
    keeps, renewed, begun = np.empty(ends[-1]), *np.zeros((2, ends[-1], ends[-1]))
    for key, covariance in blocks.items():
        at = places[key]
        keeps[at] = rho[key]
        begun[at, at], renewed[at, at] = covariance, (1.0 - rho[key] ** 2) * covariance
    known: list[tuple[Matrix, Matrix]] = []
    for i, vehicle in zip(members, sharing, strict=True):
        row = n = vehicle.system.num_states
        for key in _keys(vehicle):
            r = len(blocks[key])
            picks[i, row : row + r, places[key]] = np.eye(r)
            row += r
        if vehicle.known is not None and vehicle.known.common is not None:
            rows = vehicle.known.common[n if vehicle.disturbance_correlation > 0.0 else 2 * n :]
            known.append((picks[i, n:row], rows))
    if known:
        begun = _begun(known, ends[-1])
    effects, fresh = _moving(sharing, places)
    return Gusts(tuple(members), picks, keeps, renewed, effects, fresh, [begun])


def _keys(vehicle: Vehicle) -> list[str]:
    """Return what lasts of a vehicle, in the order of its loop's state."""
    own = [f"\0{vehicle.name}"] if vehicle.disturbance_correlation > 0.0 else []
    return own + [part.name for part in vehicle.shared if part.correlation > 0.0]


def _lasting(vehicles: Sequence[Vehicle]) -> tuple[dict[str, float], dict[str, Matrix]]:
    """Return the correlations and covariances of everything that lasts, by name."""
    rho: dict[str, float] = {}
    blocks: dict[str, Matrix] = {}
    for vehicle in vehicles:
        keys = _keys(vehicle)
        if vehicle.disturbance_correlation > 0.0:
            rho[keys[0]] = vehicle.disturbance_correlation
            blocks[keys[0]] = vehicle.disturbance_covariance
        for part in vehicle.shared:
            if part.correlation > 0.0:
                rho[part.name], blocks[part.name] = part.correlation, part.covariance
    return rho, blocks


def _begun(known: Sequence[tuple[Matrix, Matrix]], size: int) -> Matrix:
    """Return the covariance of λ as plans begin with it: of what lasts, and its normals."""
    root = np.zeros((size, known[0][1].shape[1]))
    for picks, rows in known:
        at = picks.argmax(axis=1)
        root[at] = rows
    return np.asarray(root @ root.T)


def _moving(vehicles: Sequence[Vehicle], places: dict[str, slice]) -> tuple[Matrix, Matrix]:
    """Return what λ adds to all states over a step, and the covariance of what else is added."""
    sizes = [vehicle.system.num_states for vehicle in vehicles]
    ends = np.cumsum([0, *sizes])
    effects = np.zeros((ends[-1], max(place.stop for place in places.values())))
    fresh = np.zeros((ends[-1], ends[-1]))
    new: dict[str, tuple[Matrix, Matrix]] = {}
    for vehicle, start, end in zip(vehicles, ends[:-1], ends[1:], strict=True):
        mine = slice(start, end)
        own = f"\0{vehicle.name}"
        if own in places:
            effects[mine, places[own]] = np.eye(end - start)
        else:
            fresh[mine, mine] += vehicle.disturbance_covariance
        for part in vehicle.shared:
            if part.name in places:
                effects[mine, places[part.name]] = part.matrix
                continue
            acts = new.setdefault(part.name, (np.zeros((ends[-1], part.size)), part.covariance))[0]
            acts[mine] = part.matrix
    for acts, covariance in new.values():
        fresh += acts @ covariance @ acts.T
    return effects, fresh
