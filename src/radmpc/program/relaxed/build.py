"""Building the relaxation of some vehicles."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Cause
from radmpc.model.relations.concerns import met_by
from radmpc.model.scenario import Scenario
from radmpc.program.builder import ProgramBuilder
from radmpc.program.condensed import CondensedModel
from radmpc.program.keepout import KeepOut, obstacle_keepouts
from radmpc.program.program import DisjunctiveProgram
from radmpc.program.relaxed.cones import Cones
from radmpc.program.relaxed.cones_in_space import cones_in_space
from radmpc.program.relaxed.instants import Instants
from radmpc.program.relaxed.left_out import Vicinity, near_boxes
from radmpc.program.relaxed.level_curves import Outline
from radmpc.program.relaxed.patches import Patches, around_point, around_polytope
from radmpc.program.relaxed.rows import DROPPED, ConeRows, cone_rows
from radmpc.program.relaxed.shared_rows import SharedRows
from radmpc.program.relaxed.tails import Tails
from radmpc.records import dataclass, field

__all__ = ["Relaxation", "build_relaxation"]

_Found = tuple[KeepOut, Tensor, Tensor]
"""A piece of an obstacle, its corners and its faces at the instants."""

_Label = tuple[Cause, str, str]
"""What may happen, to whom, and with what."""

_BETWEEN = (0.5, 1.0)
"""Instants of an interval that are looked at, as shares of it [-]: those between would be others'
neighbors. Four per interval raise the bound by less than the search for it loses."""

_LEVELS = 2
"""How often the octants around a pair in space are parted into four patches [-]: 128 in the end."""


@dataclass(frozen=True, slots=True, eq=False)
class Relaxation:
    """What plans cost at least.

    Attributes
    ----------
    program : DisjunctiveProgram
        No plan that the referee would certify has a lower cost than its optimum within Δ.
    left_out : tuple of Vicinity
        Hazards in reach of which it says nothing.
    """

    program: DisjunctiveProgram
    left_out: tuple[Vicinity, ...]


def build_relaxation(
    scenario: Scenario,
    models: Sequence[CondensedModel],
    tails: Tails,
    num_directions: int,
    shared: SharedRows | None = None,
    around: Tensor | None = None,
) -> Relaxation:
    """Build the relaxation of some vehicles, obstacles and pairs among them included.

    Parameters
    ----------
    scenario : Scenario
        Obstacles, workspace, what counts as a collision, and Δ.
    models : sequence of CondensedModel
        The vehicles.
    tails : Tails
        What charges are at least, for the same Δ.
    num_directions : int
        Directions around every hazard in the plane beside the faces of obstacles; 3 at least.
    shared : SharedRows or None
        Those of other sets of the same vehicles, for the same tails.
    around : (N, T+1, d) array or None
        Mean positions of the vehicles in a plan [m]: hazards far from them are left out. None
        leaves out none.

    Returns
    -------
    Relaxation
        The program, and what was left out.
    """
    shared = SharedRows() if shared is None else shared
    relaxation = _Relaxation(scenario, tuple(models), tails, num_directions, shared, around)
    return Relaxation(relaxation.program(), tuple(relaxation.left_out))


@dataclass(slots=True, eq=False)
class _Relaxation:
    """Collects the rows of a relaxation."""

    scenario: Scenario
    models: tuple[CondensedModel, ...]
    tails: Tails
    num_directions: int
    shared: SharedRows
    around: Tensor | None
    left_out: list[Vicinity] = field(default_factory=list)
    builder: ProgramBuilder = field(init=False)
    instants: tuple[Instants, ...] = field(init=False)

    def __post_init__(self) -> None:
        """Lay out every vehicle's instants."""
        self.builder = ProgramBuilder(self.scenario, self.models, 0)
        shares = _BETWEEN if self.intervals else (1.0,)
        self.instants = tuple(
            Instants.of(model, part, shares)
            for model, part in zip(self.models, self.builder.parts, strict=True)
        )

    @property
    def intervals(self) -> bool:
        """Whether collisions count between steps."""
        return self.scenario.avoidance == "intervals"

    def program(self) -> DisjunctiveProgram:
        """Return the relaxation."""
        outlines = [
            outline for obstacle in self.scenario.obstacles for outline in self._outlines(obstacle)
        ]
        for body, (model, instants) in enumerate(zip(self.models, self.instants, strict=True)):
            name = model.vehicle.name
            mine = {obstacle.name for obstacle in met_by(self.scenario.obstacles, name)}
            self._keep_out_of(body, [found for found in outlines if found[0].name in mine])
            for cones in self._walls(instants):
                self._add(instants, cones, "workspace", name, None)
        for i, j in combinations(range(len(self.models)), 2):
            one, two = self.models[i].vehicle, self.models[j].vehicle
            instants = self.instants[i].relative_to(self.instants[j])
            d = self.scenario.dimension
            point = Outline(np.zeros((1, 1, d)), np.zeros((1, 0, d)), one.radius + two.radius)
            patches = around_point(_LEVELS) if d == 3 else None
            self._keep_out((i, j), instants, point, patches, ("pair", one.name, two.name))
        return self.builder.finish(self.scenario.risk_bound)

    def _keep_out_of(self, body: int, outlines: list[_Found]) -> None:
        """Add the rows of the obstacles of a vehicle."""
        vehicle, instants = self.models[body].vehicle, self.instants[body]
        is_plane = self.scenario.dimension == 2
        standing = [found for found in outlines if is_plane and len(found[0].shapes) == 1]
        chosen = self._in_reach(body, [vertices[0] for _, vertices, _ in standing])
        every = iter(chosen)
        for keepout, vertices, faces in outlines:
            label: tuple[Cause, str, str] = "obstacle", vehicle.name, keepout.name
            outline = Outline(vertices, faces, vehicle.radius)
            is_standing = len(keepout.shapes) == 1
            if is_plane and is_standing:
                some = next(every)
                if some.size:
                    self._keep_out_at(some, instants, outline, label)
                continue
            if is_plane:
                seen = instants.seen_from(keepout.spread)
                self._keep_out((body, -1), seen, outline, None, label)
                continue
            # In space, what moves or is flat is left out.
            patches = around_polytope(keepout.shapes[0]) if is_standing else None
            if patches is not None:
                self._keep_out((body, -1), instants, outline, patches, label)

    def _in_reach(self, body: int, corners: list[Matrix]) -> list[Indices]:
        """Return when standing obstacles are in a vehicle's reach; none of those left out.

        All at once, as most of many are not.
        """
        if not corners:
            return []
        instants, radius = self.instants[body], self.models[body].vehicle.radius
        lower = np.array([each.min(axis=0) for each in corners])
        upper = np.array([each.max(axis=0) for each in corners])
        is_in = instants.near(lower[:, None], upper[:, None], self._room(instants, radius))
        if self.around is not None:
            path = self.around[body]
            is_near = near_boxes(instants, (lower, upper), radius, path)
            is_far = np.logical_not(np.any(is_in & is_near, axis=1))
            which, when = np.nonzero(is_in & is_far[:, None])
            if which.size:
                boxes = lower[which], upper[which]
                self.left_out.append(
                    Vicinity.of_boxes((body, -1), instants.take(when), boxes, radius)
                )
                is_in[is_far] = False
        return [np.flatnonzero(each) for each in is_in]

    def _room(self, instants: Instants, radius: float) -> Vector:
        """Return the distance beyond which a hazard counts for nothing, (I,) [m]."""
        enough = float(self.builder.tail.clearance_for(DROPPED * self.scenario.risk_bound))
        return radius + enough * instants.sizes()

    def _keep_out(
        self,
        bodies: tuple[int, int],
        instants: Instants,
        outline: Outline,
        patches: Patches | None,
        label: _Label,
    ) -> None:
        """Add the rows of a hazard at the instants at which it is in reach; patches in space."""
        ends = outline.vertices.min(axis=1), outline.vertices.max(axis=1)
        chosen = np.flatnonzero(instants.near(*ends, self._room(instants, outline.radius)))
        if not chosen.size:
            return
        if self.around is not None or patches is not None:
            near = instants.take(chosen)
        if self.around is not None:
            vicinity = Vicinity.of(*bodies, near, outline.take(chosen))
            if not vicinity.is_near(self.around):
                self.left_out.append(vicinity)
                return
        if patches is not None:
            cones = cones_in_space(patches, outline.radius, near.covariances, self.tails)
            self._add(near, cones, *label)
            return
        self._keep_out_at(chosen, instants, outline, label)

    def _keep_out_at(
        self, chosen: Indices, instants: Instants, outline: Outline, label: _Label
    ) -> None:
        """Add the rows of a hazard in the plane at some instants."""
        near = instants.take(chosen)
        around = outline, instants, self.tails, self.num_directions
        rows = self.shared.around(around, chosen, lambda cones: self._rows(near, cones))
        self.builder.add_block(rows.over(near), *label)

    def _add(
        self, instants: Instants, cones: Cones, cause: Cause, vehicle: str, other: str | None
    ) -> None:
        """Add the rows of cones."""
        rows = self._rows(instants, cones)
        self.builder.add_block(rows.over(instants), cause, vehicle, other)

    def _rows(self, instants: Instants, cones: Cones) -> ConeRows:
        """Return the rows of cones."""
        bound = self.scenario.risk_bound
        return cone_rows(instants, cones, bound, self.builder.tail, is_shared=self.intervals)

    def _walls(self, instants: Instants) -> list[Cones]:
        """Return the faces of the workspace: a half-space each, as it is."""
        workspace = self.scenario.workspace
        if workspace is None:
            return []
        found = []
        for axis in range(self.scenario.dimension):
            for sign, corner in ((1.0, workspace.lower), (-1.0, workspace.upper)):
                normals = np.zeros((instants.count, 1, self.scenario.dimension))
                normals[:, 0, axis] = sign
                variances = np.maximum(instants.covariances[:, axis, axis], 0.0)
                offsets = np.full((instants.count, 1), sign * corner[axis])
                nothing = np.zeros(instants.count, dtype=bool)
                deviations, alone = np.sqrt(variances)[:, None], np.array([-1])
                found.append(Cones(normals, offsets, deviations, alone, nothing))
        return found

    def _outlines(self, obstacle: Obstacle) -> list[_Found]:
        """Return the corners and faces of an obstacle's pieces at the instants."""
        horizon = self.scenario.horizon
        found = []
        for keepout in obstacle_keepouts(obstacle, 0, horizon, intervals=self.intervals):
            shapes = keepout.shapes
            if len(shapes) == 1:
                found.append((keepout, shapes[0].vertices[None], shapes[0].normals[None]))
                continue
            sample = self.instants[0]
            at = [
                _between(shapes[k].vertices, shapes[k + 1].vertices, s)
                for k, s in zip(sample.windows, sample.shares, strict=True)
            ]
            faces = [np.vstack([shapes[k].normals, shapes[k + 1].normals]) for k in sample.windows]
            found.append((keepout, _stacked(at), _stacked(faces)))
        return found


def _between(first: Matrix, second: Matrix, share: float) -> Matrix:
    """Return points whose hull is the Minkowski interpolation of two hulls."""
    if share == 1.0:
        return second
    sums = (1.0 - share) * first[:, None] + share * second[None]
    return np.asarray(sums.reshape(-1, first.shape[1]))


def _stacked(points: list[Matrix]) -> Tensor:
    """Stack lists of different lengths, the last of each repeated."""
    most = max(len(p) for p in points)
    return np.array([np.concatenate([p, np.repeat(p[-1:], most - len(p), axis=0)]) for p in points])
