from __future__ import annotations

from dataclasses import replace

import numpy as np

from radmpc import Goal, Visit, plot_scenario
from radmpc.console.reports.visiting import arrivals_text, visits_text
from radmpc.experiments.families import paper
from radmpc.model.plan import Plan, Risk, Status, Trajectory


def test_boxes_to_be_visited_are_drawn_and_within_the_picture() -> None:
    given = paper(2, 0)
    far = Visit.at([60.0, 70.0], 1.5)
    visiting = replace(given.vehicles[0], via=(Visit.at([3.0, 4.0], 0.5), far))
    axes = plot_scenario(replace(given, vehicles=(visiting, given.vehicles[1]), workspace=None))
    boxes = {p.get_gid(): p for p in axes.patches if str(p.get_gid()).startswith("visit ")}
    assert sorted(boxes) == [f"visit {j}:{visiting.name}" for j in (1, 2)]
    assert boxes[f"visit 2:{visiting.name}"].get_bbox().bounds == (58.5, 68.5, 3.0, 3.0)
    assert axes.get_xlim()[1] > 61.5
    assert axes.get_ylim()[1] > 71.5


def test_the_report_tells_when_visits_are_made_and_which_are_not() -> None:
    given = paper(1, 0)
    vehicle, horizon = given.vehicles[0], given.horizon
    states = np.zeros((horizon + 1, 4))
    states[:, 0] = np.arange(horizon + 1.0)

    def told(*via: Visit, within: tuple[int, int] | None = None) -> tuple[str, str]:
        goal = Goal.at([horizon, 0.0], 1.5, 0.0, within)
        visiting = replace(vehicle, via=via, goal=goal)
        scenario = replace(given, vehicles=(visiting,), workspace=None)
        covariances = vehicle.covariances(horizon)
        path = Trajectory(vehicle.name, np.zeros((horizon, 2)), states, covariances, vehicle.gain)
        made = Plan(
            scenario, "by hand", None, Status.FEASIBLE, 0.0, None, Risk(0.05), ((vehicle.name,),),
            trajectories=(path,),
        )  # fmt: skip
        return visits_text(made), arrivals_text(made)

    assert told() == ("", "")
    here, there = Visit.at([2.0, 0.0], 0.1), Visit.at([4.0, 9.0], 0.1)
    assert told(here)[0] == f"{vehicle.name} at step 2 ({2 * given.dt:g} s)"
    assert told(here, there)[0] == f"{vehicle.name} at step 2 ({2 * given.dt:g} s), 1 not made"
    last = horizon - 1
    when = f"{vehicle.name} at step {last} ({last * given.dt:g} s)"
    assert told(within=(1, horizon))[1] == when
    assert told(within=(1, 2))[1] == f"{vehicle.name} late"
