"""Work on an executor: answers in order, and nothing goes on once nobody asks."""

from __future__ import annotations

import os
import threading
import time
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import closing

import pytest

from radmpc.console.running.cluster import _Lossless
from radmpc.planners.executing import in_order, run_elsewhere
from radmpc.solvers.solution import Limits


def test_answers_come_in_order_whoever_is_done_first() -> None:
    second_is_done = threading.Event()

    def work(task: int, limits: Limits) -> int:
        del limits
        if task == 1:
            second_is_done.set()
        else:
            assert second_is_done.wait(10.0)
        return task

    with ThreadPoolExecutor(2) as pool:
        assert list(in_order(work, [0, 1], Limits(), pool)) == [0, 1]


def test_what_no_worker_has_begun_is_done_here_the_last_first() -> None:
    first_has_begun, all_others_are_done = threading.Event(), threading.Event()
    here: list[int] = []
    told: list[tuple[int, int]] = []

    def work(task: int, limits: Limits) -> int:
        del limits
        if threading.current_thread() is threading.main_thread():
            assert first_has_begun.wait(10.0)
            here.append(task)
        elif task == 0:
            first_has_begun.set()
            assert all_others_are_done.wait(10.0)
        if task == 1:
            all_others_are_done.set()
        return 10 * task

    with ThreadPoolExecutor(1) as pool:
        answers = run_elsewhere(
            work, range(5), Limits(), pool, lambda done, total: told.append((done, total))
        )
    assert answers == [0, 10, 20, 30, 40]
    assert here == [4, 3, 2, 1]
    assert [done for done, _ in told] == sorted(done for done, _ in told)
    assert told[-1] == (5, 5)


def test_nothing_is_taken_from_executors_whose_running_work_can_be_canceled() -> None:
    class Cluster(Executor):
        """Hands work to a thread by futures that never say that they run, as dask's do."""

        def submit(self, work, /, *args, **kwargs):
            future: Future = Future()
            thread = threading.Thread(target=lambda: future.set_result(work(*args, **kwargs)))
            thread.start()
            return future

    here: list[int] = []

    def work(task: int, limits: Limits) -> int:
        del limits
        time.sleep(0.02)
        if threading.current_thread() is threading.main_thread():
            here.append(task)
        return task

    answers = run_elsewhere(work, range(4), Limits(), Cluster(), lambda done, total: None)
    assert answers == [0, 1, 2, 3]
    assert here == []


def test_once_nobody_asks_no_task_begins_and_those_under_way_are_stopped() -> None:
    begun: list[int] = []

    def work(task: int, limits: Limits) -> int:
        begun.append(task)
        while task > 0 and not limits.reached:
            time.sleep(0.001)
        return task

    with ThreadPoolExecutor(1) as pool:
        with closing(in_order(work, [0, 1, 2, 3], Limits(), pool)) as answers:
            assert next(answers) == 0
        # Left alone, the second would wait for ever.
        assert begun in ([0], [0, 1])


def test_a_limit_that_is_reached_ends_what_is_under_way() -> None:
    def work(task: int, limits: Limits) -> bool:
        del task
        while not limits.reached:
            time.sleep(0.001)
        return True

    with ThreadPoolExecutor(1) as pool:
        assert list(in_order(work, [0], Limits(time.monotonic() + 0.05), pool)) == [True]


def _die(task: int, limits: Limits) -> int:
    del limits
    if task == 1:
        os._exit(1)
    return task


@pytest.mark.slow
def test_a_task_whose_worker_dies_has_no_answer() -> None:
    with ProcessPoolExecutor(1) as pool:
        first, *others = in_order(_die, [0, 1, 2], Limits(), pool)
    assert first == 0
    assert others == [None, None]


def test_a_task_on_a_cluster_is_given_up_without_a_word(caplog: pytest.LogCaptureFixture) -> None:
    begun, may_end, ran = threading.Event(), threading.Event(), []

    def work() -> None:
        begun.set()
        assert may_end.wait(10.0)

    with ThreadPoolExecutor(1) as pool:
        executor = _Lossless(pool)
        running, queued = executor.submit(work), executor.submit(ran.append, 1)
        assert begun.wait(10.0)
        assert running.cancel()
        assert queued.cancel()
        may_end.set()
    assert ran == []
    assert caplog.records == []
