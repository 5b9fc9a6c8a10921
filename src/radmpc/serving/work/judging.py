"""A plan from a file, judged anew: what a file says of itself is no certificate."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from radmpc.errors import ScenarioError
from radmpc.model.plan import Plan, Risk
from radmpc.referee import certify
from radmpc.serving.work.control import Control

__all__ = ["judged"]

_EVERY = 0.5
"""Seconds between two pieces of news [s]."""


def judged(control: Control, plan: Plan) -> Plan:
    """Return a plan with the referee's own certificate and ledger.

    Parameters
    ----------
    control : Control
        Receives the time spent so far now and then, as `spent`, in seconds of this processor [s].
    plan : Plan
        As its file has it.

    Raises
    ------
    ScenarioError
        If the plan is not what it says: its paths do not follow from its controls, limits are
        exceeded.
    """
    with _told(control):
        said = certify(replace(plan, risk=Risk(plan.risk.bound)))
    if said.problems:
        raise ScenarioError("; ".join(said.problems[:3]))
    risk = Risk(plan.risk.bound, said.certified, said.ledger, plan.risk.price, said.saturation)
    return replace(plan, risk=risk)


@contextmanager
def _told(control: Control) -> Iterator[None]:
    """Tell how long it takes, while it does."""
    begun, over = time.process_time(), threading.Event()

    def tell() -> None:
        while not over.wait(_EVERY):
            control.tell("spent", time.process_time() - begun)

    thread = threading.Thread(target=tell, daemon=True)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()
