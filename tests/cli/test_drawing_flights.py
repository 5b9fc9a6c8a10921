"""`radmpc draw` of flights whose files are not as they were written."""

from __future__ import annotations

from pathlib import Path

from .conftest import CROSSING, Run, assert_one_line


def test_a_flight_that_was_changed_is_drawn_with_a_warning(run: Run, tmp_path: Path) -> None:
    (tmp_path / "c.yaml").write_text(CROSSING, encoding="utf-8")
    assert run("plan", "c.yaml", "-o", "c.json").exit_code == 0
    assert run("fly", "c.json", "--replan", "none", "-o", "a.jsonl").exit_code == 0
    held = run("draw", "a.jsonl", "-o", "a.svg")
    assert (held.exit_code, held.stderr) == (0, "")
    text = (tmp_path / "a.jsonl").read_text(encoding="utf-8")
    changed = text.replace('"excess": 0.0', '"excess": 1.0', 1)
    (tmp_path / "a.jsonl").write_text(changed, encoding="utf-8")
    warned = run("draw", "a.jsonl", "-o", "a.svg")
    assert warned.exit_code == 0
    assert assert_one_line(warned.stderr) == (
        "radmpc: warning: a.jsonl: line 2 is not as it was written; 'radmpc verify a.jsonl' says "
        "what does not hold"
    )
