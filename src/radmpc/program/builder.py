"""Collecting the rows of everything to avoid, numbered: rows, events, risk items, avoidances."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.gaussian import Tail
from radmpc.geometry import inner_faces, sphere_directions
from radmpc.model.obstacle_track import TrackSpread
from radmpc.model.plan import Cause
from radmpc.model.scenario import Scenario
from radmpc.program.assembly import (
    all_outputs,
    decision_columns,
    joined_parents,
    run_starts,
    stacked_chance_rows,
)
from radmpc.program.avoidance import Body, Part, RowBlock, Windows
from radmpc.program.condensed import CondensedModel
from radmpc.program.joined import batches, faces_at_start, joined_windows
from radmpc.program.keepout import KeepOut
from radmpc.program.layout import Label, RiskItem, RiskItems, laid_out, risk_items_of
from radmpc.program.openings import opening_directions, openings
from radmpc.program.program import DisjunctiveProgram
from radmpc.program.relative import own_body, relative_body
from radmpc.program.rows import avoidance_rows
from radmpc.program.start import risks_at_start
from radmpc.records import dataclass, field

if TYPE_CHECKING:
    from radmpc.program.visits.columns import TimeColumns

__all__ = ["ProgramBuilder"]

_Labels = Sequence[tuple[Cause, str, str | None]]

_NEGLIGIBLE = 1e-9
"""Risk at k = 0 up to which it is charged but not named in the program [-]."""


@dataclass(slots=True, eq=False)
class ProgramBuilder:
    """Collects blocks of rows; numbers rows, events, risk items as they come.

    Attributes
    ----------
    scenario : Scenario
        Workspace, faces of pairs, and what counts as a collision.
    models : tuple of CondensedModel
        The vehicles, in the order of blocks.
    first_step : int
        Absolute step at which the program starts.
    blocks, labels, items : list of RowBlock, list of tuple, list of RiskItems
        Rows collected so far; cause, vehicle and others of each; and its risk items.
    risk_items, avoidances : list of RiskItem
        Those of all blocks.
    initial : list of (RiskItem, float)
        Risk at k = 0 that is not negligible.
    presolved_risk, initial_risk, num_presolved, parts
        Risk of presolved windows and at k = 0, how many are presolved; where vehicles stand.
    """

    scenario: Scenario
    models: tuple[CondensedModel, ...]
    first_step: int
    blocks: list[RowBlock] = field(default_factory=list)
    labels: list[Label] = field(default_factory=list)
    items: list[RiskItems] = field(default_factory=list)
    risk_items: list[RiskItem] = field(default_factory=list)
    avoidances: list[RiskItem] = field(default_factory=list)
    initial: list[tuple[RiskItem, float]] = field(default_factory=list)
    presolved_risk: float = 0.0
    num_presolved: int = 0
    initial_risk: float = 0.0
    parts: tuple[Part, ...] = ()

    def __post_init__(self) -> None:
        """Give every vehicle its place among outputs and columns."""
        d = self.scenario.dimension
        num_positions = sum(d * (s.horizon + 1) for s in self.models)
        position, controls, parts = 0, num_positions, []
        for model in self.models:
            sagitta = model.vehicle.system.sagitta
            parts.append(Part(1.0, position, controls, model.control_bounds, sagitta))
            position += d * (model.horizon + 1)
            controls += 2 * model.control_bounds.size
        self.parts = tuple(parts)

    @property
    def tail(self) -> Tail:
        """Of what everything deviates by."""
        return Tail(self.scenario.covariance_samples)

    @property
    def intervals(self) -> bool:
        """Whether collisions count between steps."""
        return self.scenario.avoidance == "intervals"

    def keep_out(self, i: int, cause: Cause, keepouts: Sequence[KeepOut]) -> None:
        """Keep a vehicle out of convex sets.

        Parameters
        ----------
        i : int
            Number of the vehicle.
        cause : {'obstacle', 'pair'}
            What the sets stand for.
        keepouts : sequence of KeepOut
            The sets, window by window.
        """
        vehicle = self.models[i].vehicle
        for some in batches(keepouts):
            body = self._body(i, some[0].spread)
            extras = openings(body.endpoints, some, vehicle.radius, self.tail)
            labels = [(cause, vehicle.name, k.name) for k in some if k.start is not None]
            if labels:
                normals, offsets = faces_at_start(some, extras)
                self._charge_starts(body, -normals, -(offsets + vehicle.radius), labels)
            opened = [
                keepout.with_directions(extra, intervals=self.intervals) if len(extra) else keepout
                for keepout, extra in zip(some, extras, strict=True)
            ]
            windows = joined_windows(opened, vehicle.radius, intervals=self.intervals)
            self._add(body, windows, cause, vehicle.name, [k.name for k in some])

    def keep_apart(self, i: int, j: int) -> None:
        """Keep two vehicles apart by faces around their relative position.

        Parameters
        ----------
        i, j : int
            Numbers of the vehicles; the position of i relative to j is kept out of the faces.
        """
        one, two = self.models[i], self.models[j]
        faces = sphere_directions(self.scenario.num_pair_faces, self.scenario.dimension)
        distance = one.vehicle.radius + two.vehicle.radius
        body = relative_body((one, two), self.parts[i], self.parts[j])
        if self.first_step == 0:
            origin = np.zeros((1, self.scenario.dimension))
            extra = opening_directions(body.endpoints, faces, (origin, origin), distance, self.tail)
            faces = np.vstack([faces, extra])
        normals, offsets = -faces[None], np.full((1, len(faces)), -distance)
        name, other = one.vehicle.name, two.vehicle.name
        self._charge_starts(body, normals, offsets, [("pair", name, other)])
        windows = Windows.constant(normals, offsets, one.horizon, intervals=self.intervals)
        self._add(body, windows, "pair", name, [other])

    def keep_within(self, i: int, j: int, within: float) -> None:
        """Keep two vehicles in range: convex, so every face is an avoidance of its own.

        Parameters
        ----------
        i, j : int
            Numbers of the vehicles.
        within : float
            The range [m].
        """
        both = (self.models[i], self.models[j])
        normals, share = inner_faces(self.scenario.dimension)
        body, ends = relative_body(both, self.parts[i], self.parts[j]), share * within
        names = both[0].vehicle.name, both[1].vehicle.name
        self._keep_inside(body, normals, np.full(len(normals), ends), "range", names)

    def keep_in_workspace(self, i: int) -> None:
        """Keep a vehicle's center inside: convex, so every face is an avoidance of its own."""
        workspace = self.scenario.workspace
        if workspace is None:
            return
        normals = sphere_directions(2 * self.scenario.dimension, self.scenario.dimension)
        offsets = np.concatenate([workspace.upper, -workspace.lower])
        names = self.models[i].vehicle.name, None
        self._keep_inside(self._body(i), normals, offsets, "workspace", names)

    def _keep_inside(
        self, body: Body, sides: Matrix, ends: Vector, cause: Cause, names: tuple[str, str | None]
    ) -> None:
        """Keep ``sides @ position <= ends``, each an avoidance with a single alternative."""
        normals, offsets, horizon = sides[:, None], ends[:, None], self.models[0].horizon
        self._charge_starts(body, normals, offsets, [(cause, *names)] * len(sides))
        windows = Windows.constant(normals, offsets, horizon, intervals=self.intervals)
        self._add(body, windows, cause, names[0], [names[1]] * len(sides))

    def _body(self, i: int, spread: TrackSpread | None = None) -> Body:
        """Return a vehicle alone, as seen from something whose own place spreads."""
        return own_body(self.models[i], self.parts[i], spread)

    def _add(
        self, body: Body, windows: Windows, cause: Cause, vehicle: str, others: Sequence[str | None]
    ) -> None:
        """Add the rows of things to avoid, and the risk of their presolved windows."""
        block = avoidance_rows(body, windows, self.scenario.risk_bound, self.tail)
        self.add_block(block, cause, vehicle, *others)

    def add_block(
        self, block: RowBlock, cause: Cause | Literal["visit"], vehicle: str, *others: str | None
    ) -> None:
        """Take rows of things to avoid or to visit, and number them.

        Parameters
        ----------
        block : RowBlock
            Their rows.
        cause : {'obstacle', 'pair', 'workspace', 'range', 'visit'}
            What may happen.
        vehicle : str
            To whom.
        *others : str or None
            With each of these.
        """
        self.presolved_risk += block.presolved_risk
        self.num_presolved += block.num_presolved
        if block.avoidance_sizes.size:
            self.take_rows(block.compact(), (cause, vehicle, others))

    def take_rows(self, block: RowBlock, label: Label, items: RiskItems | None = None) -> None:
        """Take rows whose presolved windows are charged already, and number them.

        Parameters
        ----------
        block : RowBlock
            The rows, compact.
        label : tuple
            Cause, vehicle and others, as in `add_block`.
        items : RiskItems or None
            Of a program from the same step on; None is not known.
        """
        first = self.first_step + (0 if self.intervals else 1)
        found = items or risk_items_of(block, label, (self.first_step, first))
        self.blocks.append(block)
        self.labels.append(label)
        self.items.append(found)
        self.risk_items += found.risk_items
        self.avoidances += found.avoidances

    def _charge_starts(self, body: Body, normals: Tensor, offsets: Matrix, labels: _Labels) -> None:
        """Note the least risk of any face of each thing at k = 0, which no control changes.

        It is charged, but under intervals: there the rows at k = 0 are part of the alternatives.
        """
        if self.first_step > 0:
            return
        risks = risks_at_start(body, normals, offsets, self.tail)
        for label, risk in zip(labels, risks.tolist(), strict=True):
            if not self.intervals:
                self.initial_risk += risk
            if risk > _NEGLIGIBLE:
                self.initial.append((RiskItem(*label, 0), risk))

    def _add_visits(self, times: TimeColumns) -> int:
        """Add what is visited; return how many visits."""
        from radmpc.program.visits.rows import visit_blocks  # noqa: PLC0415 - few visit anything

        found = list(visit_blocks(self.models, self.parts, times, intervals=self.intervals))
        for vehicle, block, names in found:
            self.add_block(block, "visit", vehicle, *names)
        return sum(len(names) for _, _, names in found)

    def finish(self, risk_bound: float) -> DisjunctiveProgram:
        """Stack the blocks, visits last, and the hard rows into the program of a risk bound Δ."""
        columns = decision_columns(self.models)
        lower, upper = columns.lower, columns.upper
        num_visits = 0 if columns.times is None else self._add_visits(columns.times)
        outputs, constant = all_outputs(self.models, upper.size)
        rows = stacked_chance_rows(self.blocks, self.items, outputs.shape[0])
        avoidance_starts = run_starts([b.avoidance_sizes for b in self.blocks])
        return DisjunctiveProgram(
            cost=columns.cost,
            lower=lower,
            upper=upper,
            blocks=columns.blocks,
            hard=columns.hard,
            hard_lower=columns.hard_lower,
            hard_upper=columns.hard_upper,
            outputs=outputs,
            num_positions=outputs.shape[0] - upper.size,
            constant=constant,
            output_lower=np.concatenate([*(s.reach_lower.ravel() for s in self.models), lower]),
            output_upper=np.concatenate([*(s.reach_upper.ravel() for s in self.models), upper]),
            rows=rows,
            alternative_starts=run_starts([b.alternative_sizes for b in self.blocks]),
            alternative_rows=np.arange(rows.count, dtype=np.int32),
            avoidance_starts=avoidance_starts,
            avoidances=tuple(self.avoidances),
            risk_items=tuple(self.risk_items),
            risk_bound=risk_bound,
            initial_risk=self.initial_risk + self.presolved_risk,
            initial=tuple(self.initial),
            layout=laid_out(self.parts, self.scenario, self.first_step, avoidance_starts),
            presolved_risk=self.presolved_risk,
            num_presolved=self.num_presolved,
            parents=joined_parents(self.blocks),
            num_visits=num_visits,
            tail=self.tail,
        )
