"""Where things lie in a program, noted by whoever builds it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Indices
from radmpc.model.scenario import Scenario
from radmpc.program.avoidance import Part
from radmpc.records import dataclass

__all__ = ["ProgramLayout", "laid_out", "owners_of_runs"]


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
