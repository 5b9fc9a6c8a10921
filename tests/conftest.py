"""Long lists of cases: every check runs a sample, `make nightly` all of them."""

from __future__ import annotations

import gc

import pytest

from sampling import IS_THOROUGH, SEED, drawn

# What is imported and collected lives to the end: looking through it for garbage would find none,
# again and again, which is a fifth of the seconds of collecting and a twentieth of every test's.
gc.disable()


def pytest_collection_finish() -> None:
    """Look for garbage from here on, among what tests make."""
    gc.freeze()
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
