"""Building the relaxation of some vehicles."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.model.plan import Cause
from radmpc.model.relations.concerns import met_by
from radmpc.model.scenario import Scenario
from radmpc.program.builder import ProgramBuilder
from radmpc.program.condensed import CondensedModel
from radmpc.program.program import DisjunctiveProgram
from radmpc.program.relaxed.cones import Cones
from radmpc.program.relaxed.cones_in_space import cones_in_space
from radmpc.program.relaxed.instants import Instants
from radmpc.program.relaxed.left_out import Vicinity, near_boxes
from radmpc.program.relaxed.level_curves import Outline
from radmpc.program.relaxed.obstacles import Found, moved_since, seen_at, walls_of
from radmpc.program.relaxed.patches import Patches, around_point
from radmpc.program.relaxed.polytope_patches import around_polytope
from radmpc.program.relaxed.rows import DROPPED, ConeRows, cone_rows
from radmpc.program.relaxed.shared_hazards import HazardRows
from radmpc.program.relaxed.shared_rows import SharedRows
from radmpc.program.relaxed.tails import Tails
from radmpc.program.sharing.contribution import Contribution
from radmpc.records import dataclass, field

__all__ = ["Relaxation", "build_relaxation"]

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
    bodies = tuple(range(len(models)))

    def made(places: tuple[int, ...]) -> _Relaxation:
        some, paths = _some_of(places, models, around)
        return _Relaxation(scenario, some, tails, num_directions, shared, paths)

    def rows_of(places: tuple[int, ...]) -> HazardRows:
        alone = made(places)
        alone.add(bodies[: len(places)])
        return HazardRows(Contribution.of(alone.builder), tuple(alone.left_out))

    whole = made(bodies)
    for places in (*((i,) for i in bodies), *combinations(bodies, 2)):
        if shared.hazards is None:
            whole.add(places)
            continue
        named = _some_of(places, models, around)
        found = shared.hazards.of(*named, lambda places=places: rows_of(places))  # type: ignore[misc] # bound now
        whole.left_out += found.add_to(whole.builder, places)
    return Relaxation(whole.builder.finish(scenario.risk_bound), tuple(whole.left_out))


def _some_of(
    places: tuple[int, ...], models: Sequence[CondensedModel], around: Tensor | None
) -> tuple[tuple[CondensedModel, ...], Tensor | None]:
    """Return some of the vehicles, and where they are in a plan."""
    return tuple(models[i] for i in places), None if around is None else around[list(places)]


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
    instants: dict[int, Instants] = field(default_factory=dict)
    outlines: list[Found] | None = None

    def __post_init__(self) -> None:
        """Begin without rows."""
        self.builder = ProgramBuilder(self.scenario, self.models, 0)

    @property
    def intervals(self) -> bool:
        """Whether collisions count between steps."""
        return self.scenario.avoidance == "intervals"

    def add(self, places: tuple[int, ...]) -> None:
        """Add the rows of what a vehicle meets, or of a pair."""
        if len(places) == 1:
            self._add_alone(*places)
        else:
            self._add_pair(*places)

    def _add_alone(self, body: int) -> None:
        """Add the rows of the obstacles and of the workspace of a vehicle."""
        name = self.models[body].vehicle.name
        mine = {obstacle.name for obstacle in met_by(self.scenario.obstacles, name)}
        self._keep_out_of(body, [found for found in self._outlines() if found[0].name in mine])
        for cones in walls_of(self.scenario.workspace, self._instants(body)):
            self._add(self._instants(body), cones, "workspace", name, None)

    def _add_pair(self, i: int, j: int) -> None:
        """Add the rows of two vehicles."""
        one, two = self.models[i].vehicle, self.models[j].vehicle
        instants = self._instants(i).relative_to(self._instants(j))
        d = self.scenario.dimension
        point = Outline(np.zeros((1, 1, d)), np.zeros((1, 0, d)), one.radius + two.radius)
        still = np.zeros((instants.count, d))
        around = (around_point(_LEVELS), still) if d == 3 else None
        self._keep_out((i, j), instants, point, around, ("pair", one.name, two.name))

    def _instants(self, body: int) -> Instants:
        """Return where a vehicle is at the instants at which collisions count."""
        if body not in self.instants:
            shares = _BETWEEN if self.intervals else (1.0,)
            part = self.builder.parts[body]
            self.instants[body] = Instants.of(self.models[body], part, shares)
        return self.instants[body]

    def _keep_out_of(self, body: int, outlines: list[Found]) -> None:
        """Add the rows of the obstacles of a vehicle."""
        vehicle, instants = self.models[body].vehicle, self._instants(body)
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
            seen, around = instants.seen_from(keepout.spread), None
            if not is_plane:
                # In space, what turns is left out, and what has no faces.
                patches, moves = around_polytope(keepout.shapes[0]), moved_since(keepout, seen)
                if patches is None or moves is None:
                    continue
                around = patches, moves
            self._keep_out((body, -1), seen, outline, around, label)

    def _in_reach(self, body: int, corners: list[Matrix]) -> list[Indices]:
        """Return when standing obstacles are in a vehicle's reach; none of those left out.

        All at once, as most of many are not.
        """
        if not corners:
            return []
        instants, radius = self._instants(body), self.models[body].vehicle.radius
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
        around: tuple[Patches, Matrix] | None,
        label: _Label,
    ) -> None:
        """Add the rows of a hazard at the instants at which it is in reach.

        In space, of patches around it, and of how far it has moved from these.
        """
        ends = outline.vertices.min(axis=1), outline.vertices.max(axis=1)
        chosen = np.flatnonzero(instants.near(*ends, self._room(instants, outline.radius)))
        if not chosen.size:
            return
        if self.around is not None or around is not None:
            near = instants.take(chosen)
        if self.around is not None:
            vicinity = Vicinity.of(*bodies, near, outline.take(chosen))
            if not vicinity.is_near(self.around):
                self.left_out.append(vicinity)
                return
        if around is not None:
            patches, moves = around
            noise = near.covariances, self.tails
            cones = cones_in_space(patches, outline.radius, *noise, moves[chosen])
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

    def _outlines(self) -> list[Found]:
        """Return the corners and faces of all obstacles' pieces at the instants."""
        if self.outlines is None:
            asked, sample = (self.scenario.obstacles, self.scenario.horizon), self._instants(0)
            self.outlines = [
                seen_at(sample, keepout)
                for keepout in self.shared.keepouts.of(*asked, intervals=self.intervals)
            ]
        return self.outlines
