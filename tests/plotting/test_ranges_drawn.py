from __future__ import annotations

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np

from radmpc import Goal, Keep, LedgerRow, Plan, Scenario, Vehicle, double_integrator
from radmpc.planning import plan
from radmpc.plotting import plot_distances, plot_ledger
from radmpc.plotting.clearances import closest_clearances


def hovering() -> Plan:
    """Return a plan of two that stand 3 m apart and keep a range of 4 m."""
    fleet = [
        Vehicle(
            name=name, system=double_integrator(1.0, 2), start=[x, 0], goal=Goal.at([x, 0.0], 0.1),
            radius=0.5, control_limit=1.0, initial_covariance=0.01, disturbance_covariance=0.0,
        )
        for name, x in (("a", 0.0), ("b", 3.0))
    ]  # fmt: skip
    given = Scenario("ranges", 1.0, 2, 0.1, fleet, avoidance="steps", keep=[Keep(["a", "b"], 4.0)])
    return plan(given, "dlp").require()


def test_what_is_left_of_a_range_is_drawn_beside_distances() -> None:
    planned = hovering()
    found = {one.name: one for one in closest_clearances(planned, 5)}
    np.testing.assert_allclose(found["a – b"].distance, 2.0, atol=1e-3)
    np.testing.assert_allclose(found["a – b, range"].distance, 1.0, atol=1e-3)
    axes = plot_distances(planned)
    assert axes.get_ylabel() == "distance of hulls, left of ranges [m]"
    plt.close("all")


def test_ledgers_have_a_color_for_ranges() -> None:
    planned = hovering()
    row = LedgerRow("range", "a", "b", 1, 0.05)
    risk = replace(planned.risk, certified=0.05, ledger=(row,))
    figure = plot_ledger(replace(planned, risk=risk))
    told = [text.get_text() for text in figure.findobj(plt.Text)]
    assert "half of ranges" in told
    assert "a – b, range" in told
    plt.close("all")
