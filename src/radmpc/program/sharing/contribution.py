"""What a vehicle or a pair adds to programs, wherever these are among a program's vehicles."""

from __future__ import annotations

import numpy as np

from radmpc.program.avoidance import RowBlock
from radmpc.program.builder import ProgramBuilder
from radmpc.program.layout import Label, RiskItem, RiskItems
from radmpc.records import dataclass, replace

__all__ = ["Contribution"]


@dataclass(frozen=True, slots=True, eq=False)
class Contribution:
    """What a vehicle or a pair adds to programs, as `ProgramBuilder` has it of nobody else.

    Attributes
    ----------
    blocks, labels, items : tuple
        Rows, and for each block what they stand for and its risk items.
    presolved_risk, num_presolved, initial_risk, initial
        As in `ProgramBuilder`.
    """

    blocks: tuple[RowBlock, ...]
    labels: tuple[Label, ...]
    items: tuple[RiskItems, ...]
    presolved_risk: float
    num_presolved: int
    initial_risk: float
    initial: tuple[tuple[RiskItem, float], ...]

    @classmethod
    def of(cls, builder: ProgramBuilder) -> Contribution:
        """Return what a builder has collected.

        Parameters
        ----------
        builder : ProgramBuilder
            Of these vehicles alone, from step 0 on.
        """
        return cls(
            tuple(builder.blocks),
            tuple(builder.labels),
            tuple(builder.items),
            builder.presolved_risk,
            builder.num_presolved,
            builder.initial_risk,
            tuple(builder.initial),
        )

    def add_to(self, builder: ProgramBuilder, places: tuple[int, ...]) -> None:
        """Add it to the program of more vehicles.

        Parameters
        ----------
        builder : ProgramBuilder
            Of that program.
        places : tuple of int
            Where these vehicles are among its.
        """
        parts = [builder.parts[place] for place in places]
        size = builder.scenario.dimension * (builder.models[0].horizon + 1)
        begins = [(part.position, size) for part in parts]
        begins += [(part.controls, 2 * part.control_bounds.size) for part in parts]
        outputs = np.concatenate([np.arange(b, b + n, dtype=np.int32) for b, n in begins])
        for block, label, items in zip(self.blocks, self.labels, self.items, strict=True):
            moved = replace(block, entry_outputs=outputs[block.entry_outputs])
            builder.take_rows(moved, label, items)
        builder.presolved_risk += self.presolved_risk
        builder.num_presolved += self.num_presolved
        builder.initial_risk += self.initial_risk
        builder.initial += self.initial
