"""What half-spaces ask for, and what it costs to keep less: fixed margins, or the price of risk."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.gaussian import GAUSSIAN, Tail, tail_probability
from radmpc.program.hazards import Hazards
from radmpc.records import dataclass

__all__ = ["Margins", "cheapest_meter", "far_of", "fixed_margins", "priced_margins"]

_LADDER = (8.0, 6.5, 5.6, 5.0, 4.6, 4.2, 3.7, 3.3, 3.0, 2.7, 2.4, 2.1, 1.8, 1.4, 0.9, 0.0)
"""Clearances between which the risk of a row is interpolated [standard deviations]: its
chords lie above it by up to 4 % between 1.8 and 4."""

_LEAST = 1e-7
"""Risk at the ladder's highest rung where tails fall slowly [-]."""

_DEAREST = 1e100
"""Cost of a unit of probability at most: beyond, products and squares of it leave the range of
floats, and what is given up for less is the same."""

_AROUND = (2.0, 1.0, 0.0, -1.0, -2.0)
"""Clearances added around that of the latest path [spacings]."""


def far_of(tail: Tail, gaussian: float) -> float:
    """Return the clearance beyond which nothing is compared.

    Parameters
    ----------
    tail : Tail
        Of what everything deviates by.
    gaussian : float
        Where the tail is Gaussian [standard deviations].
    """
    return gaussian if tail.is_gaussian else max(gaussian, float(tail.clearance_for(_LEAST)))


def cheapest_meter(hazards: Hazards) -> float:
    """Return what a meter at the goal costs the vehicle that moves with least effort.

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    """
    found = []
    for model in hazards.models:
        furthest = float(np.abs(model.position[-1]).max(initial=0.0))
        if furthest > 0.0:
            found.append(model.vehicle.cost_weight / furthest)
    return max(found, default=1.0) or 1.0


def _rungs(tail: Tail) -> Vector:
    """Return the ladder: of equal risks under any tail, as far as they are worth it."""
    rungs = np.array(_LADDER)
    if tail.is_gaussian:
        return rungs
    return tail.clearance_for(np.maximum(tail_probability(rungs), _LEAST))


@dataclass(frozen=True, slots=True, eq=False)
class Margins:
    """How far each end of each half-space is to be kept, and what keeping less costs.

    Attributes
    ----------
    distances : (w, 2) array
        Room beyond the half-spaces' offsets that is asked for [m].
    lengths : (w, 2, m) array
        Parts of it that may be given up, the cheapest first [m].
    prices : (w, 2, m) array
        Cost per meter of each.
    risks : (w, 2, m) array
        Probability per meter of each [1/m].
    penalty : float
        Cost per meter of what is missed beyond them.
    """

    distances: Matrix
    lengths: Tensor
    prices: Tensor
    risks: Tensor
    penalty: float

    @property
    def num_columns(self) -> int:
        """Columns per end: one for each part, and one for what is missed beyond them."""
        return int(self.lengths.shape[2]) + 1

    def of(self, chosen: npt.NDArray[np.bool_]) -> Margins:
        """Return those of some half-spaces, (w,) bool array."""
        distances, lengths = self.distances[chosen], self.lengths[chosen]
        return Margins(distances, lengths, self.prices[chosen], self.risks[chosen], self.penalty)

    def costs(self, spaces: Indices, ends: Indices, given_up: Vector) -> Vector:
        """Return what it costs to give up lengths.

        Parameters
        ----------
        spaces, ends : (r,) int array
            Half-spaces, and at which end of each.
        given_up : (r,) array
            The lengths [m].

        Returns
        -------
        (r,) array
            The cheapest parts first, and what is missed beyond them.
        """
        lengths, prices = self.lengths[spaces, ends], self.prices[spaces, ends]
        before = np.cumsum(lengths, axis=1) - lengths
        parts = np.clip(given_up[:, None] - before, 0.0, lengths)
        rest = given_up - parts.sum(axis=1)
        return np.asarray((parts * prices).sum(axis=1) + self.penalty * np.maximum(rest, 0.0))

    def given_up(self, values: Vector, ends: int) -> tuple[float, float]:
        """Return what is missed in all beyond the parts [m], and the risk of those given up [-].

        Parameters
        ----------
        values : array
            Lengths given up, those of the last ends of each half-space in order first [m].
        ends : int
            How many ends have columns [-].
        """
        shape = (self.distances.shape[0], ends, self.num_columns)
        lengths = values[: int(np.prod(shape))].reshape(shape)
        risk = float(np.sum(lengths[:, :, :-1] * self.risks[:, 2 - ends :]))
        return float(lengths[:, :, -1].sum()), risk


def fixed_margins(deviations: Matrix, clearance: float, penalty: float) -> Margins:
    """Ask for the same clearance everywhere.

    Parameters
    ----------
    deviations : (w, 2) array
        Standard deviations along the half-spaces [m].
    clearance : float
        Standard deviations to keep [-].
    penalty : float
        Cost of missing it by a meter.
    """
    none = np.zeros((*deviations.shape, 0))
    return Margins(clearance * deviations, none, none, none, penalty)


def priced_margins(
    deviations: Matrix,
    latest: Matrix,
    costs: tuple[float, float],
    spacing: float,
    tail: Tail = GAUSSIAN,
) -> Margins:
    """Let each end keep what the price of its risk is worth.

    Between clearances of a ladder, finer around the latest, the risk is interpolated: never less
    than it is. What costs least effort and priced risk is a linear program without further rows.

    Parameters
    ----------
    deviations : (w, 2) array
        Standard deviations along the half-spaces [m].
    latest : (w, 2) array
        Clearances that the latest paths keep [standard deviations].
    costs : tuple of float
        Cost of a unit of probability, and least cost of missing a half-space itself by a meter.
    spacing : float
        Between the clearances around the latest [standard deviations].
    tail : Tail
        Of what half-spaces deviate by.
    """
    rungs = _rungs(tail)
    price, penalty = costs
    ladder = np.broadcast_to(rungs, (*deviations.shape, len(rungs)))
    around = np.clip(latest[..., None] + spacing * np.array(_AROUND), 0.0, rungs[0])
    # Those of the ladder are the same everywhere, and Student's tails take a quarter microsecond.
    on_ladder = np.broadcast_to(tail.probability(rungs), ladder.shape)
    levels = np.concatenate([ladder, around], axis=2)
    tails = np.concatenate([on_ladder, tail.probability(around)], axis=2)
    order = np.argsort(-levels, axis=2)
    levels, tails = (np.take_along_axis(each, order, axis=2) for each in (levels, tails))
    lengths = -np.diff(levels, axis=2) * deviations[..., None]
    steps: Vector = np.diff(tails, axis=2)
    risks = np.where(lengths > 0.0, steps / np.where(lengths > 0.0, lengths, 1.0), 0.0)
    prices = min(price, _DEAREST) * risks
    penalty = max(penalty, float(prices.max(initial=0.0)))
    return Margins(rungs[0] * deviations, lengths, prices, risks, penalty)
