"""Compiled code is made when the package is installed, and may be missing."""

from __future__ import annotations

import importlib.util
import shutil
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

ROOT = Path(__file__).parent.parent.parent
MADE = Path("src/radmpc/solvers/_compiled.abi3.so")
SAID = "no compiled simplex method, HiGHS solves all linear programs: "


class Checkout:
    """A folder with a source file, and what installing from there adds and says."""

    def __init__(self, root: Path, source: str) -> None:
        spec = importlib.util.spec_from_file_location("hatch_build_here", ROOT / "hatch_build.py")
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        self.said: list[str] = []
        self.root = root
        folder = root / MADE.parent / "compiled"
        folder.mkdir(parents=True)
        (folder / "module.c").write_text(source, encoding="utf-8")
        app = SimpleNamespace(display_warning=self.said.append)
        target = SimpleNamespace(PLUGIN_NAME="wheel")
        self.hook = module.BuildHook(str(root), {}, target, None, str(root), "wheel", app)

    def install(self) -> dict[str, object]:
        data: dict[str, object] = {"artifacts": []}
        self.hook.initialize("editable", data)
        return data


@pytest.fixture(autouse=True)
def wish(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever the tests run with, installs are asked for nothing."""
    monkeypatch.delenv("RADMPC_COMPILED", raising=False)
    monkeypatch.delenv("CC", raising=False)


@pytest.fixture
def checkout(tmp_path: Path) -> Checkout:
    return Checkout(tmp_path, "int answer(void) { return 42; }\n")


needs_compiler = pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler here")


@needs_compiler
@pytest.mark.skipif(sys.platform != "linux", reason="compiled on Linux only")
def test_an_install_compiles_once(checkout: Checkout) -> None:
    data = checkout.install()
    made = checkout.root / MADE
    assert made.is_file()
    assert data["artifacts"] == [str(MADE)]
    assert str(data["tag"]).startswith("cp311-abi3-")
    assert data["pure_python"] is False
    first = made.stat().st_mtime_ns
    checkout.install()
    assert made.stat().st_mtime_ns == first
    assert checkout.said == []
    assert {path.name for path in made.parent.iterdir()} == {"compiled", made.name}


def test_without_a_compiler_there_is_a_package_without_and_it_says_so(
    checkout: Checkout, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CC", "no-such-compiler")
    assert checkout.install() == {"artifacts": []}
    assert checkout.said == [SAID + "no-such-compiler: No such file or directory"]


@needs_compiler
def test_a_compiler_that_fails_says_why_and_leaves_nothing(tmp_path: Path) -> None:
    checkout = Checkout(tmp_path, "int answer(void) { return forty_two; }\n")
    assert checkout.install() == {"artifacts": []}
    [said] = checkout.said
    assert said.startswith(SAID + "cc failed: ")
    assert [path.name for path in (tmp_path / MADE.parent).iterdir()] == ["compiled"]


@pytest.mark.skipif(shutil.which("false") is None, reason="no program that fails and says nothing")
@pytest.mark.skipif(sys.platform != "linux", reason="compiled on Linux only")
def test_a_compiler_that_fails_without_a_word_leaves_a_package_without_compiled_code(
    checkout: Checkout, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CC", "false")
    assert checkout.install() == {"artifacts": []}
    assert checkout.said == [SAID + "false failed: exit code 1"]


def test_who_requires_compiled_code_gets_no_package_without(
    checkout: Checkout, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CC", "no-such-compiler")
    monkeypatch.setenv("RADMPC_COMPILED", "required")
    with pytest.raises(RuntimeError, match="no compiled simplex method"):
        checkout.install()


def test_who_wants_no_compiled_code_gets_none(
    checkout: Checkout, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RADMPC_COMPILED", "none")
    assert checkout.install() == {"artifacts": []}
    assert checkout.said == [SAID + "RADMPC_COMPILED=none leaves it out"]
