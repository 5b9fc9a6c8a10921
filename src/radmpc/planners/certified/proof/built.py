"""What is searched of a set in a proof."""

from __future__ import annotations

from hashlib import blake2b

import numpy as np

from radmpc.arrays import Vector
from radmpc.model.scenario import Scenario
from radmpc.program.program import DisjunctiveProgram
from radmpc.program.relaxed.left_out import Vicinity
from radmpc.records import dataclass
from radmpc.solvers.priced.rating import Rater

__all__ = ["Built"]


@dataclass(frozen=True, slots=True, eq=False)
class Built:
    """What is searched of a set.

    Attributes
    ----------
    scenario : Scenario
        The vehicles alone, with what they may meet.
    program : DisjunctiveProgram
        Their relaxation, or the program of their faces.
    rater : Rater
        The same, laid out for rating.
    left_out : tuple of Vicinity
        Hazards in reach of which the program says nothing.
    """

    scenario: Scenario
    program: DisjunctiveProgram
    rater: Rater
    left_out: tuple[Vicinity, ...] = ()

    def fingerprint(self) -> bytes:
        """Return what programs have in common only if their alternatives are the same."""
        program, rows = self.program, self.program.rows
        normals = rows.normals.indices, rows.normals.data
        parts = program.avoidance_starts, rows.offsets, rows.deviations, *normals
        found = blake2b(digest_size=16)
        for part in parts:
            found.update(np.ascontiguousarray(part).data)
        return found.digest()

    def is_close(self, z: Vector) -> bool:
        """Tell whether a point comes close to what was left out."""
        if not self.left_out:
            return False
        # All outputs, since SciPy takes longer to part a matrix than to multiply it.
        at = self.program.outputs @ z + self.program.constant
        paths = at[: self.program.num_positions].reshape(
            self.scenario.num_vehicles, -1, self.scenario.dimension
        )
        return any(vicinity.is_close(paths) for vicinity in self.left_out)
