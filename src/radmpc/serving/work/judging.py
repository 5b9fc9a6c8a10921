"""A plan from a file, judged anew: what a file says of itself is no certificate."""

from __future__ import annotations

from dataclasses import replace

from radmpc.errors import ScenarioError
from radmpc.model.plan import Plan, Risk
from radmpc.referee import certify
from radmpc.serving.work.control import Control

__all__ = ["judged"]


def judged(control: Control, plan: Plan) -> Plan:
    """Return a plan with the referee's own certificate and ledger.

    Parameters
    ----------
    control : Control
        Told nothing.
    plan : Plan
        As its file has it.

    Raises
    ------
    ScenarioError
        If the plan is not what it says: its paths do not follow from its controls, limits are
        exceeded.
    """
    del control
    said = certify(replace(plan, risk=Risk(plan.risk.bound)))
    if said.problems:
        raise ScenarioError("; ".join(said.problems[:3]))
    risk = Risk(plan.risk.bound, said.certified, said.ledger, plan.risk.price, said.saturation)
    return replace(plan, risk=risk)
