"""A study of a few seconds."""

from __future__ import annotations

import pytest
from studies import small, smallest

from radmpc.experiments.study import (
    Journal,
    read_rows,
    run_study,
)


@pytest.fixture(scope="session")
def rows(tmp_path_factory):
    path = tmp_path_factory.mktemp("study") / "rows.jsonl"
    with Journal.opened(path) as journal:
        run_study(small(), journal)
    return read_rows(path)


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """What a run of the smallest study writes."""
    path = tmp_path_factory.mktemp("smallest") / "rows.jsonl"
    with Journal.opened(path) as journal:
        run_study(smallest(), journal)
    return path.read_bytes()
