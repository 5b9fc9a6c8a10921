"""Pages and the fenced blocks in them."""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parent.parent.parent
PAGES = [
    ROOT / "README.md",
    ROOT / "CONTRIBUTING.md",
    *sorted((ROOT / "docs").rglob("*.md")),
]

FENCE = re.compile(
    r"(?:<!-- not run: (?P<reason>[^\n]+?) -->\n)?^```(?P<language>\w+)\n(?P<text>.*?)^```$",
    re.M | re.S,
)


@dataclass(frozen=True)
class Fence:
    """A fenced block; ``reason`` says why it is not run, where it is not."""

    page: Path
    line: int
    language: str
    text: str
    reason: str | None

    @property
    def where(self) -> str:
        return f"{name_of(self.page)}:{self.line}"

    @property
    def commands(self) -> list[list[str]]:
        """The lines of a shell block as words; the path of a program is left away."""
        lines = self.text.replace("\\\n", " ").replace(" && ", "\n").splitlines()
        found = [shlex.split(line, comments=True) for line in lines]
        return [[Path(words[0]).name, *words[1:]] for words in found if words]


def name_of(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def fences(page: Path, language: str) -> list[Fence]:
    text = page.read_text(encoding="utf-8")
    return [
        Fence(
            page,
            text.count("\n", 0, match.start("text")) + 1,
            match["language"],
            match["text"],
            match["reason"],
        )
        for match in FENCE.finditer(text)
        if match["language"] == language
    ]


def pages_with(language: str) -> list[Path]:
    return [page for page in PAGES if fences(page, language)]


def section(page: Path, heading: str) -> str:
    """Text below a heading, up to the next one of its level or above."""
    text = page.read_text(encoding="utf-8")
    begin = text.index(f"\n{heading}\n") + len(heading) + 2
    level = len(heading) - len(heading.lstrip("#"))
    end = re.search(rf"^#{{1,{level}}} ", text[begin:], re.M)
    return text[begin:] if end is None else text[begin : begin + end.start()]


def first_column(text: str) -> list[str]:
    """Names in backticks in the first cells of a section's tables."""
    cells = re.findall(r"^\| (`[^|]*?) \|", text, re.M)
    return [name for cell in cells for name in re.findall(r"`([^`]+)`", cell)]
