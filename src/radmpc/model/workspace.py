"""The box that vehicles must stay in."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Frozen, Vector, as_vector
from radmpc.errors import ScenarioError
from radmpc.ranges import sized
from radmpc.records import dataclass

__all__ = ["Workspace"]


@dataclass(frozen=True, slots=True, eq=False)
class Workspace(Frozen):
    """The box that holds every vehicle's center; leaving it counts toward the risk bound.

    Attributes
    ----------
    lower, upper : (d,) array
        Corners [m].

    Examples
    --------
    >>> import radmpc
    >>> radmpc.Workspace([0.0, 0.0], [24.0, 16.0])
    Workspace(lower=array([0., 0.]), upper=array([24., 16.]))
    """

    lower: Vector
    upper: Vector

    if TYPE_CHECKING:  # what it takes is wider than what it holds

        def __init__(self, lower: npt.ArrayLike, upper: npt.ArrayLike) -> None: ...

    def __post_init__(self) -> None:
        """Freeze the corners and check their order."""
        lower = sized(as_vector(self.lower, path=("min",)), ("min",))
        object.__setattr__(self, "lower", lower)
        upper = sized(as_vector(self.upper, lower.size, ("max",)), ("max",))
        object.__setattr__(self, "upper", upper)
        if not np.all(self.lower < self.upper):
            raise ScenarioError(
                f"min must be below max on every axis, got {self.lower.tolist()} "
                f"and {self.upper.tolist()}"
            )
