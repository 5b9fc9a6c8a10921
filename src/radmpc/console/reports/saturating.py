"""How likely controls are to saturate, in words."""

from __future__ import annotations

from rich.text import Text

__all__ = ["saturation_line", "saturation_warning"]

_SMALL = 0.1
"""Share of the risk bound up to which saturation is small against it."""


def saturation_warning(bound: float, saturation: float) -> str | None:
    """Return what to think of saturation where it is not small against the risk bound.

    Parameters
    ----------
    bound : float
        The risk bound.
    saturation : float
        Upper bound on the probability that any control saturates.

    Returns
    -------
    str or None
        One sentence; None where it is small.
    """
    if saturation <= _SMALL * bound:
        return None
    return (
        f"feedback may ask for more control than there is in up to {100.0 * saturation:.3g} % of "
        "missions, and the certificate speaks of those in which it does not: raise control_sigmas "
        "or control_limit, or soften the gain"
    )


def saturation_line(bound: float, saturation: float, rate: float | None = None) -> Text | str:
    """Return the bound on saturation, what a simulation saw of it, and a warning.

    Parameters
    ----------
    bound : float
        Risk bound Δ.
    saturation : float
        Upper bound on the probability that a control saturates.
    rate : float or None
        Share of samples in which one does; None without a simulation.
    """
    if saturation == 0.0:
        return "none: no control can reach its limit"
    text = f"at most {saturation:.3g}"
    if rate is not None:
        text += f", simulated {rate:.4g}"
    warning = saturation_warning(bound, saturation)
    return text if warning is None else Text(f"{text}: {warning}", style="yellow")
