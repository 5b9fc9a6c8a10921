"""Sixty-four vehicles and who has to know of whom.

Most vehicles of a large fleet never meet, and a plan need not pretend they do. Everybody is
planned alone at first; those who would then collide are planned together, and the coupling graph
shows the sets that come of it. The number is the effort of the fleet relative to that of all its
vehicles alone among the obstacles: company costs one percent.
"""

from pathlib import Path

from matplotlib.figure import Figure

import radmpc
from radmpc.experiments.families import fleet

EXPECTED = 1.010
TOLERANCE = 0.003  # the planner proves its plans optimal within 0.1 %


def effort(plan: radmpc.Plan) -> float:
    """Return the cost of a plan; a record without one has none."""
    assert plan.cost is not None
    return plan.cost


def main(out: Path) -> float:
    """Plan the fleet and everybody alone, draw, and return the ratio of efforts."""
    scenario = fleet(64, seed=1)
    plan = radmpc.plan(scenario, rng=0).require()
    print(f"{len(plan.sets)} sets, the largest of {max(map(len, plan.sets))} vehicles")

    figure = Figure(figsize=(3.5, 6.2), dpi=200, layout="constrained")
    upper, lower = figure.subplots(2, 1, height_ratios=[3, 2])
    radmpc.plot_plan(plan, upper, details=False)
    radmpc.plot_couplings(plan, lower)
    figure.savefig(out / "09_fleet.png")

    share = scenario.risk_bound / scenario.num_vehicles
    alone = [scenario.subset((i,), share) for i in range(scenario.num_vehicles)]
    return effort(plan) / sum(effort(radmpc.plan(one).require()) for one in alone)


if __name__ == "__main__":
    print("effort relative to everybody alone:", main(Path()))
