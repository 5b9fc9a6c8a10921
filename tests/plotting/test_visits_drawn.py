from __future__ import annotations

from dataclasses import replace

import numpy as np

from radmpc import Goal, Scenario, Visit, plot_scenario
from radmpc.console.reports.visiting import arrivals_text, visits_text
from radmpc.experiments.families import paper
from radmpc.model.plan import Plan, Risk, Status, Trajectory
from radmpc.plotting import animate_plan, plot_plan

from .conftest import HORIZON, make_plan, make_vehicle


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


def touring() -> Scenario:
    """A vehicle that visits two boxes beside its way, and one that visits none."""
    via = (Visit.at([3.0, 4.0], 0.5), Visit.at([6.0, 7.0], 0.5))
    visiting = replace(make_vehicle("a", [1.0, 1.0], [9.0, 9.0]), via=via)
    fleet = [visiting, make_vehicle("b", [1.0, 9.0], [9.0, 2.0])]
    return Scenario("tour", 1.0, HORIZON, 0.05, fleet)


def test_numbers_of_visits_are_framed_and_those_of_steps_are_not() -> None:
    scenario = touring()
    name = scenario.vehicles[0].name
    numbers = {}
    for ax in (plot_scenario(scenario), plot_plan(make_plan(scenario))):
        numbers = {t.get_gid(): t for t in ax.texts if t.get_gid()}
        for j in (1, 2):
            number = numbers[f"visit-number:{name}:{j}"]
            assert number.get_text() == str(j)
            assert number.get_bbox_patch() is not None
    steps = [text for gid, text in numbers.items() if gid.startswith("step:")]
    assert steps
    assert all(text.get_bbox_patch() is None for text in steps)


def test_numbers_of_visits_stand_beside_their_boxes_and_on_no_other_text() -> None:
    ax = plot_plan(make_plan(touring()))
    ax.figure.draw_without_rendering()
    numbers = [t for t in ax.texts if str(t.get_gid()).startswith("visit-number:")]
    others = [t for t in ax.texts if t.get_gid() and t not in numbers]
    boxes = [p for p in ax.patches if str(p.get_gid()).startswith("visit ")]
    assert len(numbers) == len(boxes) == 2
    for number, box in zip(numbers, boxes, strict=True):
        place = number.get_bbox_patch().get_window_extent()
        assert not place.overlaps(box.get_window_extent().shrunk(0.5, 0.5))
        assert not any(place.overlaps(text.get_window_extent()) for text in others)


def test_the_legend_draws_a_visit_with_the_dashes_of_its_box() -> None:
    plan = make_plan(touring())
    film = animate_plan(plan, frames_per_step=1)
    film._draw_was_started = True
    for ax in (plot_plan(plan), film._fig.axes[0]):
        [box] = [p for p in ax.patches if str(p.get_gid()).startswith("visit 1:")]
        legend = ax.get_legend()
        told = [text.get_text() for text in legend.get_texts()]
        sign = legend.legend_handles[told.index("visit, no. ①")]
        # Signs in a legend take over how dashes are drawn, not what they are called.
        assert sign._dash_pattern == box._dash_pattern
        assert sign._dash_pattern[1] is not None
        assert sign.get_facecolor()[3] == 0.0


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
