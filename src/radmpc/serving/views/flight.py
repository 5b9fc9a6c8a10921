"""Ticks of a flight."""

from __future__ import annotations

import numpy as np

from radmpc.io.flight.record import TickRow
from radmpc.model.scenario import Scenario
from radmpc.serving.protocol import TickView
from radmpc.serving.views.numbers import Rounding, extent_of

__all__ = ["tick_view"]

_ROUNDING = 1e-4
"""Part of Δ that five digits round off, and the account's margins [-]."""


def tick_view(row: TickRow, scenario: Scenario, risk_bound: float) -> TickView:
    """Return a tick as the page shows it.

    Parameters
    ----------
    row : TickRow
        As its file has it.
    scenario : Scenario
        What is flown.
    risk_bound : float
        Δ at the start [-].

    Returns
    -------
    TickView
        Empty states where nothing was measured. What is left is what the account holds, the
        conditional risk of what is flown and the unallocated risk; a lucky moment gives some back,
        a push may lift it above Δ, and rounding never does.
    """
    rounding = Rounding.of(*extent_of(scenario))
    left = float(f"{row.tail + row.bank:.5g}")
    if left > risk_bound >= (1.0 - _ROUNDING) * left:
        left = risk_bound  # above it by what sums and digits round off alone
    states = [rounding.point(np.asarray(state)) for state in row.states or ()]
    hits = [
        f"{t.vehicle} {'loses' if t.cause == 'range' else 'hits'} {t.other or 'the border'}"
        for t in row.contacts
    ]
    alarms = [*hits, *row.alarms]
    return {
        "step": row.step,
        "states": states,
        "left": left,
        "spent": float(f"{max(risk_bound - left, 0.0):.5g}"),
        "decision": row.reason,
        "isReplan": row.leg is not None,
        "milliseconds": round(1e3 * row.seconds, 2),
        "alarm": "; ".join(alarms) or None,
    }
