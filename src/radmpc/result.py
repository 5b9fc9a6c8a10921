"""What planning returns, for people and programs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from radmpc.errors import NoPlanError
from radmpc.model.plan import Coupling, Plan, Status
from radmpc.planners.draft import Event, Step
from radmpc.referee import Certificate

__all__ = ["Result"]


@dataclass(frozen=True, slots=True, eq=False)
class Result:
    """The answer to `radmpc.plan`.

    Attributes
    ----------
    record : Plan
        What a plan file holds, also where no plan was found.
    certificate : Certificate or None
        The referee's word on the plan.
    steps : tuple of Step
        Every solve, in order.
    events : tuple of Event
        Subproblems without a solution on the way.
    """

    record: Plan
    certificate: Certificate | None
    steps: tuple[Step, ...] = ()
    events: tuple[Event, ...] = ()

    @property
    def plan(self) -> Plan | None:
        """The plan, or None."""
        return self.record if self.record.trajectories else None

    @property
    def status(self) -> Status:
        """How planning ended."""
        return self.record.status

    @property
    def cost(self) -> float | None:
        """``Σ weight · ‖u‖₁``."""
        return self.record.cost

    @property
    def lower_bound(self) -> float | None:
        """Proven least cost, where there is a proof."""
        return self.record.lower_bound

    @property
    def sets(self) -> tuple[tuple[str, ...], ...]:
        """Who was planned together."""
        return self.record.sets

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """Why they were."""
        return self.record.couplings

    @property
    def seconds(self) -> Mapping[str, float]:
        """Seconds per stage and ``total``."""
        return self.record.seconds

    @property
    def explanation(self) -> str | None:
        """Why there is no plan."""
        return self.record.explanation

    @property
    def is_certified(self) -> bool:
        """Whether there is a plan and the referee holds it to be within Δ."""
        return self.certificate is not None and self.certificate.holds

    def require(self) -> Plan:
        """Return the plan.

        Returns
        -------
        Plan
            As in `plan`.

        Raises
        ------
        NoPlanError
            If there is none; the message explains why.
        """
        if self.plan is None:
            raise NoPlanError(self.explanation or self.status.sentence)
        return self.plan
