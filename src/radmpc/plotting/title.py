"""What a plan's picture says above the axes."""

from __future__ import annotations

from matplotlib.axes import Axes

from radmpc.model.ledger import bound_text
from radmpc.model.plan import Plan
from radmpc.plotting.style import ALERT, LABEL_SIZE, MUTED, TITLE_SIZE

__all__ = ["alert_text", "draw_title", "num_title_lines", "subtitle"]

_LINE_CHARACTERS = 62  # of a line of facts in one column


def num_title_lines(plan: Plan) -> int:
    """Return how many lines stand above the axes."""
    return 1 + len(subtitle(plan).splitlines()) + (alert_text(plan) is not None)


def subtitle(plan: Plan) -> str:
    """Return the facts of a plan: cost, risk against its bound, seconds, planner."""
    facts = []
    if plan.cost is not None:
        facts.append(f"cost {plan.cost:.4g}")
    if plan.risk.certified is not None:
        sign = "≤" if plan.risk.certified <= plan.risk.bound else ">"
        facts.append(f"risk {min(plan.risk.certified, 1.0):.3g} {sign} {plan.risk.bound:g}")
    if "total" in plan.seconds:
        facts.append(f"{plan.seconds['total']:.2g} s")
    line = " · ".join([*facts, plan.planner])
    if len(line) <= _LINE_CHARACTERS:
        return line
    return "\n".join([" · ".join(facts), plan.planner])


def alert_text(plan: Plan) -> str | None:
    """Return what must not be overlooked, or None."""
    if not plan.trajectories:
        return "no plan"
    certified = plan.risk.certified
    if certified is not None and certified > plan.risk.bound:
        return f"certificate {bound_text(certified)} exceeds the risk bound {plan.risk.bound:g}"
    return None


def draw_title(ax: Axes, plan: Plan) -> None:
    """Write headline, facts and, in red, what is wrong above the axes."""
    alert = alert_text(plan)
    facts = subtitle(plan)
    # The title's empty last lines make room for the smaller lines below it, which no layout
    # engine would otherwise see.
    below = "\n" * (num_title_lines(plan) - 1)
    ax.set_title(
        plan.scenario.name + below, loc="left", fontsize=TITLE_SIZE, fontweight="bold", pad=3.0
    )
    lines = [(facts, MUTED)] if alert is None else [(alert, ALERT), (facts, MUTED)]
    offset = 3.0
    for text, color in lines:
        ax.annotate(
            text,
            (0.0, 1.0),
            xycoords="axes fraction",
            xytext=(0.0, offset),
            textcoords="offset points",
            fontsize=LABEL_SIZE,
            color=color,
            va="bottom",
            annotation_clip=False,
            gid="alert" if color == ALERT else "facts",
        )
        offset += 1.35 * LABEL_SIZE * len(text.splitlines())
