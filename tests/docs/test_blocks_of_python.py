from __future__ import annotations

import re
from pathlib import Path

import pytest
from pages import PAGES, fences, name_of, pages_with

import radmpc


@pytest.mark.slow
@pytest.mark.parametrize("page", pages_with("python"), ids=name_of)
def test_the_python_of_a_page_runs_from_top_to_bottom(page: Path, workbench: Path) -> None:
    names: dict[str, object] = {"__name__": "__page__"}
    for fence in fences(page, "python"):
        if fence.reason is None:
            # Empty lines before it make a traceback name the line of the page.
            code = compile("\n" * fence.line + fence.text, str(page), "exec")
            exec(code, names)


def test_the_readme_example_is_at_most_ten_lines() -> None:
    (example,) = fences(PAGES[0], "python")
    assert len([line for line in example.text.splitlines() if line.strip()]) <= 10


def test_the_readme_example_tells_risk_and_writes_its_plan(
    workbench: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (example,) = fences(PAGES[0], "python")
    exec(compile(example.text, "README.md", "exec"), {})
    assert "joint risk at most" in capsys.readouterr().out
    assert radmpc.load_plan("out/mine.plan.json").scenario.num_vehicles == 2


def test_whatever_is_not_run_says_why() -> None:
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        marked = re.findall(r"^<!-- not run\b(.*)$", text, re.M)
        assert all(re.fullmatch(r": \w.+ -->", rest) for rest in marked), name_of(page)
        known = [f for kind in ("python", "sh") for f in fences(page, kind) if f.reason]
        assert len(marked) == len(known), f"{name_of(page)}: a mark that stands before no block"
