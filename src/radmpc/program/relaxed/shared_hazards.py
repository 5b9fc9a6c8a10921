"""What a vehicle or a pair adds to relaxations of several sets, made once."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from radmpc.arrays import Tensor
from radmpc.program.builder import ProgramBuilder
from radmpc.program.condensed import CondensedModel
from radmpc.program.relaxed.left_out import Vicinity
from radmpc.program.sharing.contribution import Contribution
from radmpc.records import dataclass

__all__ = ["HazardRows", "SharedHazards"]


@dataclass(frozen=True, slots=True, eq=False)
class HazardRows:
    """The rows of the hazards of a vehicle or a pair, and those that are left out.

    Attributes
    ----------
    rows : Contribution
        The rows.
    left_out : tuple of Vicinity
        Hazards in reach without rows; places of vehicles count within the one or the pair.
    """

    rows: Contribution
    left_out: tuple[Vicinity, ...]

    def add_to(self, builder: ProgramBuilder, places: tuple[int, ...]) -> tuple[Vicinity, ...]:
        """Add the rows to the program of more vehicles; return what is left out of that.

        Parameters
        ----------
        builder : ProgramBuilder
            Of that program.
        places : tuple of int
            Where these vehicles are among its.
        """
        self.rows.add_to(builder, places)
        return tuple(vicinity.of_bodies(places) for vicinity in self.left_out)


class SharedHazards:
    """Those that were asked for, to be asked for with the same reach, tails and risk bound."""

    def __init__(self) -> None:
        self._known: dict[tuple[object, ...], HazardRows] = {}

    def of(
        self,
        models: Sequence[CondensedModel],
        around: Tensor | None,
        make: Callable[[], HazardRows],
    ) -> HazardRows:
        """Return the rows of a vehicle or a pair.

        Parameters
        ----------
        models : sequence of CondensedModel
            These vehicles; names tell them apart.
        around : (N, T+1, d) array or None
            Their mean positions in the plan far from which hazards are left out; None is none.
        make : callable
            Called if there are none yet.
        """
        names = (model.vehicle.name for model in models)
        key = *names, None if around is None else around.tobytes()
        if key not in self._known:
            self._known[key] = make()
        return self._known[key]
