"""What a plan's picture says above the axes."""

from __future__ import annotations

import textwrap

from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.transforms import ScaledTranslation

from radmpc.model.ledger import bound_texts
from radmpc.model.plan import Plan
from radmpc.plotting.canvas.headline import figure_headline, write_headline
from radmpc.plotting.canvas.style import ALERT, LABEL_SIZE, MUTED, TITLE_SIZE
from radmpc.wording import short_cost

__all__ = [
    "alert_text",
    "draw_headline",
    "draw_headlines",
    "draw_title",
    "num_title_lines",
    "subtitle",
]

_LINE_CHARACTERS = 62
"""Letters in a line of facts in one column."""

_ALERT_CHARACTERS = 48
"""Letters in a line of warnings, which must fit beside narrow axes, too."""

_MOST_LINES = 5
"""Lines of an explanation that are shown."""

_LEFT = 0.01
"""Where headlines above several panels begin, as a share of the figure's width [-]."""

_ABOVE = 3.0
"""Space that a layout keeps free above headlines [pt]."""


def num_title_lines(plan: Plan, *, details: bool = True) -> int:
    """Return how many lines stand above the axes.

    Parameters
    ----------
    plan : Plan
        What is drawn.
    details : bool
        Whether how the plan was made is told, too.
    """
    texts = [text for _, text, _ in _blocks(plan, details=details)]
    return 1 + sum(len(text.splitlines()) for text in texts)


def subtitle(plan: Plan, *, details: bool = True) -> str:
    """Return the facts of a plan: cost, risk against its bound and, as details, how it was made.

    Parameters
    ----------
    plan : Plan
        What is drawn.
    details : bool
        Whether how the plan was made is told, too.
    """
    facts = []
    if plan.cost is not None:
        facts.append(f"cost {short_cost(plan.cost, 4)}")
    if plan.risk.certified is not None:
        sign = "≤" if plan.risk.certified <= plan.risk.bound else ">"
        risk, bound = bound_texts(min(plan.risk.certified, 1.0), plan.risk.bound)
        # Below this a bound says "none": its digits would only look like something.
        risk = "< 1e-12" if plan.risk.certified < 1e-12 <= plan.risk.bound else risk
        facts.append(f"risk {risk} {sign} {bound}")
    if not details:
        return " · ".join(facts)
    if "total" in plan.seconds:
        facts.append(f"{plan.seconds['total']:.2g} s")
    # Alone, a record that begins with "optimal" would read as a verdict.
    planner = f"planner: {plan.planner}"
    line = " · ".join([*facts, planner])
    if len(line) <= _LINE_CHARACTERS:
        return line
    return "\n".join([" · ".join(facts), textwrap.fill(planner, _LINE_CHARACTERS)])


def alert_text(plan: Plan) -> str | None:
    """Return what must not be overlooked, or None."""
    if not plan.trajectories:
        return "no plan"
    certified = plan.risk.certified
    if certified is not None and certified > plan.risk.bound:
        risk, bound = bound_texts(certified, plan.risk.bound)
        return f"certificate {risk} exceeds the risk bound {bound}"
    return None


def draw_title(ax: Axes, plan: Plan, *, details: bool = True, headline: str | None = None) -> None:
    """Write headline, facts and, in red, what is wrong above the axes.

    Parameters
    ----------
    ax : Axes
        Above which.
    plan : Plan
        What is drawn.
    details : bool
        Whether how the plan was made is told, too.
    headline : str or None
        First line; None is the scenario's name.
    """
    blocks = _blocks(plan, details=details)
    # The title's empty last lines make room for the smaller lines below it, which no layout
    # engine would otherwise see.
    below = "\n" * (num_title_lines(plan, details=details) - 1)
    write_headline(ax, plan.scenario.name if headline is None else headline, below)
    offset = 3.0
    for gid, text, color in reversed(blocks):
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
            gid=gid,
        )
        offset += 1.35 * LABEL_SIZE * len(text.splitlines())


def draw_headline(figure: Figure | SubFigure, text: str) -> None:
    """Write a text above all panels of a figure.

    Parameters
    ----------
    figure : Figure or SubFigure
        Above whose panels.
    text : str
        One line or several.
    """
    figure.suptitle(
        text, x=_LEFT, ha="left", fontsize=TITLE_SIZE, fontweight="bold", parse_math=False
    )


def draw_headlines(
    figure: Figure | SubFigure, plan: Plan, *, details: bool = True, headline: str | None = None
) -> None:
    """Write the same above all panels of a figure.

    Parameters
    ----------
    figure : Figure or SubFigure
        Above whose panels.
    plan : Plan
        What is drawn.
    details : bool
        Whether how the plan was made is told, too.
    headline : str or None
        First line; None is the scenario's name.
    """
    name = plan.scenario.name if headline is None else headline
    first = figure_headline(figure, name)
    below = "\n" * (num_title_lines(plan, details=details) - 1)
    draw_headline(figure, first + below)
    drop = _ABOVE + 1.35 * TITLE_SIZE
    for gid, text, color in _blocks(plan, details=details):
        lower = ScaledTranslation(0.0, -drop / 72.0, figure.dpi_scale_trans)
        figure.text(
            _LEFT, 1.0, text, fontsize=LABEL_SIZE, color=color, va="top", gid=gid,
            transform=figure.transSubfigure + lower,
        )  # fmt: skip
        drop += 1.35 * LABEL_SIZE * len(text.splitlines())


def _blocks(plan: Plan, *, details: bool) -> list[tuple[str, str, str]]:
    """Return id, text and color of what stands below the headline, from the top down."""
    alert, facts = alert_text(plan), subtitle(plan, details=details)
    blocks = [("facts", facts, MUTED)] if facts else []
    if alert is not None:
        blocks.append(("alert", textwrap.fill(alert, _ALERT_CHARACTERS), ALERT))
    if not plan.trajectories:
        why = textwrap.wrap(plan.explanation or plan.status.sentence, _LINE_CHARACTERS)
        lines = [*why[:_MOST_LINES]]
        if len(why) > _MOST_LINES:
            lines[-1] += " …"
        blocks.append(("explanation", "\n".join(lines), MUTED))
    return blocks
