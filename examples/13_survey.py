"""A survey past traffic, with a current.

Three boats share an area: each runs two lines of its own, to and fro, with every end of a line
due within two steps, while a current of a quarter of a meter per second sets across and a
freighter comes through on a track that is known but for its noise. An echo sounder sees 4 m to
each side. The number is the share of the area that is seen: the boat that gives way misses some.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import shapely  # type: ignore[import-untyped] # it has no types
from matplotlib.figure import Figure

import radmpc

EXPECTED, TOLERANCE = 0.948, 0.01  # plans are made to a gap of 0.1 %

AREA = [[0, 0], [40, 0], [46, 48], [4, 48]]
SPACING, DT, LEG, HORIZON = 8.0, 5.0, 4, 20
SYSTEM = radmpc.double_integrator(DT, dimension=2)


def boat(index: int) -> radmpc.Vehicle:
    """Return a boat with every third of the area, from south to north."""
    strip = shapely.Polygon(AREA) & shapely.box(-9, 16 * index, 99, 16 * index + 16)
    lines = radmpc.survey_visits(np.array(strip.exterior.coords)[:-1], SPACING, half_width=0.5)
    due = [3 + LEG * k for k in range(len(lines))]
    via = [replace(v, between=(k, k + 1)) for v, k in zip(lines, due, strict=True)]
    ends = [-8.0, 16 * index + 4.0], radmpc.Goal.at([-8, 16 * index + 12], 1)
    return radmpc.Vehicle(
        f"boat {index + 1}", SYSTEM, *ends, radius=1.0, control_limit=0.6,
        initial_covariance=[0.02, 0.02, 1e-4, 1e-4],
        disturbance_covariance=[0.01, 0.01, 1e-4, 1e-4], drift=[0.15 * DT, -0.2 * DT, 0, 0],
        gain=radmpc.lqr_gain(SYSTEM, np.diag([1.0, 1.0, 25.0, 25.0]), 100.0 * np.eye(2)), via=via,
    )  # fmt: skip


def main(out: Path) -> float:
    """Plan, draw, and return the share of the area that is seen."""
    hull, track = [[-3, -8], [3, -8], [3, 8], [-3, 8]], [20.0, 95.0, 0.0, -0.9]
    freighter = radmpc.Obstacle.tracked("freighter", hull, track, [0.5, 0.5, 1e-4, 1e-4])
    boats = [boat(index) for index in range(3)]
    scenario = radmpc.Scenario("survey", DT, HORIZON, 0.01, boats, [freighter])
    plan = radmpc.plan(scenario, rng=0).require()
    figure = Figure(figsize=(5, 5), dpi=180, layout="constrained")
    radmpc.plot_plan(plan, figure.add_subplot())
    figure.savefig(out / "13_survey.png")
    paths = [part.means[3:-2, :2] for part in plan.trajectories]  # from the first line to the last
    seen = shapely.union_all([shapely.LineString(p).buffer(SPACING / 2 + 0.5) for p in paths])
    area = shapely.Polygon(AREA)
    return float((area & seen).area / area.area)


if __name__ == "__main__":
    print("share of the area that is seen:", main(Path()))
