"""The referee's own propagation: means under controls, and noise whatever these are."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Self

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.records import dataclass, replace
from radmpc.referee.common import fleet_common, lasting_added, lasting_means
from radmpc.referee.loop import Loop, loop_of
from radmpc.referee.motion import FleetMotion, Group
from radmpc.referee.tracks import tracks_of

__all__ = ["FleetNoise", "propagate"]


def propagate(scenario: Scenario, controls: Sequence[Matrix]) -> FleetMotion:
    r"""Return the motion of a fleet under given nominal controls.

    With noise that is new at every step

    .. math:: \bar x^+ = A \bar x + B \bar u + c, \qquad
              \Sigma^+ = (A + BK) \Sigma (A + BK)^\top + W

    Parameters
    ----------
    scenario : Scenario
        Starts, dynamics, feedback and noise are taken from here.
    controls : sequence of (T, m) array
        Nominal controls in the scenario's order.

    Returns
    -------
    FleetMotion
        Per vehicle, and positions stacked.
    """
    return FleetNoise.of(scenario).under(controls)


@dataclass(frozen=True, slots=True, eq=False)
class FleetNoise:
    """What of a fleet's motion no controls change, for many plans of one scenario.

    Attributes
    ----------
    scenario : Scenario
        Starts, dynamics, feedback and noise are taken from here.
    still : FleetMotion
        The motion, its states, positions and sagittas left empty.
    """

    scenario: Scenario
    still: FleetMotion

    @classmethod
    def of(cls, scenario: Scenario) -> Self:
        """Propagate the covariances of a scenario.

        Parameters
        ----------
        scenario : Scenario
            The fleet.
        """
        vehicles, horizon = scenario.vehicles, scenario.horizon
        described = [loop_of(vehicle, horizon) for vehicle in vehicles]
        groups = _grouped(vehicles, described)
        loops = _propagated(groups, len(vehicles), horizon)
        covariances = [_part(loop, 0, v) for loop, v in zip(loops, vehicles, strict=True)]
        seen = [_part(p, one.seen, v) for p, one, v in zip(loops, described, vehicles, strict=True)]
        axes = [list(v.system.position) for v in vehicles]
        bends = [_bend(v, loop) for v, loop in zip(vehicles, described, strict=True)]
        nothing = np.empty((len(vehicles), 0, scenario.dimension))
        still = FleetMotion(
            names=tuple(v.name for v in vehicles),
            groups=groups,
            states=(),
            covariances=tuple(covariances),
            seen=tuple(seen),
            seen_rows=tuple(one.seen for one in described),
            loops=tuple(loops),
            positions=nothing,
            position_covariances=np.stack(
                [c[:, a][:, :, a] for c, a in zip(covariances, axes, strict=True)]
            ),
            sagittas=nothing,
            bends=tuple(bends),
            bent_covariances=_bent_covariances(loops, axes, bends),
            radii=np.array([v.radius for v in vehicles]),
            tracks=tracks_of(scenario),
            common=fleet_common(described, axes, bends, horizon),
            samples=scenario.covariance_samples,
            unknown=tuple(one.unknown for one in described),
            lasting=tuple(lasting_means(v, horizon) for v in vehicles),
        )
        return cls(scenario, still)

    def under(self, controls: Sequence[Matrix]) -> FleetMotion:
        """Return the motion under given nominal controls.

        Parameters
        ----------
        controls : sequence of (T, m) array
            In the scenario's order.
        """
        vehicles = self.scenario.vehicles
        states = _mean_states(vehicles, controls, self.still.lasting)
        sagittas = np.zeros((len(vehicles), self.scenario.horizon, self.scenario.dimension))
        for i, vehicle in enumerate(vehicles):
            if vehicle.system.is_double_integrator:
                # The push that shifts the position by B_p u over a step deviates from its chord by
                # a quarter of that in the middle.
                axes = list(vehicle.system.position)
                sagittas[i] = controls[i] @ vehicle.system.B[axes].T / 4.0
        positions = [x[:, list(v.system.position)] for x, v in zip(states, vehicles, strict=True)]
        return replace(
            self.still, states=tuple(states), positions=np.stack(positions), sagittas=sagittas
        )


def _propagated(groups: Sequence[Group], count: int, horizon: int) -> list[Tensor]:
    """Return the covariances of every vehicle's loop."""
    loops: list[Tensor] = [np.empty(0)] * count
    for group in groups:
        for member, tensor in zip(group.members, _covariances(group, horizon), strict=True):
            loops[member] = tensor
    return loops


def _part(covariances: Tensor, row: int, vehicle: Vehicle) -> Tensor:
    """Return a block of a loop's covariances, as long as the vehicle's state, from a row on."""
    last = row + vehicle.system.num_states
    return covariances[:, row:last, row:last]


def _mean_states(
    vehicles: Sequence[Vehicle], controls: Sequence[Matrix], lasting: Sequence[Matrix | None]
) -> list[Matrix]:
    """Return the mean states of every vehicle at k = 0..T, those of equal size together."""
    found: list[Matrix] = [np.empty(0)] * len(vehicles)
    alike: dict[tuple[int, ...], list[int]] = {}
    for i, vehicle in enumerate(vehicles):
        alike.setdefault(vehicle.system.B.shape, []).append(i)
    with np.errstate(over="ignore", invalid="ignore"):  # overflow is reported, not warned of
        for members in alike.values():
            A = np.stack([vehicles[i].system.A for i in members])
            B = np.stack([vehicles[i].system.B for i in members])
            pushes = np.stack([controls[i] for i in members]) @ B.transpose(0, 2, 1)
            for row, i in enumerate(members):
                pushes[row] += _pushed(vehicles[i], lasting[i])
            states = np.empty((len(members), pushes.shape[1] + 1, A.shape[1]))
            states[:, 0] = [vehicles[i].start for i in members]
            for k in range(pushes.shape[1]):
                states[:, k + 1] = (A @ states[:, k, :, None])[:, :, 0] + pushes[:, k]
            for i, path in zip(members, states, strict=True):
                found[i] = path
    return found


def _pushed(vehicle: Vehicle, lasting: Matrix | None) -> Matrix | Vector | float:
    """Return what drift and what is expected of noise that lasts add to the state, (T or 1, n)."""
    added: Matrix | Vector | float = 0.0 if vehicle.drift is None else vehicle.drift
    if lasting is None:
        return added
    return added + np.array([lasting_added(vehicle, each) for each in lasting[:-1]])


def _grouped(vehicles: Sequence[Vehicle], loops: Sequence[Loop]) -> tuple[Group, ...]:
    """Stack the closed loops whose states are of equal length, those that change on their own."""
    by_size: dict[tuple[int, ...], list[int]] = {}
    for i, loop in enumerate(loops):
        by_size.setdefault(loop.transitions.shape, []).append(i)
    return tuple(_group(vehicles, loops, members) for members in by_size.values())


def _group(vehicles: Sequence[Vehicle], loops: Sequence[Loop], members: list[int]) -> Group:
    """Stack some loops."""
    chosen = [loops[i] for i in members]
    initial = np.stack([loop.initial for loop in chosen])
    disturbances = np.stack([loop.disturbances for loop in chosen])
    own = initial, disturbances
    if any(loop.common is not None for loop in chosen):
        own = (
            np.stack([one.common.own_initial if one.common else one.initial for one in chosen]),
            np.stack(
                [one.common.own_disturbances if one.common else one.disturbances for one in chosen]
            ),
        )
    return Group(
        np.array(members),
        np.stack([loop.transitions for loop in chosen]),
        initial,
        disturbances,
        np.array([vehicles[i].system.position for i in members]),
        *own,
    )


def _bend(vehicle: Vehicle, loop: Loop) -> Matrix | None:
    """Return ``B_p K`` for the state of a loop, (d, q); None where feedback bends no path."""
    if vehicle.gain is None or not vehicle.system.is_double_integrator:
        return None
    bend = np.zeros((vehicle.system.dimension, len(loop.initial)))
    pushes = vehicle.system.B[list(vehicle.system.position)]
    bend[:, loop.seen : loop.seen + vehicle.system.num_states] = pushes @ vehicle.gain
    return bend


def _bent_covariances(
    loops: Sequence[Tensor], axes: Sequence[list[int]], bends: Sequence[Matrix | None]
) -> Tensor:
    """Return what feedback held over a step makes of positions, (N, T, d, d)."""
    found = []
    for covariances, place, bend in zip(loops, axes, bends, strict=True):
        if bend is None:
            found.append(covariances[:-1, place][:, :, place])
            continue
        turned = np.eye(covariances.shape[1])[place] - bend
        with np.errstate(over="ignore", invalid="ignore"):  # overflow is reported elsewhere
            found.append(turned @ covariances[:-1] @ turned.T)
    return np.array(found)


def _covariances(group: Group, horizon: int) -> Tensor:
    """Return the covariances of a group's loops, (g, T+1, q, q)."""
    result = np.empty((len(group.members), horizon + 1, *group.initial.shape[1:]))
    result[:, 0] = group.initial
    last = group.transitions.shape[1] - 1
    with np.errstate(over="ignore", invalid="ignore"):  # overflow is reported, not warned of
        for k in range(horizon):
            loop = group.transitions[:, min(k, last)]
            moved = loop @ result[:, k] @ loop.transpose(0, 2, 1)
            result[:, k + 1] = moved + group.disturbances[:, min(k, last)]
    return 0.5 * (result + result.transpose(0, 1, 3, 2))
