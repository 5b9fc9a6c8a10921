"""Plans from files on their way past the referee: pages see how far it is, and may end it."""

from __future__ import annotations

import asyncio

from radmpc.model.plan import Plan
from radmpc.serving.desk.desk import Desk
from radmpc.serving.failures import CallError

__all__ = ["judged", "limit_of", "stop_judging"]

_SECONDS = 60.0
"""Seconds of a processor that any plan may take [s]."""

_EACH = 1e-4
"""More of them for two things at a step [s]: about fifty times what it takes."""


async def judged(desk: Desk, plan: Plan, name: str) -> Plan | None:
    """Return a plan with the referee's own certificate.

    What it may take is counted in seconds of a processor, as its worker tells them: a machine that
    is busy with something else makes no plan worse.

    Parameters
    ----------
    desk : Desk
        Its pages receive the progress.
    plan : Plan
        As its file has it.
    name : str
        The file, as the page calls it.

    Returns
    -------
    Plan or None
        None if somebody has ended it.

    Raises
    ------
    CallError
        If it takes too long, or the plan is not what it says.
    """
    limit = limit_of(plan)
    spent = 0.0

    def tell(*, is_over: bool = False) -> None:
        state = {"file": name, "vehicles": plan.scenario.num_vehicles, "seconds": spent}
        desk.tell({"event": "judging", "state": {**state, "limit": limit, "isOver": is_over}})

    def hear(kind: str, news: float) -> None:
        nonlocal spent
        del kind
        spent = news
        tell()
        if spent > limit:
            job.cancel()

    async def work() -> Plan:
        async with desk.crew.worker() as worker:
            found: Plan = await worker.run("judge", plan, listener=hear)
            return found

    job = asyncio.ensure_future(work())
    desk.judging[name] = job
    try:
        return await asyncio.shield(job)
    except asyncio.CancelledError:
        if not job.cancelled():
            job.cancel()  # it is the server that ends
            raise
        if spent > limit:
            text = f"{name}: the referee took more than {limit:.0f} s of a processor"
            raise CallError("limit", text) from None
        return None
    finally:
        if desk.judging.get(name) is job:
            del desk.judging[name]
        if spent > 0.0:
            tell(is_over=True)


def limit_of(plan: Plan) -> float:
    """Return the seconds of a processor that the referee may take for a plan [s].

    Parameters
    ----------
    plan : Plan
        Each vehicle meets all others and every obstacle, at every step.
    """
    scenario = plan.scenario
    things = scenario.num_vehicles + len(scenario.obstacles)
    return _SECONDS + _EACH * scenario.num_vehicles * things * scenario.horizon


def stop_judging(desk: Desk, name: str) -> None:
    """End the judging of a file's plan, if it is under way.

    Parameters
    ----------
    desk : Desk
        Where.
    name : str
        The file, as the page calls it.
    """
    job = desk.judging.get(name)
    if job is not None:
        job.cancel()
