"""Single vehicles planned again, visits at other steps, while all others stay."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.program.condensed import CondensedModel

__all__ = ["Counts", "OneByOne"]

_LITTLE = 1e-7
"""What half-spaces may be missed by in all [m]."""

Counts = npt.NDArray[np.bool_]
"""Who counts in which windows, (N+1, T); last, whether obstacles and borders do."""


class OneByOne(SuccessiveLp):
    """The latest paths of a fleet whose vehicles are planned one by one."""

    def make_visits(self, vehicle: int, model: CondensedModel) -> None:
        """Have a vehicle make its visits at other steps.

        Parameters
        ----------
        vehicle : int
            Its number.
        model : CondensedModel
            The vehicle with its visits at these steps.
        """
        models = list(self.hazards.models)
        models[vehicle] = model
        self.hazards = replace(self.hazards, models=tuple(models))
        self._programs = {g: known for g, known in self._programs.items() if vehicle not in g}
        self.missed[vehicle] = np.inf

    def keep_clear(
        self,
        vehicle: int,
        clearance: float,
        tries: tuple[int, float],
        counts: Counts,
    ) -> float:
        """Plan one vehicle again and again until it keeps a clearance; all others stay.

        Parameters
        ----------
        vehicle : int
            Its number.
        clearance : float
            Standard deviations that it keeps [-].
        tries : tuple of int and float
            Times that it is planned at most [-], and the first penalty as in `keep_apart`.
        counts : (N+1, T) bool array
            Of whom it keeps clear in which windows.

        Returns
        -------
        float
            How far half-spaces are missed [m]; inf where it does not reach its goal at all.
        """
        rounds, penalty = tries
        self.missed[vehicle], least = np.inf, np.inf
        for _ in range(rounds):
            self.plan_alone(vehicle, clearance, penalty, counts)
            missed = float(self.missed[vehicle])
            if missed <= _LITTLE or not missed < TUNING.stuck_at * least:
                break
            least = missed
            penalty = min(TUNING.penalty_growth * penalty, TUNING.last_penalty)
        return float(self.missed[vehicle])
