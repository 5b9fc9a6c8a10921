"""The certificate of a plan: whether it holds, and an upper bound on any collision."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from radmpc.arrays import Matrix
from radmpc.model.given import plan_under
from radmpc.model.ledger import bound_text, bound_texts
from radmpc.model.plan import Cause, LedgerRow, Plan
from radmpc.model.scenario import Avoidance, Scenario
from radmpc.notebook import html_table
from radmpc.records import dataclass
from radmpc.referee.bound.bounds import step_risks
from radmpc.referee.bound.charging import Account, Ledger
from radmpc.referee.bound.workspace import workspace_risks
from radmpc.referee.claims.claims import claim_problems, limit_problems, shape_problems
from radmpc.referee.gather import Gathered, gather_obstacles, gather_pairs
from radmpc.referee.motion import FleetMotion
from radmpc.referee.propagation import FleetNoise
from radmpc.referee.saturation import saturation_bound
from radmpc.referee.tails import cutoff_of

__all__ = ["Certificate", "certify", "judged", "ledger_under", "rough_risk_under"]

_STATED_TOL = 1e-6
"""Relative difference [-] by which a stated certificate, or bound on saturation, may be below the
recomputed one: rounding on another machine."""

_MOST_ROWS = 3
"""Rows of the ledger that a notebook shows."""


@dataclass(frozen=True, slots=True, eq=False)
class Certificate:
    """What the referee found.

    Attributes
    ----------
    bound : float
        The scenario's Δ [-].
    certified : float
        Upper bound on the probability that any vehicle ever collides, leaves the workspace or loses
        a range that it keeps [-].
        A sum, so it may exceed 1; 1 where the plan cannot be judged.
    ledger : tuple of LedgerRow
        Where it goes; sums to ``certified``. ``other`` is None for the workspace and for
        everything far from a vehicle taken together. Empty where the plan cannot be judged.
    problems : tuple of str
        What is wrong with the plan besides its risk, one sentence each.
    saturation : float
        Upper bound on the probability that any vehicle's feedback ever asks for more control than
        there is [-]. ``certified`` speaks of feedback that is not cut off: the probability of a
        collision under controls that saturate is at most the sum of both. 1 where the plan
        cannot be judged.

    Examples
    --------
    >>> import radmpc
    >>> from radmpc.experiments.families import paper
    >>> certificate = radmpc.certify(radmpc.plan(paper(2, seed=1), rng=0).require())
    >>> certificate.holds, certificate.bound, certificate.problems
    (True, 0.05, ())
    """

    bound: float
    certified: float
    ledger: tuple[LedgerRow, ...]
    problems: tuple[str, ...]
    saturation: float = 1.0

    @property
    def holds(self) -> bool:
        """Whether the plan is what it says and its risk at most Δ, without any tolerance."""
        return not self.problems and self.certified <= self.bound

    @property
    def summary(self) -> str:
        """The verdict in one sentence."""
        relation = "at most" if self.certified <= self.bound else "above"
        certified, bound = bound_texts(self.certified, self.bound)
        risk = f"certified risk {certified} is {relation} the bound {bound}"
        if not self.problems:
            return f"{'holds' if self.holds else 'does not hold'}: {risk}"
        count = len(self.problems)
        return f"does not hold: {count} problem{'s' if count > 1 else ''}; {risk}"

    def _repr_html_(self) -> str:
        """Return the verdict, what is wrong, and where most risk goes: what notebooks show."""
        facts = [("certificate", self.summary)]
        facts += [("problem", problem) for problem in self.problems]
        largest = sorted(self.ledger, key=lambda row: row.risk, reverse=True)[:_MOST_ROWS]
        facts += [
            (
                f"{row.cause}, step {row.step}",
                f"{row.vehicle} – {row.other or row.cause}: {row.risk:.3g}",
            )
            for row in largest
        ]
        saturation = f"at most {bound_text(self.saturation)} on top, where controls saturate"
        return html_table([*facts, ("saturation", saturation)])


def certify(plan: Plan, *, avoidance: Avoidance | None = None) -> Certificate:
    r"""Judge a plan by its scenario and its controls alone.

    Means and covariances are propagated anew. By Boole's inequality the joint probability is at
    most the sum over vehicles, pairs, obstacles, workspace faces and steps,

    .. math:: \Pr[\text{any collision}] \le \sum_{e} \min_n
              Q\left(\frac{n^\top \bar x_e - c_e(n)}{\sqrt{n^\top \Sigma_e n}}\right),

    each with the best half-space found over all directions. Step 0 counts. Under ``intervals`` a
    half-space is held over each part of an interval: at its near end, at what feedback held over
    the step makes of it, and at its far end, with what the mean curve deviates from its chord in
    reserve; and each of these is charged only with what the one before it does not fail
    (Hunter 1976, Worsley 1982).

    Parameters
    ----------
    plan : Plan
        Any plan, also one from a file that somebody edited.
    avoidance : {'intervals', 'steps'} or None
        Where collisions count; None is as in the plan's scenario. ``intervals`` is the whole path
        of a plan that was made at steps.

    Returns
    -------
    Certificate
        Never raises for a plan that is merely wrong: ``problems`` says what is.

    Raises
    ------
    ArgumentTypeError
        If it is no plan; of a result take ``require()``.
    ArgumentError
        If there is no such avoidance.

    Examples
    --------
    >>> import radmpc
    >>> from radmpc.experiments.families import paper
    >>> plan = radmpc.plan(paper(2, seed=1), rng=0).require()
    >>> radmpc.certify(plan).certified <= plan.scenario.risk_bound
    True
    """
    plan = plan_under(plan, avoidance)
    return judged(plan, FleetNoise.of(plan.scenario))


def ledger_under(
    noise: FleetNoise, controls: Sequence[Matrix]
) -> tuple[float, Iterable[LedgerRow]]:
    """Return what `certify` finds at risk under controls, before they are made a plan.

    Parameters
    ----------
    noise : FleetNoise
        Of the scenario.
    controls : sequence of (T, m) array
        Of every vehicle, in the scenario's order.

    Returns
    -------
    tuple of (float, iterable of LedgerRow)
        Upper bound on the probability of any collision [-], and where it goes; 1 and nothing where
        that cannot be judged. Rows are made when they are asked for.
    """
    motion = noise.under(controls)
    if motion.problems:
        return 1.0, ()
    ledger = _ledger(noise.scenario, motion)
    return ledger.total, ledger


def rough_risk_under(noise: FleetNoise, controls: Sequence[Matrix]) -> float:
    """Return an upper bound on the probability of any collision that is quickly found [-].

    Along intervals that is a tenth to a sixth of the work of `certify`, and three to eight times
    as high: none of them shares a half-space with the next. At steps it is the same.

    Parameters
    ----------
    noise, controls
        As in `ledger_under`.
    """
    motion = noise.under(controls)
    if motion.problems:
        return 1.0
    return _ledger(noise.scenario, motion, is_rough=True).total


def judged(
    plan: Plan, noise: FleetNoise, found: tuple[float, Iterable[LedgerRow]] | None = None
) -> Certificate:
    """Judge one of many plans of a scenario, as `certify` does.

    Parameters
    ----------
    plan : Plan
        Any plan.
    noise : FleetNoise
        Of its scenario.
    found : tuple of (float, iterable of LedgerRow) or None
        What `ledger_under` finds of its controls; None is not at hand.
    """
    scenario = plan.scenario
    problems = shape_problems(plan)
    if problems:
        return Certificate(scenario.risk_bound, 1.0, (), tuple(problems))
    motion = noise.under([t.controls for t in plan.trajectories])
    if motion.problems:
        return Certificate(scenario.risk_bound, 1.0, (), tuple(motion.problems))
    problems = claim_problems(plan, motion) + limit_problems(plan, motion)
    if found is None:
        ledger = _ledger(scenario, motion)
        found = ledger.total, ledger
    certified, rows = found
    saturation = saturation_bound(scenario, motion, [t.controls for t in plan.trajectories])
    total = min(float(saturation.sum()), 1.0)
    problems += _understated("certified risk", plan.risk.certified, certified)
    problems += _understated("saturation", plan.risk.saturation, total)
    return Certificate(scenario.risk_bound, certified, tuple(rows), tuple(problems), total)


def _understated(name: str, stated: float | None, found: float) -> list[str]:
    """Name a stated upper bound that is below the one that is found."""
    if stated is None or stated >= found * (1.0 - _STATED_TOL):
        return []
    return [f"plan: states a {name} of {stated:.9g}, the referee finds {found:.9g}"]


def _ledger(scenario: Scenario, motion: FleetMotion, *, is_rough: bool = False) -> Ledger:
    """Rate everything that can go wrong."""
    intervals = scenario.avoidance == "intervals"
    everyone = np.arange(scenario.num_vehicles)
    account = Account()
    gathered: tuple[tuple[Cause, Gathered], ...] = (
        ("obstacle", gather_obstacles(scenario, motion, intervals=intervals)),
        ("pair", gather_pairs(scenario, motion, intervals=intervals)),
    )
    half_spaces = 3 * scenario.horizon if intervals else scenario.horizon + 1
    batches = [batch for _, found in gathered for batch in found.batches]
    risks = iter(step_risks(batches, motion, intervals=intervals, is_rough=is_rough))
    for cause, found in gathered:
        for batch in found.batches:
            account.charge(cause, batch.first, batch.other, next(risks))
        rest = found.skipped.astype(np.float64) * (half_spaces * cutoff_of(motion.samples)[1])
        account.charge(cause, everyone, None, rest[:, None])
    if scenario.workspace is not None:
        leaving = workspace_risks(scenario.workspace, motion, intervals=intervals)
        account.charge("workspace", everyone, None, leaving)
    if scenario.keep:
        from radmpc.referee.bound.ranges import range_risks  # noqa: PLC0415 - few keep a range

        pairs, losing = range_risks(scenario, motion, intervals=intervals)
        account.charge("range", pairs.first, pairs.other, losing)
    return account.ledger(
        tuple(v.name for v in scenario.vehicles), tuple(o.name for o in scenario.obstacles)
    )
