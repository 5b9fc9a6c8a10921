from __future__ import annotations

import json
from pathlib import Path

from cli.conftest import Run


def test_the_first_certified_plan_is_told_with_its_moment_and_its_cost(
    run: Run, crossing: Path
) -> None:
    told = run("plan", crossing, "-o", "a.json").stdout
    content = json.loads(Path("a.json").read_text(encoding="utf-8"))
    first = content["first_plan"]
    assert 0.0 < first["seconds"] <= content["seconds"]["total"]
    assert content["cost"] <= first["cost"] * (1.0 + 1e-9)
    (line,) = [line for line in told.splitlines() if line.startswith("first plan")]
    assert line.split(None, 2)[2] == f"after {first['seconds']:.2f} s, at cost {first['cost']:.6g}"
    assert "first plan" not in run("plan", crossing, "--planner", "dlp").stdout
