r"""The referee's own account of noise that vehicles have in common.

With the closed loops of two vehicles and the pushes M by which standard normals that both meet
enter them,

.. math:: \Sigma_{ij}^+ = F_i \Sigma_{ij} F_j^\top + M_i M_j^\top, \qquad
    \operatorname{cov}(y_i - y_j) = \Sigma_i + \Sigma_j - \Sigma_{ij} - \Sigma_{ij}^\top.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.model.vehicle import Vehicle
from radmpc.records import dataclass
from radmpc.referee.loop import Loop

__all__ = ["FleetCommon", "fleet_common", "lasting_added", "lasting_means", "relative"]

_BLOCK = 4_000_000
"""Numbers in the largest array of one block of pairs: memory against the overhead per block."""

_NOTHING = 1e-13
"""Share of the sum of two variances below which what is left of it is rounding [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class FleetCommon:
    """All loops, padded with zeros to the longest state Q, under the normals of all R sources.

    Attributes
    ----------
    transitions : (N, S, Q, Q) array
        Of the closed loops at every step; one for all steps where S is 1.
    first : (N, Q, R) array
        What the first normals make of the loops at k = 0.
    pushes : (N, S, Q, R) array
        What those of every step add.
    picks, turns : (N, d, Q) array
        P, which picks the position, and P − G with what feedback held over a step makes of it.
    horizon : int
        Steps T.
    """

    transitions: Tensor
    first: Tensor
    pushes: Tensor
    picks: Tensor
    turns: Tensor
    horizon: int

    def at(self, arrays: Tensor, step: int) -> Tensor:
        """Return what holds at a step, (N, …).

        Parameters
        ----------
        arrays : (N, S, …) array
            Per vehicle and step; one for all steps where S is 1.
        step : int
            The step.
        """
        chosen: Tensor = arrays[:, min(step, arrays.shape[1] - 1)]
        return chosen

    def crossed(self, first: Indices, other: Indices) -> Tensor:
        """Return the covariances between two loops each at k = 0..T, (P, T+1, Q, Q).

        Parameters
        ----------
        first, other : (P,) int array
            The vehicles.
        """
        size = self.first.shape[1]
        found = np.empty((len(first), self.horizon + 1, size, size))
        found[:, 0] = self.first[first] @ _turned(self.first[other])
        for k in range(self.horizon):
            loops, pushes = self.at(self.transitions, k), self.at(self.pushes, k)
            moved = loops[first] @ found[:, k] @ _turned(loops[other])
            found[:, k + 1] = moved + pushes[first] @ _turned(pushes[other])
        return found

    def blocks(self, count: int) -> Iterator[slice]:
        """Yield so many pairs in blocks whose arrays stay small."""
        size = max(1, _BLOCK // ((self.horizon + 1) * self.first.shape[1] ** 2))
        for start in range(0, count, size):
            yield slice(start, start + size)

    def positions(self, first: Indices, other: Indices) -> tuple[Tensor, Tensor]:
        """Return covariances between positions, and between those that feedback bends.

        Parameters
        ----------
        first, other : (P,) int array
            The vehicles.

        Returns
        -------
        (P, T+1, d, d) and (P, T, d, d) array
            Of first with other [m²].
        """
        count, d = len(first), self.picks.shape[1]
        straight = np.empty((count, self.horizon + 1, d, d))
        bent = np.empty((count, self.horizon, d, d))
        for block in self.blocks(count):
            i, j = first[block], other[block]
            crossed = self.crossed(i, j)
            straight[block] = _between(self.picks[i], crossed, self.picks[j])
            bent[block] = _between(self.turns[i], crossed[:, :-1], self.turns[j])
        return straight, bent


def _between(mine: Tensor, crossed: Tensor, other: Tensor) -> Tensor:
    """Return covariances of parts of loops, (P, K, d, d)."""
    return np.asarray(mine[:, None] @ crossed @ _turned(other)[:, None])


def _turned(tensor: Tensor) -> Tensor:
    """Return transposes over the last two axes."""
    return np.swapaxes(tensor, -1, -2)


def relative(total: Tensor, crossed: Tensor) -> Tensor:
    """Return covariances of differences; where all but rounding cancels, no less than what may be.

    A disturbance that nearly all cancels hides noise of each one's own below the last digits: what
    is there is at most the share of both variances at which digits end, in any direction.

    Parameters
    ----------
    total : (..., d, d) array
        Sums of both covariances.
    crossed : (..., d, d) array
        Covariances between the two.
    """
    found = total - crossed - _turned(crossed)
    before, left = (np.trace(each, axis1=-2, axis2=-1) for each in (total, found))
    most = (_NOTHING * before)[..., None, None]
    return np.where(left[..., None, None] <= most, most * np.eye(total.shape[-1]), found)


def fleet_common(
    loops: Sequence[Loop], axes: Sequence[list[int]], bends: Sequence[Matrix | None], horizon: int
) -> FleetCommon | None:
    """Return what vehicles have in common, None where nothing.

    Parameters
    ----------
    loops : sequence of Loop
        Of all vehicles.
    axes : sequence of list of int
        Of each: where the position stands in the state.
    bends : sequence of ((d, q) array or None)
        ``B_p K`` of those whose path is bent by feedback.
    horizon : int
        Steps T.
    """
    widths: dict[str, int] = {}
    for loop in loops:
        if loop.common is not None:
            widths |= {name: c.stop - c.start for name, c in loop.common.columns.items()}
    if not widths:
        return None
    ends = np.cumsum([0, *widths.values()])
    places = {name: int(end) for name, end in zip(widths, ends, strict=False)}
    size = max(len(loop.initial) for loop in loops)
    steps = max(len(loop.transitions) for loop in loops)
    count, d = len(loops), len(axes[0])
    transitions = np.zeros((count, steps, size, size))
    first, pushes = np.zeros((count, size, ends[-1])), np.zeros((count, steps, size, ends[-1]))
    straight, turned = np.zeros((2, count, d, size))
    for i, (loop, place, bend) in enumerate(zip(loops, axes, bends, strict=True)):
        q = len(loop.initial)
        pick = np.eye(q)[place]
        transitions[i, :, :q, :q] = loop.transitions
        straight[i, :, :q] = pick
        turned[i, :, :q] = pick if bend is None else pick - bend
        common = loop.common
        if common is None:
            continue
        for name, columns in common.columns.items():
            there = slice(places[name], places[name] + widths[name])
            first[i, :q, there] = common.first[:, columns]
            pushes[i, :, :q, there] = common.pushes[:, :, columns]
    return FleetCommon(transitions, first, pushes, straight, turned, horizon)


def lasting_means(vehicle: Vehicle, horizon: int) -> Matrix | None:
    """Return what is expected over each step of disturbances that last, None where nothing.

    Parameters
    ----------
    vehicle : Vehicle
        With what is known of it at k = 0.
    horizon : int
        Number of steps T.

    Returns
    -------
    (T+1, n + s) array or None
        Of its own disturbance, and of those it shares and that last, stacked.
    """
    parts = [part for part in vehicle.shared if part.correlation > 0.0]
    rho, known = vehicle.disturbance_correlation, vehicle.belief
    if known is None or not (rho > 0.0 or parts):
        return None
    shared = np.zeros(0) if known.lasting is None else known.lasting
    means = [np.concatenate([known.disturbance, shared])]
    keeps = np.repeat(
        [rho, *(part.correlation for part in parts)],
        [known.disturbance.size, *(part.size for part in parts)],
    )
    for _ in range(horizon):
        means.append(keeps * means[-1])
    return np.array(means)


def lasting_added(vehicle: Vehicle, lasting: Vector) -> Vector:
    """Return what disturbances that last add to a state, (n,).

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    lasting : (n + s,) array
        Its own disturbance, and those it shares and that last.
    """
    start = vehicle.start.size
    added = lasting[:start]
    for part in vehicle.shared:
        if part.correlation > 0.0:
            added = added + part.matrix @ lasting[start : start + part.size]
            start += part.size
    return added
