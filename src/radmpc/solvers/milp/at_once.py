"""Mixed-integer programs solved at once, on all processors."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor, wait

from radmpc.records import replace
from radmpc.solvers.milp.model import Backend, MilpAnswer, MilpModel
from radmpc.solvers.solution import Limits
from radmpc.system.processors import num_processors

__all__ = ["minimized_at_once"]

_EACH = 2
"""Models that share a processor [-]: of three on two the hardest, whichever that is, does not have
to wait until another is done. `parking` is left at 8 to 24 % by faces within 60 s with one each."""

_POLL_SECONDS = 0.1
"""How often a stop is passed on [s]."""


def minimized_at_once(
    backend: Backend, models: Sequence[MilpModel], gap: float, limits: Limits
) -> list[MilpAnswer]:
    """Solve models that have nothing to do with each other, each in a thread of its own.

    Solvers work without Python's lock. Each model may take its share of the time that is left when
    it begins: one that needs less leaves it to those after it.

    Parameters
    ----------
    backend : Backend
        What solves them.
    models : sequence of MilpModel
        The models.
    gap : float
        Relative gap at which each is solved [-].
    limits : Limits
        When to stop all of them.

    Returns
    -------
    list of MilpAnswer
        In the order of the models.
    """
    count = max(1, min(len(models), _EACH * num_processors()))
    # Whoever asked for a stop is asked by this thread alone.
    is_over = threading.Event()
    own = replace(limits, is_stopped=is_over.is_set)

    def minimized(number: int) -> MilpAnswer:
        share = own.seconds_left * count / (len(models) - number)
        return backend.minimize(models[number], gap, own.within(share))

    with ThreadPoolExecutor(count) as pool:
        try:
            futures = [pool.submit(minimized, number) for number in range(len(models))]
            waiting = set(futures)
            while waiting:
                waiting = wait(waiting, _POLL_SECONDS).not_done
                if limits.reached:
                    is_over.set()
            return [future.result() for future in futures]
        finally:
            is_over.set()
