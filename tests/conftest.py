"""Long lists of cases, of which every check runs a sample; and what makes tests quick."""

from __future__ import annotations

import functools
import gc
from collections.abc import Iterator

import pytest
import typer.testing

from sampling import IS_THOROUGH, SEED, drawn


def pytest_configure() -> None:
    """Build the command line once: it holds nothing of a run, and takes as long as a short one."""
    typer.testing._get_command = functools.cache(typer.testing._get_command)


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Iterator[object]:
    """Look for no garbage in what is imported and collected: it lives to the end.

    Looking through it again and again is a fifth of the seconds of collecting and a twentieth of
    those of tests. These look for theirs less often than programs do.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.set_threshold(20_000, 20, 20)
        gc.enable()


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what is marked nightly, and of `sampled` lists all but a sample; order the rest."""
    # Whoever names a case wants it run.
    if IS_THOROUGH or any("::" in word for word in config.args):
        return
    lists: dict[str, list[str]] = {}
    for item in items:
        lists.setdefault(item.nodeid.partition("[")[0], []).append(item.nodeid)
    kept, left = [], []
    for item in items:
        sample, cases = item.get_closest_marker("sampled"), lists[item.nodeid.partition("[")[0]]
        is_left = item.get_closest_marker("nightly") or (
            sample and item.nodeid not in drawn(cases, sample.args[0], SEED)
        )
        (left if is_left else kept).append(item)
    # What waits begins, beside all that a check does besides.
    items[:] = sorted(kept, key=lambda item: item.get_closest_marker("waits") is None)
    config.hook.pytest_deselected(items=left)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say which sample was run."""
    which = "all cases" if IS_THOROUGH else f"a sample of the cases, RADMPC_SAMPLE={SEED}"
    terminalreporter.write_line(f"of long lists: {which}")
