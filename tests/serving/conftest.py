"""Pages without a browser: they call over the socket of an application without a port."""

from __future__ import annotations

from pathlib import Path

import pytest
from served import Site, wait_for_all

from radmpc.serving.processes.crew import Crew


@pytest.fixture(scope="module", autouse=True)
def servers():
    """Wait for the ends of servers, once for all of a file."""
    yield
    wait_for_all()


@pytest.fixture
def quiet_crew(monkeypatch):
    """Start no process: nothing is looked at before it is planned, nothing is planned."""
    monkeypatch.setattr(Crew, "prepare", lambda self: None)
    monkeypatch.setattr(Crew, "run", _no_run)


async def _no_run(self, job, *args, seconds, listener=None):
    raise AssertionError(f"{job} would start a process")


@pytest.fixture
def site(tmp_path: Path, quiet_crew, monkeypatch):
    """Serve an empty folder."""
    monkeypatch.setattr("radmpc.serving.desk.desk.Desk.look_at", lambda self, document: None)
    with Site(tmp_path) as served:
        yield served
