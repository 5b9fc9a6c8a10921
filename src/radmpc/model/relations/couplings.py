"""Why vehicles are planned together: the edges of the coupling graph."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from radmpc.records import dataclass

__all__ = ["Coupling", "Reason", "unexplained_sets"]

Reason = Literal["collision", "risk", "blocked", "distance", "share", "range"]

_SURE = 0.995
"""Probability that two digits show as 1 [-]: it should not be read as a number."""


@dataclass(frozen=True, slots=True)
class Coupling:
    """Why two vehicles were planned together: an edge of the coupling graph.

    Attributes
    ----------
    vehicle, other : str
        The two vehicles.
    reason : {'collision', 'risk', 'blocked', 'distance', 'share', 'range'}
        Their plans made apart collide; their risk in the approximation exceeds Ψ (paper, section
        Identifying Couplings); one had no path past the other there; their paths alone come close;
        their shares of Δ by head count were too small; they keep a range.
    value : float or None
        Estimated probability of collision [-] for ``collision`` and ``risk``, closest approach
        of the centers [m] for ``distance``, the range to keep [m] for ``range``, None for the
        others. An estimate for ``collision`` is a sum of bounds and may exceed 1.

    Examples
    --------
    >>> import radmpc
    >>> from radmpc.experiments.families import circle
    >>> plan = radmpc.plan(circle(2), "multi-vehicle", rng=0).require()
    >>> [(one.vehicle, one.other, one.reason) for one in plan.couplings]
    [('v1', 'v2', 'risk')]
    """

    vehicle: str
    other: str
    reason: Reason
    value: float | None = None

    @property
    def is_sure(self) -> bool:
        """Whether the two, planned apart, would collide but for a miracle."""
        return self.reason == "collision" and (self.value or 0.0) >= _SURE

    @property
    def sentence(self) -> str:
        """The reason in words, with both names."""
        pair, value = f"{self.vehicle} and {self.other}", self.value or 0.0
        if self.is_sure:
            return f"{pair} would almost surely collide if planned apart"
        texts: dict[Reason, str] = {
            "collision": f"{pair} would run a risk of {value:.2g} if planned apart",
            "risk": f"{pair} run a risk of {value:.2g} in the approximation",
            "blocked": f"{pair} block each other in the approximation",
            "distance": f"{pair} come within {value:.3g} m if planned apart",
            "share": f"{pair} need more than their shares of the risk bound",
            "range": f"{pair} keep a range of {value:.3g} m",
        }
        return texts[self.reason]


def unexplained_sets(
    sets: Sequence[Sequence[str]], couplings: Sequence[Coupling]
) -> tuple[tuple[str, ...], ...]:
    """Return the sets of several vehicles without a coupling between any two of them.

    A plan made without planning their vehicles apart first has no risk of that to tell.

    Parameters
    ----------
    sets : sequence of sequence of str
        Which vehicles were planned together.
    couplings : sequence of Coupling
        Why they were.
    """
    coupled = {name for coupling in couplings for name in (coupling.vehicle, coupling.other)}
    return tuple(tuple(group) for group in sets if len(group) > 1 and coupled.isdisjoint(group))
