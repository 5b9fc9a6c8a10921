from __future__ import annotations

import os
import subprocess
import sys
import zipfile
from email.parser import Parser
from pathlib import Path

import pytest

import radmpc

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parent.parent
PAGE = ROOT / "src" / "radmpc" / "serving" / "bundle"


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel, built with what the development environment has."""
    folder = tmp_path_factory.mktemp("wheel")
    # The page comes along where `make page` has built it; here nothing is fetched.
    wish = "" if PAGE.is_dir() else "none"
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "wheel", "--quiet"]
    options = ["--no-deps", "--no-build-isolation", "--no-index"]
    subprocess.run(
        [*pip, *options, "--wheel-dir", folder, ROOT],
        check=True,
        timeout=300,
        env={**os.environ, "RADMPC_PAGE": wish},
    )
    (built,) = folder.glob("*.whl")
    return built


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the package as the wheel has it, far from the checkout."""
    folder = tmp_path_factory.mktemp("installed")
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "install", "--quiet"]
    options = ["--no-deps", "--no-index", "--no-compile", "--target", folder]
    subprocess.run([*pip, *options, wheel], check=True, timeout=300)
    return folder


def run(installed: Path, cwd: Path, *words: str) -> str:
    """Run Python with the installed copy; it comes before the checkout's."""
    environment = {**os.environ, "PYTHONPATH": str(installed), "PYTHONWARNINGS": "error"}
    done = subprocess.run(
        [sys.executable, "-P", *words],
        cwd=cwd,
        env=environment,
        check=False,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_wheel_is_of_this_version_and_says_what_it_was_compiled_for(wheel: Path) -> None:
    name, version, *tag = wheel.stem.split("-")
    assert (name, version) == ("radmpc", radmpc.__version__)
    with zipfile.ZipFile(wheel) as archive:
        is_compiled = "radmpc/solvers/_compiled.abi3.so" in archive.namelist()
        assert not [name for name in archive.namelist() if name.endswith((".c", ".h"))]
    assert tag[:2] == (["cp311", "abi3"] if is_compiled else ["py3", "none"])


def test_the_wheel_holds_package_data_and_license_and_nothing_else(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    info = f"radmpc-{radmpc.__version__}.dist-info"
    wanted = {"radmpc/py.typed", "radmpc/data/harbor.yaml", f"{info}/licenses/LICENSE"}
    assert wanted <= set(names)
    assert {name.split("/")[0] for name in names} == {"radmpc", info}
    code = {path.relative_to(ROOT / "src").as_posix() for path in ROOT.glob("src/**/*.py")}
    assert {name for name in names if name.endswith(".py")} == code


@pytest.mark.skipif(not PAGE.is_dir(), reason="no bundle here: make page")
def test_the_wheel_holds_the_whole_page(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
    files = {path.relative_to(PAGE).as_posix() for path in PAGE.rglob("*") if path.is_file()}
    assert {"index.html", "page.js", "NOTICE"} <= files
    assert {f"radmpc/serving/bundle/{name}" for name in files} <= names


def test_the_wheel_says_what_it_needs_and_who_may_use_it(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        text = archive.read(f"radmpc-{radmpc.__version__}.dist-info/METADATA").decode()
    metadata = Parser().parsestr(text)
    assert metadata["License-Expression"] == "MIT"
    assert metadata["Requires-Python"] == ">=3.11"
    assert metadata["Author"] == "The radmpc authors"
    stated = set(metadata.get_all("Classifier") or [])
    assert {"Typing :: Typed", "Topic :: Scientific/Engineering"} <= stated
    assert {f"Programming Language :: Python :: 3.{minor}" for minor in (11, 12, 13)} <= stated
    needed = [line for line in metadata.get_all("Requires-Dist") or [] if "extra ==" not in line]
    assert {"highspy", "numpy", "typer"} <= {line.split(">")[0] for line in needed}


def test_the_installed_copy_is_the_one_that_runs(installed: Path, tmp_path: Path) -> None:
    place = run(installed, tmp_path, "-c", "import radmpc; print(radmpc.__file__)").strip()
    assert Path(place) == installed / "radmpc" / "__init__.py"


def test_the_installed_copy_tells_its_version(installed: Path, tmp_path: Path) -> None:
    said = run(installed, tmp_path, "-m", "radmpc", "--version")
    assert said == f"radmpc {radmpc.__version__}\n"


@pytest.mark.nightly
def test_the_demo_runs_outside_the_checkout(installed: Path, tmp_path: Path) -> None:
    said = run(installed, tmp_path, "-m", "radmpc", "demo", "--out", ".")
    assert "harbor: 5 vehicles" in said
    assert "within the bound 0.05" in said
    assert "radmpc verify harbor.plan.json" in said
    made = sorted(path.name for path in tmp_path.iterdir())
    assert made == ["harbor.plan.json", "harbor.png", "harbor.yaml"]


def test_the_script_of_the_wheel_is_there(installed: Path) -> None:
    script = installed / "bin" / "radmpc"
    assert script.stat().st_mode & 0o111
