"""A vehicle that cannot keep its pace gets another, and never a worse one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from grid_worlds import cells

from radmpc.arrays import Matrix
from radmpc.planners.certified.turned.narrow.at_pace import keep_places
from radmpc.planners.certified.turned.narrow.clear import Clear
from radmpc.planners.certified.turned.narrow.mending import mended
from radmpc.planners.certified.turned.narrow.routes import shortest_routes
from radmpc.planners.certified.turned.paths import timed
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.solvers.solution import Limits

CLEARANCE = 3.0


def hurried(path: Path, end: float) -> tuple[SuccessiveLp, Matrix]:
    """One robot around a bend that is to be at its goal after a share of the horizon."""
    free = {(x, y) for x in (0, 6) for y in range(4)} | {(x, 3) for x in range(7)}
    scenario = cells(path, (7, 4), free, [((0, 0), (6, 0))])
    hazards = Hazards.of(scenario, condensed_models(scenario))
    clear = Clear.of(hazards)
    assert clear is not None
    places = timed(shortest_routes(hazards, clear, CLEARANCE)[0][0], hazards.horizon, 0.0, end)
    successive = SuccessiveLp(hazards, Limits())
    assert successive.begin_alone()
    successive.refer(0, places)
    return successive, places[None]


@pytest.mark.parametrize("end", [0.6, 0.7])
def test_a_pace_that_controls_just_miss_is_exchanged_for_one_that_they_keep(
    end: float, tmp_path: Path
) -> None:
    successive, places = hurried(tmp_path, end)
    assert not keep_places(successive, CLEARANCE, 16, TUNING.paced_penalty, Limits())
    missed = float(successive.missed[0])
    assert missed > 1e-3
    assert mended(successive, places, CLEARANCE, np.random.default_rng(0), Limits())
    model = successive.hazards.models[0]
    assert successive.paths.means[0] == pytest.approx(model.path(successive.paths.controls[0]))


def test_where_time_is_up_the_vehicle_stays_on_its_path(tmp_path: Path) -> None:
    successive, places = hurried(tmp_path, 0.4)
    keep_places(successive, CLEARANCE, 16, TUNING.paced_penalty, Limits())
    before = successive.paths.means.copy()
    stopped = Limits(np.inf, lambda: True)
    assert not mended(successive, places, CLEARANCE, np.random.default_rng(0), stopped)
    assert successive.paths.means == pytest.approx(before)


def test_where_many_miss_something_nobody_is_planned_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    successive, places = hurried(tmp_path, 0.4)
    monkeypatch.setattr(SuccessiveLp, "plan_alone", lambda *_: pytest.fail("planned"))
    successive.missed = np.ones(20)
    assert not mended(
        successive, np.repeat(places, 20, axis=0), CLEARANCE, np.random.default_rng(0), Limits()
    )
