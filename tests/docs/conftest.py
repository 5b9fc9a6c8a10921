"""A folder with the files that the pages speak of."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import pytest
from pages import ROOT

import radmpc
from radmpc.experiments.families import paper

HOOKS = ROOT / "docs" / "hooks"


@pytest.fixture(scope="session")
def made_once(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("pages")
    (folder / "out").mkdir()
    # Any scenario will do, and a small one is planned at once.
    scenario = paper(2, seed=1)
    plan = radmpc.plan(scenario, rng=0).require()
    for name in ("fleet", "out/harbor"):
        radmpc.save_scenario(scenario, folder / f"{name}.yaml")
        radmpc.save_plan(plan, folder / f"{name}.plan.json")
    (folder / "instances").symlink_to(ROOT / "instances")
    return folder


@pytest.fixture
def workbench(made_once: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder in which a page's blocks run."""
    folder = tmp_path / "workbench"
    shutil.copytree(made_once, folder, symlinks=True)
    monkeypatch.chdir(folder)
    small = (folder / "fleet.yaml").read_text(encoding="utf-8")
    monkeypatch.setattr("radmpc.console.commands.demo.demo_text", lambda: small)
    return folder


@pytest.fixture
def hooks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make the hooks of the site importable, as MkDocs does."""
    monkeypatch.setattr(sys, "path", [str(HOOKS), *sys.path])
