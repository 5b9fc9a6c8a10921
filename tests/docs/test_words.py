from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest
from pages import PAGES, ROOT, name_of, section

SOURCE = ROOT / "src" / "radmpc"
GLOSSARY = ROOT / "docs" / "glossary.md"

BRITISH = [
    *("analyse(?!s)", "artefact", "behaviour", "centre", "colour", "defence", "favour", "fibre"),
    *("fulfil(?!l)", "grey", "honour", "judgement", "learnt", "licence", "manoeuvre", "metre"),
    *("labell", "modell", "signall", "travell", "tunnell"),
    *("neighbour", "plough", "programme(?![dr])", "spelt", "towards", "whilst"),
    *("centralis", "characteris(?!t)", "discretis", "generalis", "initialis", "linearis"),
    *("maximis", "minimis", "normalis", "optimis(?![mt])", "organis(?!m)", "parametris"),
    *("recognis", "serialis", "summaris", "utilis", "vectoris", "visualis"),
]
"""Beginnings of words that American English spells another way, as regular expressions."""

OTHERS_NAMES = {"mkdocs.yml": ["blue grey"]}
"""Names that other programs give to things, by file."""

OTHER_MEANINGS = {
    "docs/gallery.md": ["past its bow"],
    "docs/pictures.md": ["the bow of a ferry"],
    "docs/paper.md": ["call them flights"],
}
"""Where a word that is not ours means something else, or is quoted, by page."""


def spelled_files() -> list[Path]:
    """Return the project's own text; problems of others are spelled as they come."""
    git = shutil.which("git")
    if git is None or not (ROOT / ".git").exists():
        pytest.skip("not in a repository")
    command = [git, "ls-files", "-z", "*.py", "*.md", "*.toml", "*.yml"]
    listed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True)
    paths = [ROOT / name for name in listed.stdout.split("\0") if name]
    others = (ROOT / "instances", Path(__file__).resolve())
    return [p for p in paths if p.is_file() and not any(p.is_relative_to(o) for o in others)]


def british_words(text: str) -> list[str]:
    """Return each of them once: most words of a text are those of the others."""
    wrong = re.compile("|".join(BRITISH), re.I)
    return sorted(word for word in set(re.findall(r"\w+", text)) if wrong.search(word))


def replaced_words() -> list[str]:
    """Return what stands on the left in the last table of the glossary."""
    table = section(GLOSSARY, "## One word for one thing")
    cells = re.findall(r"^\| ([a-z][^|]*) \|", table, re.M)[1:]
    return [word for cell in cells for word in cell.split(", ")]


def prose(page: Path) -> str:
    """Return a page's text on one line, without blocks, names of code, and words of reports."""
    text = page.read_text(encoding="utf-8")
    if page == GLOSSARY:
        for heading in ("## One word for one thing", "## Words that names do without"):
            text = text.replace(section(page, heading), "")
    text = re.sub(r"^```.*?^```$", "", text, flags=re.M | re.S)
    text = re.sub(r"`[^`]+`|\]\([^)]*\)|\*simple bounds\*", "", text)
    text = re.sub(r"\s+", " ", text)
    for phrase in OTHER_MEANINGS.get(name_of(page), []):
        text = text.replace(phrase, "")
    return text


def uses(word: str, text: str) -> bool:
    # To look for letters is quicker than for a word.
    return word.lower() in text.lower() and re.search(rf"\b{word}\b", text, re.I) is not None


def test_spelling_is_american() -> None:
    texts = {}
    for path in spelled_files():
        text = path.read_text(encoding="utf-8")
        for name in OTHERS_NAMES.get(name_of(path), []):
            text = text.replace(name, "")
        texts[name_of(path)] = text
    # Most words stand in many files.
    wrong = british_words("\n".join(texts.values()))
    assert [f"{name}: {w}" for w in wrong for name, text in texts.items() if w in text] == []


@pytest.mark.parametrize(
    "word",
    [
        *("neighbour_list", "Behaviour", "minimised", "kilometres", "programmes", "labelled"),
        *("analysed", "licence", "greyish", "optimisation"),
    ],
)
def test_british_spelling_is_noticed(word: str) -> None:
    assert british_words(f"the {word} here") == [word]


@pytest.mark.parametrize(
    "word",
    [
        *("programmed", "optimistic", "fulfills", "analyses", "characteristic", "parameter"),
        *("precise", "modeled", "symmetry", "cancellation"),
    ],
)
def test_american_words_that_resemble_british_ones_pass(word: str) -> None:
    assert british_words(word) == []


@pytest.mark.parametrize("page", [*PAGES, ROOT / "CHANGELOG.md"], ids=name_of)
def test_pages_use_the_words_of_the_glossary(page: Path) -> None:
    text = prose(page)
    assert [word for word in replaced_words() if uses(word, text)] == []


def test_words_that_the_package_has_lost_do_not_come_back() -> None:
    words = replaced_words()
    assert {"bow", "lost cause", "allotted"} <= set(words)
    found = []
    for path in sorted(SOURCE.rglob("*.py")):
        text = in_words(f"{path.stem} " + " ".join(path.read_text(encoding="utf-8").split()))
        found += [f"{name_of(path)}: {word}" for word in words if uses(word, text)]
    assert found == []


def in_words(text: str) -> str:
    """Return a text with the words of names in it apart: ``place_in_haste``, ``LostCause``."""
    return re.sub(r"_|(?<=[a-z])(?=[A-Z])", " ", text)


@pytest.mark.parametrize("name", ["place_in_haste", "_LOST_CAUSE", "class Booked", "isHopeless"])
def test_a_lost_word_within_a_name_is_noticed(name: str) -> None:
    assert any(uses(word, in_words(name)) for word in replaced_words())


@pytest.mark.parametrize("names", [["glossary.md"], ["engine.md", "engine/*.md"]], ids=str)
def test_files_and_names_that_explain_the_code_exist(names: list[str]) -> None:
    pages = [path for name in names for path in sorted((ROOT / "docs").glob(name))]
    page = "\n".join(path.read_text(encoding="utf-8") for path in pages)
    quoted = re.findall(r"`([^`\n]+)`", re.sub(r"^```.*?^```$", "", page, flags=re.M | re.S))
    files = [word for word in quoted if re.fullmatch(r"(?!tests/|benchmarks/)[\w/]+\.py", word)]
    there = [path.relative_to(SOURCE).as_posix() for path in SOURCE.rglob("*.py")]
    places = [f"/{path}" for path in there]
    assert files
    assert [file for file in files if not any(p.endswith(f"/{file}") for p in places)] == []
    code = "\n".join((SOURCE / path).read_text(encoding="utf-8") for path in there)
    named = {
        part for word in quoted if re.fullmatch(r"\w+(\.\w+)?", word) for part in word.split(".")
    }
    ours = {word for word in named if re.search(r"_|[A-Z]", word)}
    assert len(ours) >= 20
    problems = "\n".join(path.stem for path in (ROOT / "instances").rglob("*"))
    known = re.findall(r"\w+", code + problems) + re.findall(r"\b[^\W_]+_[^\W_]+", problems)
    assert sorted(ours - set(known)) == []


def test_the_glossary_is_linked_from_the_front_pages() -> None:
    for page in ("README.md", "docs/index.md", "docs/problem.md", "docs/reference/index.md"):
        assert re.search(r"\]\([\w./]*glossary\.md\)", (ROOT / page).read_text(encoding="utf-8"))


def test_every_term_of_the_glossary_stands_there_once_and_has_a_name_in_the_code() -> None:
    rows = re.findall(
        r"^\| (.+?) \| (.*?) ?\| (.+?) \| (.+?) \|$", GLOSSARY.read_text("utf-8"), re.M
    )
    terms = [row for row in rows if row[0] not in ("term", "---")]
    names = [row[0] for row in terms]
    assert len(names) >= 50
    assert len(set(names)) == len(names)
    assert [row[0] for row in terms if "`" not in row[3] or not row[2].endswith(".")] == []
