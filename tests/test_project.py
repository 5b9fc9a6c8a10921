from __future__ import annotations

import re
import shutil
import subprocess
import tomllib
from importlib.metadata import version
from pathlib import Path

import pytest

import radmpc
from radmpc.experiments.families import paper
from radmpc.version import __version__

ROOT = Path(__file__).parent.parent


def tracked_files() -> list[Path]:
    """Files under version control, or all sources where there is no repository."""
    git = shutil.which("git")
    if git is None or not (ROOT / ".git").exists():
        pytest.skip("not in a repository")
    answer = subprocess.run(
        [git, "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True
    )
    return [ROOT / name for name in answer.stdout.split("\0") if name and (ROOT / name).is_file()]


def texts() -> dict[Path, str]:
    """Tracked files that hold text."""
    found = {}
    for path in tracked_files():
        if path != Path(__file__):
            content = path.read_bytes()
            if b"\0" not in content:
                found[path] = content.decode("utf-8")
    return found


def test_the_installed_version_is_that_of_the_source() -> None:
    assert version("radmpc") == __version__


def test_no_tracked_file_names_a_registry() -> None:
    option = re.compile(r"--(extra-)?index-url|--find-links|--trusted-host|^\s*registry\s*=", re.M)
    address = re.compile(r"https?://[^\s)\"'>]*(pypi|/simple\b|artifactory|nexus)", re.I)
    guilty = [
        path.relative_to(ROOT).as_posix()
        for path, text in texts().items()
        if option.search(text) or address.search(text)
    ]
    assert guilty == []


def test_no_tracked_file_names_a_path_of_one_machine() -> None:
    local = re.compile(r"(?<![\w.])/(home|root|Users|work)/")
    guilty = [p.relative_to(ROOT).as_posix() for p, text in texts().items() if local.search(text)]
    assert guilty == []


def test_every_requirement_is_pinned_exactly() -> None:
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    pins = [line for line in lines if line and not line.startswith("#")]
    assert all(re.fullmatch(r"[\w.-]+==[\w.]+", pin) for pin in pins)
    names = {pin.split("==")[0].lower() for pin in pins}
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = [item for group in project["optional-dependencies"].values() for item in group]
    needed = {
        re.split(r"[<>=\[ ]", item)[0].lower()
        for item in [*project["dependencies"], *extras]
        if not item.startswith("radmpc[")
    }
    assert needed - names == set()


def test_the_commands_of_the_readme_exist_in_the_makefile() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    targets = re.findall(r"^make ([a-z-]+)", readme, re.M)
    assert targets[:2] == ["demo", "check"]
    assert all(re.search(rf"^{target}:", makefile, re.M) for target in targets)


def test_continuous_integration_runs_the_same_check() -> None:
    script = ROOT / ".ci" / "run"
    assert script.stat().st_mode & 0o111
    assert "make check" in script.read_text(encoding="utf-8")


def test_links_between_pages_lead_somewhere() -> None:
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").glob("*.md")]
    for page in pages:
        for link in re.findall(r"\]\(([^)#]+)", page.read_text(encoding="utf-8")):
            if "://" not in link:
                assert (page.parent / link).exists(), f"{page.name}: {link}"


def test_the_readme_example_is_at_most_ten_lines() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"```python\n(.*?)```", readme, re.S)
    assert len([line for line in example.splitlines() if line.strip()]) <= 10


def test_the_readme_example_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"```python\n(.*?)```", readme, re.S)
    monkeypatch.chdir(tmp_path)
    Path("out").mkdir()
    # Any scenario will do, and a small one is planned at once.
    radmpc.save_scenario(paper(2, seed=1), "out/harbor.yaml")
    exec(compile(example, "README.md", "exec"), {})
    assert "joint risk at most" in capsys.readouterr().out
    assert radmpc.load_plan("out/mine.plan.json").scenario.num_vehicles == 2


def test_pictures_in_the_docs_stay_small() -> None:
    sizes = {path.name: path.stat().st_size for path in (ROOT / "docs" / "images").iterdir()}
    assert sizes
    assert all(size < 300_000 for size in sizes.values()), sizes


def test_files_and_names_of_the_paper_map_exist() -> None:
    page = (ROOT / "docs" / "paper-to-code.md").read_text(encoding="utf-8")
    source = ROOT / "src" / "radmpc"
    files = set(re.findall(r"`([\w/]+\.py)`", page))
    assert len(files) >= 10
    assert [name for name in files if not (source / name).is_file()] == []
    code = "\n".join((source / name).read_text(encoding="utf-8") for name in files)
    words = {part for name in re.findall(r"`([\w.]+)`", page) for part in name.split(".")}
    ours = {word for word in words if "_" in word or word[0].isupper()}
    missing = [word for word in ours if not re.search(rf"\b{word}\b", code)]
    assert missing == []
