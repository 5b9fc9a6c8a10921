"""What planning returns, for people and programs."""

from __future__ import annotations

from collections.abc import Mapping
from io import BytesIO

from radmpc.errors import NoPlanError
from radmpc.model.ledger import bound_texts
from radmpc.model.plan import Coupling, Plan, Status
from radmpc.notebook import html_picture, html_table, lacking_signs
from radmpc.planners.draft import Event, Step
from radmpc.records import dataclass
from radmpc.referee import Certificate
from radmpc.wording import short_cost

__all__ = ["Result"]

_MOST_SETS = 6
"""Sets of vehicles that a notebook names; the rest is counted."""

_DPI = 150
"""Resolution of the picture in a notebook [dots/in]."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Result:
    """The answer to `radmpc.plan`; in a notebook it shows a summary and a picture.

    Attributes
    ----------
    record : Plan
        What a plan file holds, also where no plan was found.
    certificate : Certificate or None
        The referee's certificate; None without a plan.
    steps : tuple of Step
        Every solve, in order.
    events : tuple of Event
        Subproblems without a solution on the way.

    Examples
    --------
    >>> import radmpc
    >>> from radmpc.experiments.families import paper
    >>> result = radmpc.plan(paper(2, seed=1), rng=0)
    >>> result.status, result.is_certified, len(result.sets)
    (<Status.OPTIMAL: 'optimal'>, True, 2)
    """

    record: Plan
    certificate: Certificate | None
    steps: tuple[Step, ...] = ()
    events: tuple[Event, ...] = ()

    @property
    def plan(self) -> Plan | None:
        """The plan, or None."""
        return self.record if self.record.trajectories else None

    @property
    def status(self) -> Status:
        """How planning ended."""
        return self.record.status

    @property
    def cost(self) -> float | None:
        """``Σ weight · ‖u‖₁``."""
        return self.record.cost

    @property
    def lower_bound(self) -> float | None:
        """Proven least cost of plans by the program's own faces, where there is a proof."""
        return self.record.lower_bound

    @property
    def certified_lower_bound(self) -> float | None:
        """Proven least cost of any plan that the referee would certify, where there is a proof."""
        return self.record.certified_lower_bound

    @property
    def sets(self) -> tuple[tuple[str, ...], ...]:
        """Vehicles that were planned together."""
        return self.record.sets

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """Why they were."""
        return self.record.couplings

    @property
    def seconds(self) -> Mapping[str, float]:
        """Seconds per stage and ``total``."""
        return self.record.seconds

    @property
    def explanation(self) -> str | None:
        """Why there is no plan, or what it took to find this one."""
        return self.record.explanation

    @property
    def is_certified(self) -> bool:
        """Whether there is a plan and the referee holds it to be within Δ."""
        return self.certificate is not None and self.certificate.holds

    def require(self) -> Plan:
        """Return the plan.

        Returns
        -------
        Plan
            As in `plan`.

        Raises
        ------
        NoPlanError
            If there is none; the message explains why.
        """
        if self.plan is None:
            raise NoPlanError(self.explanation or self.record.status_sentence)
        return self.plan

    def __repr__(self) -> str:
        """Return the answer in one line."""
        return f"Result({'; '.join(text for _, text in _facts(self))})"

    def _repr_html_(self) -> str:
        """Return a summary and, of a plan, its picture: what notebooks show."""
        return html_table(_facts(self)) + _picture(self.record)


def _facts(result: Result) -> list[tuple[str, str]]:
    """Return what one wants to know first, by name."""
    record = result.record
    ended = f" ({record.stopped_by})" if record.stopped_by and result.plan else ""
    facts = [("scenario", record.scenario.name), ("status", record.status.value + ended)]
    if result.plan is None or result.cost is None:
        return [*facts, ("why", result.explanation or record.status_sentence)]
    least = result.lower_bound
    bound = "no lower bound" if least is None else f"at least {short_cost(least)}"
    facts.append(("cost", f"{short_cost(result.cost)} ({bound})"))
    if result.certificate is not None:
        certified, problems = result.certificate.certified, result.certificate.problems
        sign = "within" if certified <= record.scenario.risk_bound else "NOT within"
        risk, bound = bound_texts(certified, record.scenario.risk_bound)
        facts.append(("risk", f"at most {risk}, {sign} {bound}"))
        if problems:
            more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
            facts.append(("the plan", f"refused: {problems[0]}{more}"))
    groups = sorted(result.sets, key=len, reverse=True)
    shown = ", ".join("{" + ", ".join(group) + "}" for group in groups[:_MOST_SETS])
    more = f" and {len(groups) - _MOST_SETS} more" if len(groups) > _MOST_SETS else ""
    facts.append(("sets", shown + more))
    facts.append(("seconds", f"{result.seconds.get('total', 0.0):.2f}"))
    return facts


def _picture(plan: Plan) -> str:
    """Return a plan's picture as part of a page."""
    # matplotlib takes longer to load than many a plan to make.
    from radmpc.plotting import plot_plan  # noqa: PLC0415 - matplotlib loads slowly

    content = BytesIO()
    with lacking_signs() as lacking:
        figure = plot_plan(plan).get_figure(root=True)
        if figure is None:
            return ""
        figure.savefig(content, format="png", dpi=_DPI)
    return html_picture(content.getvalue(), "png", plan.scenario.name, lacking)
