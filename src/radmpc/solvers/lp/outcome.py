"""How a linear program ended, and how its rows and columns are numbered."""

from __future__ import annotations

from enum import Enum

import numpy as np
import numpy.typing as npt

__all__ = ["NO_NUMBERS", "NO_VALUES", "LpOutcome", "Numbers"]

Numbers = npt.NDArray[np.int32]
"""Row and column numbers as the solvers take them."""

NO_NUMBERS: Numbers = np.zeros(0, dtype=np.int32)
NO_VALUES = np.zeros(0)


class LpOutcome(Enum):
    """How a linear program ended."""

    OPTIMAL = "optimal"
    INFEASIBLE = "infeasible"
    CUTOFF = "worse than the cutoff"
    FAILED = "the solver found no answer"
