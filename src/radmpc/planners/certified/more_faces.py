"""The same scenario with more faces, where the given ones leave no plan."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from radmpc.arrays import Matrix
from radmpc.geometry import Polytope
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.infeasible.tuning import TUNING
from radmpc.planners.wording import listed
from radmpc.records import dataclass, replace

__all__ = ["Finer", "faces_text", "finer_scenarios"]


@dataclass(frozen=True, slots=True, eq=False)
class Finer:
    """A scenario with more faces.

    Attributes
    ----------
    scenario : Scenario
        What a plan of it risks is no less than in the one it was made from.
    pair_faces : int or None
        Faces it has around pairs; None where no others than given ones are tried.
    corner_angle : float or None
        Angle between faces at the corners of obstacles, at most [°]; None likewise.
    """

    scenario: Scenario
    pair_faces: int | None
    corner_angle: float | None

    @property
    def text(self) -> str:
        """The faces it has."""
        return faces_text([self])


def faces_text(tried: Sequence[Finer]) -> str:
    """Return the faces that one or several scenarios have.

    Parameters
    ----------
    tried : sequence of Finer
        At least one, all made from one scenario.
    """
    counts = dict.fromkeys(str(one.pair_faces) for one in tried if one.pair_faces is not None)
    angles = dict.fromkeys(f"{one.corner_angle:g}" for one in tried if one.corner_angle is not None)
    parts = [f"{listed([*counts], 'or')} faces around pairs"] if counts else []
    if angles:
        parts.append(f"obstacles' corners cut every {listed([*angles], 'or')} degrees")
    return " and ".join(parts)


def finer_scenarios(scenario: Scenario) -> Iterator[Finer]:
    """Yield a scenario with more and more faces around pairs and, in the plane, at corners.

    Parameters
    ----------
    scenario : Scenario
        With faces that leave no plan.

    Yields
    ------
    Finer
        None where faces make no difference: a vehicle alone without obstacles.
    """
    has_pairs = scenario.num_vehicles > 1
    has_corners = scenario.dimension == 2 and bool(scenario.obstacles)
    for count in TUNING.faces[scenario.dimension]:
        more = count > scenario.num_pair_faces
        if not (has_corners or (has_pairs and more)):
            continue
        obstacles = scenario.obstacles
        if has_corners:
            obstacles = tuple(_with_corners(o, count) for o in scenario.obstacles)
        faces = max(count, scenario.num_pair_faces)
        yield Finer(
            replace(scenario, pair_faces=faces, obstacles=obstacles),
            faces if has_pairs else None,
            360.0 / count if has_corners else None,
        )


def _with_corners(obstacle: Obstacle, count: int) -> Obstacle:
    """Return an obstacle whose pieces have half-spaces at their corners too."""
    steps = tuple(tuple(_rounded(piece, count) for piece in pieces) for pieces in obstacle.steps)
    return replace(obstacle, steps=steps)


def _rounded(piece: Polytope, count: int) -> Polytope:
    """Return the same polygon with more normals: none further from the next than 2π / count."""
    angles = np.sort(np.arctan2(piece.normals[:, 1], piece.normals[:, 0]))
    gaps = np.diff(np.append(angles, angles[0] + 2.0 * np.pi))
    more: list[float] = []
    for angle, gap in zip(angles.tolist(), gaps.tolist(), strict=True):
        parts = int(np.ceil(gap * count / (2.0 * np.pi) - 1e-9))
        more += [angle + gap * k / parts for k in range(1, parts)]
    if not more:
        return piece
    extra: Matrix = np.column_stack([np.cos(more), np.sin(more)])
    return Polytope(
        np.vstack([piece.normals, extra]),
        np.concatenate([piece.offsets, piece.support(extra)]),
        piece.vertices,
    )
