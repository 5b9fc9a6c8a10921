"""Plans that the server keeps."""

from __future__ import annotations

import numpy as np

from radmpc.model.plan import Plan
from radmpc.records import dataclass, field
from radmpc.serving.protocol import PlanSummary, PlanView, Remark, TrailsView
from radmpc.serving.views.plan import plan_summary, plan_view

__all__ = ["KeptPlan"]


@dataclass(slots=True, eq=False)
class KeptPlan:
    """A plan, and what was made of it.

    Attributes
    ----------
    number : str
        By which pages name it.
    document : str
        The document that it is of.
    plan : Plan
        Also one without trajectories.
    summary : PlanSummary
        The same in few words.
    remarks : tuple of Remark
        Why there is no better one.
    search : str or None
        Which search found it; None was read from a file.
    is_final : bool
        Whether it is what a search ended with.
    trails : dict
        Samples by how many and by seed.
    """

    number: str
    document: str
    plan: Plan
    summary: PlanSummary
    remarks: tuple[Remark, ...] = ()
    search: str | None = None
    is_final: bool = True
    trails: dict[tuple[int, int], TrailsView] = field(default_factory=dict)
    _view: PlanView | None = None

    @classmethod
    def of(
        cls,
        number: str,
        document: str,
        plan: Plan,
        revision: int,
        *,
        remarks: tuple[Remark, ...] = (),
        search: str | None = None,
        is_final: bool = True,
    ) -> KeptPlan:
        """Return a plan to keep.

        Parameters
        ----------
        number, document, plan, remarks, search, is_final
            As in the attributes.
        revision : int
            Of the document that it is of.
        """
        summary = plan_summary(plan, number, revision)
        return cls(number, document, plan, summary, remarks, search, is_final)

    def is_of_same_paths(self, plan: Plan) -> bool:
        """Whether another plan steers all vehicles alike, with the same certificate."""
        ours, theirs = self.plan.trajectories, plan.trajectories
        return (
            len(ours) == len(theirs)
            and self.plan.risk.certified == plan.risk.certified
            and all(
                np.array_equal(a.controls, b.controls) for a, b in zip(ours, theirs, strict=True)
            )
        )

    def view(self) -> PlanView:
        """Return the plan as pages draw it; made once."""
        if self._view is None:
            self._view = plan_view(self.plan, self.summary, None, self.remarks)
        return self._view
