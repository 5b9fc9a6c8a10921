"""Parts of missions that other tools solve alone: assignment, and survey lines.

    python -m benchmarks.peers.missions

Goals of random fleets are assigned here and by OR-Tools (`pip install ortools`; else left out),
whose solver takes whole numbers: costs are those, up to a million. Survey lines are held against
the rule of QGroundControl's survey (`SurveyComplexItem.cc`, told in its source): lines at the
spacing that is asked for, from three quarters of the diagonal beside the middle of the bounding box
on, written anew here with shapely.
"""

from __future__ import annotations

import numpy as np
import shapely
from scipy.optimize import linear_sum_assignment

from radmpc.model.survey import survey_visits

CASES, SPACING = 100, 6.0


def assignments(rng: np.random.Generator) -> str:
    """Return how often the cheapest assignments cost the same."""
    try:
        from ortools.graph.python import linear_sum_assignment as peer  # noqa: PLC0415 - a peer
    except ImportError:
        return "OR-Tools is not installed"
    alike = 0
    for _ in range(CASES):
        count = int(rng.integers(2, 60))
        costs = rng.integers(0, 1_000_000, (count, count))
        solver = peer.SimpleLinearSumAssignment()
        rows, columns = np.indices(costs.shape)
        solver.add_arcs_with_cost(rows.ravel(), columns.ravel(), costs.ravel())
        assert solver.solve() == solver.OPTIMAL
        alike += solver.optimal_cost() == int(costs[linear_sum_assignment(costs)].sum())
    return f"{alike} of {CASES} random matrices cost the same as with OR-Tools"


def convex_area(rng: np.random.Generator) -> np.ndarray:
    """Return the corners of a random convex area some 60 m wide."""
    hull = shapely.MultiPoint(rng.normal(0.0, 20.0, (12, 2))).convex_hull
    return np.asarray(hull.exterior.coords)[:-1]


def ground_station_lines(corners: np.ndarray) -> list[shapely.Geometry]:
    """Return what lines along x at the spacing have in common with an area."""
    low, high = corners.min(axis=0), corners.max(axis=0)
    middle, reach = 0.5 * (low + high), 0.75 * float(np.linalg.norm(high - low))
    heights = np.arange(middle[1] - reach, middle[1] + reach, SPACING)
    area = shapely.Polygon(corners)
    ends = (middle[0] - reach, middle[0] + reach)
    cut = [area.intersection(shapely.LineString([(x, y) for x in ends])) for y in heights]
    return [piece for piece in cut if piece.length > 0.0]


def own_lines(corners: np.ndarray) -> list[shapely.Geometry]:
    """Return the same of a survey of visits."""
    ends = [visit.center for visit in survey_visits(corners, SPACING)]
    return [shapely.LineString(pair) for pair in zip(ends[::2], ends[1::2], strict=True)]


def left_out(corners: np.ndarray, lines: list[shapely.Geometry]) -> float:
    """Return the share of an area more than half the spacing beside the nearest line [-]."""
    area = shapely.Polygon(corners)
    low, high = corners.min(axis=0), corners.max(axis=0)
    half = 0.5 * SPACING * (1.0 + 1e-9)
    strips = [
        shapely.box(low[0], y - half, high[0], y + half) for y in (_height(one) for one in lines)
    ]
    return float((area - shapely.union_all(strips)).area / area.area)


def _height(line: shapely.Geometry) -> float:
    """Return where a line along x lies."""
    return float(line.centroid.y)


def surveys(rng: np.random.Generator) -> str:
    """Return lines, their length and what they leave out, on average, of both."""
    told = []
    areas = [convex_area(rng) for _ in range(CASES)]
    for name, rule in (("here", own_lines), ("QGroundControl's rule", ground_station_lines)):
        found = [rule(corners) for corners in areas]
        lines = np.mean([len(one) for one in found])
        length = np.mean([sum(line.length for line in one) for one in found])
        lost = [left_out(corners, one) for corners, one in zip(areas, found, strict=True)]
        some = np.mean(np.array(lost) > 1e-9)
        told.append(
            f"{name}: {lines:.2f} lines, {length:.1f} m, "
            f"{some:.0%} of areas not all seen, at worst {max(lost):.1%} of one"
        )
    return "\n".join(told)


def main() -> None:
    """Print both."""
    print(assignments(np.random.default_rng(0)))
    print(surveys(np.random.default_rng(1)))


if __name__ == "__main__":
    main()
