"""What a peer is asked and what it gives back."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = ["Answer", "Request"]


@dataclass(frozen=True, slots=True)
class Request:
    """One problem, by name: small enough for one line of JSON.

    Attributes
    ----------
    family : str
        One of the worker's families.
    size : int
        Fleet size N.
    seed : int
        Seed of the draw, and of a peer's own random choices.
    cap : float
        Seconds for building and solving.
    gap : float
        Relative gap at which a solver that proves something may stop.
    """

    family: str
    size: int
    seed: int
    cap: float
    gap: float


@dataclass(frozen=True, slots=True, eq=False)
class Answer:
    """How a peer ended.

    Attributes
    ----------
    status : str
        ``optimal`` (proven within the gap for the peer's own model), ``feasible``,
        ``infeasible``, ``limit``, ``too large``, ``not modeled`` or ``failed``.
    controls : tuple of (T, m) array or None
        Nominal controls per vehicle; None without a plan.
    note : str
        What else is worth knowing, one line.
    """

    status: str
    controls: tuple[npt.NDArray[np.float64], ...] | None = None
    note: str = ""
