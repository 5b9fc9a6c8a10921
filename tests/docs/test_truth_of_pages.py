from __future__ import annotations

import re
import tomllib
from itertools import pairwise

import pytest
from pages import PAGES, ROOT, first_column, name_of, section
from ruamel.yaml import YAML

import radmpc

SOURCE = ROOT / "src" / "radmpc"


def code() -> str:
    return "\n".join(path.read_text(encoding="utf-8") for path in SOURCE.rglob("*.py"))


def test_paths_and_names_in_contributing_exist() -> None:
    page = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    quoted = re.findall(r"`([^`\n]+)`", page)
    paths = [word for word in quoted if re.fullmatch(r"[\w/-]+(\.(py|md|txt|toml)|/)", word)]
    assert len(paths) >= 8
    assert [p for p in paths if not ((ROOT / p).exists() or (SOURCE / p).exists())] == []
    languages = {"python", "sh"}
    names = [w for w in quoted if re.fullmatch(r"[A-Za-z_]\w+", w) and w not in languages]
    examples = [path.read_text(encoding="utf-8") for path in (ROOT / "examples").glob("*.py")]
    targets = "\n".join([(ROOT / "Makefile").read_text(encoding="utf-8"), code(), *examples])
    assert sorted(set(names) - set(re.findall(r"\w+", targets))) == []


def test_the_readme_says_which_extras_bring_what_the_demo_leaves_out() -> None:
    page = (ROOT / "README.md").read_text(encoding="utf-8")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    told = re.findall(r"'\.\[(\w+)\]'", page)
    assert told == ["serve", "logs", "simulators"]
    assert set(told) <= set(project["project"]["optional-dependencies"])


def test_the_floors_page_lists_the_floors_of_the_contract_in_their_order() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    layers = project["tool"]["importlinter"]["contracts"][0]["layers"]
    floors = [set(layer.split(" | ")) for layer in layers]
    page = (ROOT / "docs" / "floors.md").read_text(encoding="utf-8")
    told = first_column(page)
    wanted = set().union(*floors) - {"__main__"}
    assert wanted <= set(told), wanted - set(told)
    heights = [next(i for i, floor in enumerate(floors) if name in floor) for name in told]
    assert [h for h, below in pairwise(heights) if h > below + 1] == []


def stands(dotted: str) -> bool:
    """Whether ``io.native.plan_file`` or ``referee.certify`` is a file, package or name there."""
    if any((folder / dotted).is_file() for folder in (ROOT, SOURCE)):
        return True
    place, words = SOURCE, dotted.removeprefix("radmpc.").split(".")
    for number, word in enumerate(words):
        if (place / word).is_dir():
            place /= word
            continue
        file = place / f"{word}.py"
        if file.is_file():
            return all(re.search(rf"\b{w}\b", file.read_text("utf-8")) for w in words[number + 1 :])
        inside = "\n".join(path.read_text(encoding="utf-8") for path in place.rglob("*.py"))
        return place != SOURCE and number == len(words) - 1 and f" {word}" in inside
    return True


def test_files_and_names_of_the_floors_page_exist() -> None:
    page = (ROOT / "docs" / "floors.md").read_text(encoding="utf-8")
    dotted = set(re.findall(r"`(\w+(?:\.\w+)+)`", page))
    assert len(dotted) >= 12
    assert [name for name in sorted(dotted) if not stands(name)] == []
    paths = re.findall(r"`(\w+(?:/\w+)*/\w+\.py)`", page)
    assert [path for path in paths if not any((f / path).exists() for f in (ROOT, SOURCE))] == []
    later = section(ROOT / "docs" / "floors.md", "## Where what comes next will live")
    floors = re.findall(r"^\| [^|`]+ \| `([\w.]+)`", later, re.M)
    assert floors
    assert [floor for floor in floors if not stands(floor)] == []


@pytest.mark.parametrize("name", ["io.native.no_file", "referee.certifies", "page.map", "page"])
def test_a_floor_or_a_name_that_is_not_there_is_noticed(name: str) -> None:
    assert not stands(name)


def test_files_and_names_of_the_paper_map_exist() -> None:
    page = (ROOT / "docs" / "paper-to-code.md").read_text(encoding="utf-8")
    files = set(re.findall(r"`([\w/]+\.py)`", page))
    assert len(files) >= 10
    assert [name for name in files if not (SOURCE / name).is_file()] == []
    text = "\n".join((SOURCE / name).read_text(encoding="utf-8") for name in files)
    words = {part for name in re.findall(r"`([\w.]+)`", page) for part in name.split(".")}
    ours = {word for word in words if "_" in word or word[0].isupper()}
    assert [word for word in ours if not re.search(rf"\b{word}\b", text)] == []


def test_scripts_and_tests_that_pages_name_exist() -> None:
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        named = re.findall(r"\b((?:benchmarks|tests|examples|docs)/[\w/.-]+\.(?:py|md|gz))\b", text)
        assert [name for name in named if not (ROOT / name).exists()] == [], name_of(page)


def test_links_between_pages_lead_somewhere() -> None:
    for page in PAGES:
        text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.S)
        for link in re.findall(r"\]\(([^)#\s]+)", text):
            if "://" not in link:
                assert (page.parent / link).exists(), f"{name_of(page)}: {link}"


def test_pictures_in_the_docs_stay_small() -> None:
    sizes = {path.name: path.stat().st_size for path in (ROOT / "docs").rglob("*.png")}
    assert sizes
    assert all(size < 1_000_000 for size in sizes.values()), sizes


def test_the_citation_names_this_version_the_license_and_the_paper() -> None:
    citation = YAML(typ="safe").load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert citation["cff-version"] == "1.2.0"
    assert {"message", "title", "authors"} <= citation.keys()
    assert citation["version"] == radmpc.__version__
    assert citation["license"] == "MIT"
    paper = citation["preferred-citation"]
    assert {"type", "title", "authors"} <= paper.keys()
    readable = re.sub(r"\s+", " ", (ROOT / "docs" / "paper.md").read_text(encoding="utf-8"))
    assert paper["title"] in readable
    assert all(author["family-names"] in readable for author in paper["authors"])


def test_the_license_is_that_of_mit_in_every_place() -> None:
    license_text = (ROOT / "LICENSE").read_text(encoding="utf-8")
    assert license_text.startswith("MIT License\n")
    assert "The radmpc authors" in license_text
    assert (ROOT / "README.md").read_text(encoding="utf-8").endswith("MIT license.\n")


def test_the_changelog_begins_with_what_is_not_released() -> None:
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    headings = re.findall(r"^## \[(.+?)\]", text, re.M)
    assert headings[0] == "Unreleased"
    kinds = {"Added", "Changed", "Deprecated", "Removed", "Fixed", "Security"}
    assert set(re.findall(r"^### (\w+)$", text, re.M)) <= kinds
