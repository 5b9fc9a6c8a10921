"""Long lists of cases: every check runs a sample, `make nightly` all of them."""

from __future__ import annotations

import gc
from collections.abc import Iterator

import pytest

from sampling import IS_THOROUGH, SEED, drawn


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
    """Leave out what is marked nightly, and of `sampled` lists all cases but a sample."""
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
    items[:] = kept
    config.hook.pytest_deselected(items=left)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say which sample was run."""
    which = "all cases" if IS_THOROUGH else f"a sample of the cases, RADMPC_SAMPLE={SEED}"
    terminalreporter.write_line(f"of long lists: {which}")
