"""Where things lie in a program and what they stand for, noted while it is built."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from radmpc.arrays import Indices
from radmpc.model.plan import Cause
from radmpc.model.scenario import Scenario
from radmpc.program.avoidance import Part, RowBlock
from radmpc.records import dataclass

__all__ = [
    "Label",
    "ProgramLayout",
    "RiskItem",
    "RiskItems",
    "laid_out",
    "owners_of_runs",
    "risk_items_of",
]


class RiskItem(NamedTuple):
    """One thing that may happen at one step: the unit in which risk is allocated and charged.

    Attributes
    ----------
    cause : {'obstacle', 'pair', 'workspace', 'range', 'visit'}
        What may happen; a visit does without risk.
    vehicle : str
        The vehicle that is at risk.
    other : str or None
        The obstacle or the other vehicle; which visit.
    step : int
        Absolute step 0..T.
    """

    cause: Cause | Literal["visit"]
    vehicle: str
    other: str | None
    step: int


Label = tuple[Cause | Literal["visit"], str, tuple[str | None, ...]]
"""Cause, vehicle and obstacles or partners: one of these per thing to avoid of a block."""


@dataclass(frozen=True, slots=True, eq=False)
class ProgramLayout:
    """What the arrays of a program stand for.

    A restriction to some vehicles keeps the numbers of outputs and vehicles, and thus its layout
    but for the owners.

    Attributes
    ----------
    horizon : int
        Steps of the program T.
    dimension : int
        Axes d of the positions.
    intervals : bool
        Whether window j is the interval [j, j+1], or step j+1 alone.
    first_step : int
        Absolute step at which the program starts.
    positions : tuple of slice
        The outputs that are the mean positions of each vehicle, (T+1)·d of them: step by step,
        axes fastest.
    controls : tuple of slice
        The outputs that are the controls of each vehicle, 2·T·m of them: u⁺ step by step, axes
        fastest, then u⁻.
    owners : (a,) int array
        The avoidance that each alternative belongs to.
    """

    horizon: int
    dimension: int
    intervals: bool
    first_step: int
    positions: tuple[slice, ...]
    controls: tuple[slice, ...]
    owners: Indices

    def window_of(self, step: int) -> int:
        """Return the window of an avoidance from its absolute step."""
        return step - self.first_step - (0 if self.intervals else 1)


def laid_out(
    parts: Sequence[Part], scenario: Scenario, first_step: int, starts: Indices
) -> ProgramLayout:
    """Return where things lie in a program.

    Parameters
    ----------
    parts : sequence of Part
        Each vehicle's place among the outputs.
    scenario : Scenario
        Theirs.
    first_step : int
        As in `ProgramLayout`.
    starts : (v+1,) int array
        Where the alternatives of each avoidance start.
    """
    horizon, d = len(parts[0].control_bounds), scenario.dimension
    return ProgramLayout(
        horizon=horizon,
        dimension=d,
        intervals=scenario.avoidance == "intervals",
        first_step=first_step,
        positions=tuple(slice(p.position, p.position + d * (horizon + 1)) for p in parts),
        controls=tuple(slice(p.controls, p.controls + 2 * p.control_bounds.size) for p in parts),
        owners=owners_of_runs(starts),
    )


def owners_of_runs(starts: Indices) -> Indices:
    """Return the number of the run that each member belongs to, from where the runs start."""
    return np.repeat(np.arange(starts.size - 1), np.diff(starts))


@dataclass(frozen=True, slots=True, eq=False)
class RiskItems:
    """Those of a block of rows.

    Attributes
    ----------
    risk_items : list of RiskItem
        Different ones, by thing and step.
    numbers : (e,) int array
        The item of each event, counted from 0.
    avoidances : list of RiskItem
        Those of the windows that ask for a choice.
    """

    risk_items: list[RiskItem]
    numbers: Indices
    avoidances: list[RiskItem]


def risk_items_of(block: RowBlock, label: Label, steps: tuple[int, int]) -> RiskItems:
    """Return the risk items of a block of rows.

    Parameters
    ----------
    block : RowBlock
        The rows.
    label : tuple
        What may happen there.
    steps : tuple of int
        Absolute steps of the first event and of the first window.
    """
    cause, vehicle, others = label
    first_step, first_window = steps
    span = int(block.event_steps.max(initial=0)) + 1
    at, windows = block.event_steps, block.avoidance_windows
    of_events, of_windows = block.event_things, block.avoidance_things
    of_events = np.zeros_like(at) if of_events is None else of_events
    of_windows = np.zeros_like(windows) if of_windows is None else of_windows
    keys, numbers = _numbered(of_events * span + at)
    items = [
        RiskItem(cause, vehicle, others[key // span], first_step + key % span)
        for key in keys.tolist()
    ]
    avoidances = [
        RiskItem(cause, vehicle, others[thing], first_window + window)
        for thing, window in zip(of_windows.tolist(), windows.tolist(), strict=True)
    ]
    return RiskItems(items, numbers, avoidances)


def _numbered(keys: Indices) -> tuple[Indices, Indices]:
    """Return different keys, ascending, and the number of every key given among them."""
    if np.all(keys[1:] > keys[:-1]):
        # One event per step, as of most things to avoid.
        return keys, np.arange(keys.size)
    different, numbers = np.unique(keys, return_inverse=True)
    return different, numbers
