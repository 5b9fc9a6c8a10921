"""How likely controls are to saturate, in words."""

from __future__ import annotations

from rich.text import Text

from radmpc.model.plan import Plan

__all__ = ["NOTHING", "saturation_line", "saturation_warning"]

NOTHING = 1e-15
"""Probability below which digits tell nothing [-]."""

_SMALL = 0.1
"""Share of the risk bound up to which saturation is small against it."""


def saturation_warning(plan: Plan, saturation: float) -> str | None:
    """Return what to think of saturation where it is not small against the risk bound.

    Parameters
    ----------
    plan : Plan
        With trajectories: cures are tried on its own controls.
    saturation : float
        Upper bound on the probability that any control saturates.

    Returns
    -------
    str or None
        One sentence; None where it is small.
    """
    most = _SMALL * plan.scenario.risk_bound
    if saturation <= most:
        return None
    from radmpc.planners.cures.saturating import saturation_cure  # noqa: PLC0415 - few need it

    cure = saturation_cure(plan, most)
    return (
        f"feedback may ask for more control than there is in up to {100.0 * saturation:.3g} % of "
        "missions, and the certificate speaks of those in which it does not"
        f"{f'; what helps, as tried on this plan: {cure}' if cure else ''}"
    )


def saturation_line(
    saturation: float,
    rate: float | None = None,
    warning: str | None = None,
    *,
    feeds_back: bool = True,
) -> Text | str:
    """Return the bound on saturation, what a simulation saw of it, and a warning.

    Parameters
    ----------
    saturation : float
        Upper bound on the probability that a control saturates.
    rate : float or None
        Share of samples in which one does; None without a simulation.
    warning : str or None
        What `saturation_warning` says.
    feeds_back : bool
        Whether any vehicle does.
    """
    if saturation == 0.0 and not feeds_back:
        return "none: no control can reach its limit"
    # Gaussian noise has no bound: less than that is rounding, also where nothing is left of it.
    text = f"at most {max(saturation, NOTHING):.3g}"
    if rate is not None:
        text += f", simulated {rate:.4g}"
    return text if warning is None else Text(f"{text}: {warning}", style="yellow")
