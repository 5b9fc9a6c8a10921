"""From a plan to the rows that its certificate charges."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.errors import NoPlanError, ScenarioError
from radmpc.model.given import check_plan
from radmpc.model.plan import Cause, Plan
from radmpc.records import dataclass, field, replace
from radmpc.referee.bound.halfspace import end_margins
from radmpc.referee.bound.intervals import has_spans
from radmpc.referee.bound.parts import NUM_PARTS, part_sites
from radmpc.referee.bound.persistence import best_shares
from radmpc.referee.bound.planar import grown_polygon_risks
from radmpc.referee.bound.search import NEGLIGIBLE, best_directions
from radmpc.referee.bound.workspace import WORTH, faces_of
from radmpc.referee.claims.claims import shape_problems
from radmpc.referee.conditional.choices import (
    Choice,
    during,
    interval_choices,
    span_choices,
)
from radmpc.referee.conditional.compiling import compiled, with_telling_links
from radmpc.referee.conditional.far import Far, far_of
from radmpc.referee.conditional.loops import loops_of
from radmpc.referee.conditional.rows import (
    Flags,
    IntegralRows,
    Parties,
    Witnesses,
)
from radmpc.referee.conditional.strays import places_at
from radmpc.referee.conditional.tables import TimedRows, all_integrals, at_steps, joined, links
from radmpc.referee.conditional.valuing import are_sharp
from radmpc.referee.encounters import Encounters, blocks, instant_sites, interval_sites
from radmpc.referee.gather import gather_obstacles, gather_pairs
from radmpc.referee.motion import FleetMotion
from radmpc.referee.propagation import propagate
from radmpc.referee.reserve import in_deviations
from radmpc.referee.tails import exceeding

__all__ = ["unseen_of", "witnesses_of"]


def witnesses_of(plan: Plan) -> Witnesses:
    """Return the events that the certificate of a plan charges, as they are at its step 0.

    Parameters
    ----------
    plan : Plan
        With trajectories; judged by its scenario and controls alone.

    Returns
    -------
    Witnesses
        Their value before anything is measured is the certificate.

    Raises
    ------
    ArgumentTypeError
        If it is no plan.
    NoPlanError
        If the plan holds no trajectories.
    ScenarioError
        If its vehicles or arrays do not fit its scenario, or overflow.
    """
    check_plan(plan)
    problems = shape_problems(plan)
    if problems:
        raise (ScenarioError if plan.trajectories else NoPlanError)("; ".join(problems))
    scenario = plan.scenario
    motion = propagate(scenario, [t.controls for t in plan.trajectories])
    if motion.problems:
        raise ScenarioError("; ".join(motion.problems))
    intervals = scenario.avoidance == "intervals"
    purchase = _Purchase(motion)
    obstacles = gather_obstacles(scenario, motion, intervals=intervals)
    pairs = gather_pairs(scenario, motion, intervals=intervals)
    for batch in (*obstacles.batches, *pairs.batches):
        purchase.take_all(batch, intervals=intervals)
    if scenario.workspace is not None:
        for normal, batch in faces_of(scenario.workspace, motion):
            purchase.take_face(normal, batch, intervals=intervals)
    if scenario.keep:
        from radmpc.referee.bound.ranges import charged_faces  # noqa: PLC0415 - few keep a range

        for normals, batch in charged_faces(scenario, motion, intervals=intervals):
            purchase.take_face(normals, batch, intervals=intervals)
    return purchase.finished(plan, far_of(scenario, obstacles, pairs))


def unseen_of(witnesses: Witnesses) -> Witnesses:
    """Return the events of what was far when a leg was bought, as they would have been bought.

    In large fleets this takes memory with the square of the number of vehicles.

    Parameters
    ----------
    witnesses : Witnesses
        Of the leg.
    """
    plan, motion, far = witnesses.plan, witnesses.motion, witnesses.far
    everyone = np.ones(plan.scenario.num_vehicles, dtype=bool)
    purchase, intervals = _Purchase(motion), witnesses.intervals
    for gather in (gather_obstacles, gather_pairs):
        for batch in gather(plan.scenario, motion, intervals=intervals, always=everyone).batches:
            left_out = far.leaves_out(batch, everyone.size)
            if left_out.size:
                purchase.take_all(batch.take(left_out), intervals=intervals)
    return purchase.finished(plan, replace(far, count=0))


@dataclass(slots=True, eq=False)
class _Purchase:
    """Rows bought so far; lives while one plan is looked at."""

    motion: FleetMotion
    causes: list[Cause] = field(default_factory=list)
    first: list[Indices] = field(default_factory=list)
    other: list[Indices] = field(default_factory=list)
    widths: list[Vector] = field(default_factory=list)
    tables: list[TimedRows] = field(default_factory=list)
    integrals: list[IntegralRows] = field(default_factory=list)

    def take_all(self, batch: Encounters, *, intervals: bool) -> None:
        """Write down the rows of pairs or obstacles, block by block."""
        if not intervals or not has_spans(batch, self.motion):
            for block in blocks(batch):
                self._take(block, intervals=intervals)
            return
        for choice in span_choices(batch, self.motion):
            some = batch.take(choice.chosen)
            if choice.first is not None:
                some = during(some, choice.first, choice.begins.shape[1])
            # Each a chain of its own: whatever else is charged of an encounter stands beside it.
            own = replace(choice, chosen=np.arange(len(choice.chosen)))
            self._take_choice(some, self._enter(some), own)

    def _take(self, block: Encounters, *, intervals: bool) -> None:
        """Write down the rows of a block of pairs or obstacles."""
        numbers = self._enter(block)
        if not intervals:
            self._take_steps(block, numbers)
            return
        for choice in interval_choices(block, self.motion):
            self._take_choice(block.take(choice.chosen), numbers[choice.chosen], choice)

    def take_face(self, normals: Matrix, batch: Encounters, *, intervals: bool) -> None:
        """Write down the rows of vehicles, or of pairs, at faces of convex sets to stay in."""
        numbers = self._enter(batch)
        count, num_intervals, d = batch.sagittas.shape
        each = np.broadcast_to(normals, (count, d))
        if not intervals:
            sites = instant_sites(batch)
            held = np.repeat(each, num_intervals + 1, axis=0)
            self.tables.append(at_steps(sites, held, numbers))
            return
        sites = interval_sites(batch)
        held = np.repeat(each[:, None], num_intervals, axis=1)
        margins = end_margins(sites, held.reshape(-1, 1, d), 0.5)[:, 0]
        along = held.reshape(-1, d)
        variances = np.einsum("sd,sedf,sf->se", along, sites.covariances, along)
        levels = in_deviations(margins, np.sqrt(variances.clip(min=0.0)))
        risks = exceeding(levels, batch.samples).reshape(count, -1).sum(axis=1)
        near, far = np.flatnonzero(risks > WORTH), np.flatnonzero(risks <= WORTH)
        begins = np.ones((count, num_intervals), dtype=bool)
        if far.size:
            whole = Choice(far, 0, held[far], begins[far])
            self._take_choice(batch.take(far), numbers[far], whole, shares=0.5)
        if near.size:
            parted = Choice(near, NUM_PARTS, np.repeat(held[near], NUM_PARTS, axis=1), begins[near])
            self._take_choice(batch.take(near), numbers[near], parted)

    def finished(self, plan: Plan, far: Far) -> Witnesses:
        """Return all rows; links that the certificate does not use are cut."""
        none = np.zeros(0, dtype=np.int64)
        first, other = np.concatenate([none, *self.first]), np.concatenate([none, *self.other])
        parties = Parties(tuple(self.causes), first, other, self._are_hidden(first, other))
        d = self.motion.positions.shape[2]
        loops = loops_of(self.motion, plan.scenario.vehicles)
        tracks = self.motion.tracks
        rows = compiled(joined(self.tables, d), parties, loops, tracks)
        widths = np.concatenate([np.zeros(0), *self.widths])
        leg = plan.scenario.horizon, self.motion.samples
        rows = with_telling_links(rows, widths, loops, parties, leg)
        exact = all_integrals(self.integrals, d)
        strays = places_at(parties, exact.encounters, exact.windows, tracks, d)
        exact = replace(exact, strays=strays)
        return Witnesses(plan, self.motion, parties, rows, exact, far, loops)

    def _are_hidden(self, first: Indices, other: Indices) -> Flags:
        """Return of which encounters what is measured does not tell if they hit, (B,) bool."""
        motion, causes = self.motion, np.array(self.causes, dtype=object)
        estimate = np.array(motion.seen_rows) > 0
        hidden = estimate[first]
        pairs, solid = np.isin(causes, ("pair", "range")), causes == "obstacle"
        hidden[pairs] |= estimate[other[pairs]]
        if motion.tracks is not None:
            hidden[solid] |= motion.tracks.places[other[solid]] >= 0
        return np.asarray(hidden, dtype=bool)

    def _enter(self, block: Encounters) -> Indices:
        """Give the encounters of a block their numbers."""
        count, begun = len(block.first), len(self.causes)
        self.causes += [block.kind] * count
        self.first.append(block.first)
        self.other.append(block.other)
        self.widths.append(np.ones(count))
        return np.arange(begun, begun + count)

    def _take_steps(self, block: Encounters, numbers: Indices) -> None:
        """Write down half-spaces or integrals, whichever is charged, at each step."""
        count, steps, d = block.means.shape
        sites = instant_sites(block)
        best, risks = best_directions(sites, block.directions, steps)
        risks = np.minimum(risks, 1.0)
        worth = np.flatnonzero(risks > NEGLIGIBLE)
        exact = np.zeros(len(risks), dtype=bool)
        # Integrals are of Gaussians.
        if d == 2 and worth.size and sites.samples is None:
            close = sites.take(worth)
            found = grown_polygon_risks(
                close.means[:, 0],
                close.covariances[:, 0],
                close.vertices[:, 0],
                close.radii,
                best[worth],
                risks[worth],
            )
            exact[worth] = found < risks[worth]
            risks[worth] = found
        self.tables.append(at_steps(sites, best, numbers).take(np.flatnonzero(~exact)))
        integrated = np.flatnonzero(exact)
        self.integrals.append(
            IntegralRows(
                np.repeat(numbers, steps)[integrated],
                np.tile(np.arange(steps), count)[integrated],
                sites.means[integrated, 0],
                sites.vertices[integrated, 0],
                sites.radii[integrated],
                np.zeros((len(integrated), d, d)),
                np.repeat(block.directions, steps, axis=0)[integrated],
                risks[integrated],
                are_sharp(sites.covariances[integrated, 0], risks[integrated]),
            )
        )

    def _take_choice(
        self, some: Encounters, numbers: Indices, choice: Choice, shares: float | None = None
    ) -> None:
        """Write down half-spaces along intervals."""
        count, num_intervals, d = some.sagittas.shape
        parts = max(choice.parts, 1)
        if choice.parts:
            sites, _ = part_sites(some, self.motion, choice.parts)
        else:
            sites = interval_sites(some)
        self.widths[-1][choice.chosen] = num_intervals * parts
        flat = choice.directions.reshape(-1, d)
        kept: Tensor | float = best_shares(sites, flat)[:, None] if shares is None else shares
        margins = end_margins(sites, flat[:, None], kept)[:, 0]
        ends = margins.shape[1]
        moments = np.tile(np.arange(num_intervals * parts), count)
        begin = moments % parts / parts
        at = [begin] * (ends - 1) + [begin + 1.0 / parts]
        bends = np.array([0.0] * ends)
        if ends == 3:
            bends[1] = 1.0 / parts**2
        before, nested = links(choice, ends)
        first = 0 if choice.first is None else np.repeat(choice.first, num_intervals * parts)
        table = TimedRows(
            encounters=np.repeat(np.repeat(numbers, num_intervals * parts), ends),
            windows=np.repeat(first + moments // parts, ends),
            normals=np.repeat(flat, ends, axis=0),
            margins=margins.ravel(),
            shares=np.stack(at, axis=1).ravel(),
            bends=np.tile(bends, len(flat)),
            before=before,
            nested=nested,
        )
        if choice.left_out is not None:
            table = table.take(np.flatnonzero(~np.repeat(choice.left_out.ravel(), ends)))
        self.tables.append(table)
