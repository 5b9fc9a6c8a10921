"""Linear programs of groups that are planned again and again, kept warm while there is room."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from radmpc.planners.certified.turned.linear.alone_lp import plan_alone
from radmpc.planners.certified.turned.linear.given import Places
from radmpc.planners.certified.turned.linear.group_lp import GroupLp
from radmpc.planners.certified.turned.linear.group_plan import GroupPlan
from radmpc.planners.certified.turned.linear.margins import Margins
from radmpc.planners.certified.turned.normals.spaces import HalfSpaces
from radmpc.program.hazards import Hazards
from radmpc.solvers.compiled_code import is_compiled

__all__ = ["Group", "WarmPrograms"]

_WARM = 64
"""Vehicles of linear programs that are kept warm at most [-]: 0.3 to 5 MB for each of them."""

Group = tuple[int, ...]
"""Vehicles that share a linear program."""


class WarmPrograms:
    """The linear programs of groups; those first asked for stay, all others are made anew.

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    programs : mapping of tuple of int to GroupLp
        Those that exist already.
    """

    def __init__(self, hazards: Hazards, programs: Mapping[Group, GroupLp]) -> None:
        self._hazards = hazards
        self._programs = dict(programs)

    def of(self, group: Group) -> GroupLp:
        """Return a group's linear program, kept warm if there is room.

        Groups are asked for in turn: to give up those asked for longest ago would leave none.

        Parameters
        ----------
        group : tuple of int
            Vehicles planned together.
        """
        if group in self._programs:
            return self._programs[group]
        program = GroupLp(self._hazards, group)
        if len(group) + sum(len(known) for known in self._programs) <= _WARM:
            self._programs[group] = program
        return program

    def plan_alone(
        self, vehicle: int, spaces: HalfSpaces, paths: Places, margins: Margins
    ) -> GroupPlan | None:
        """Plan one vehicle that keeps the same clearance everywhere.

        Parameters
        ----------
        vehicle : int
            Its number.
        spaces, paths, margins
            As in `GroupLp.solve`.

        Returns
        -------
        GroupPlan or None
            None where it cannot reach its goal at all.
        """
        if is_compiled():
            return plan_alone(self._hazards, vehicle, spaces, paths, margins)
        return self.of((vehicle,)).solve(spaces, paths, margins)

    def forget_all_but(self, groups: Sequence[Group]) -> None:
        """Give up the linear programs of groups that will not be planned again.

        Parameters
        ----------
        groups : sequence of tuple of int
            Those that will.
        """
        kept = set(groups)
        self._programs = {g: program for g, program in self._programs.items() if g in kept}

    def follow(self, hazards: Hazards, vehicle: int) -> None:
        """Give up the linear programs of a vehicle that changed.

        Parameters
        ----------
        hazards : Hazards
            The fleet from now on, all others as they were.
        vehicle : int
            Its number.
        """
        self._hazards = hazards
        self._programs = {g: program for g, program in self._programs.items() if vehicle not in g}
