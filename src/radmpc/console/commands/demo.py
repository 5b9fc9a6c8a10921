"""The demonstration: the shipped scenario planned, drawn and explained."""

from __future__ import annotations

from pathlib import Path

from radmpc.console.commands.plan_command import Request, check_request, run_plan
from radmpc.console.files import DEMO_NAME, OutputError, check_output, demo_text, writing
from radmpc.console.output import show
from radmpc.io.native.scenario_file import load_scenario
from radmpc.planners.presets import DEFAULT
from radmpc.system.atomic import write_text

__all__ = ["run_demo"]


def run_demo(folder: Path) -> int:
    """Plan the shipped scenario; scenario, plan and picture go to a folder.

    Parameters
    ----------
    folder : Path
        Made if missing.

    Returns
    -------
    int
        The exit code.
    """
    with writing(folder):
        folder.mkdir(parents=True, exist_ok=True)
    scenario_path = folder / f"{DEMO_NAME}.yaml"
    plan_path = folder / f"{DEMO_NAME}.plan.json"
    figure_path = folder / f"{DEMO_NAME}.png"
    request = Request(DEFAULT, seed=0, output=plan_path, figure=figure_path)
    check_request(request)
    check_output(scenario_path)
    _write_scenario(scenario_path)
    code = run_plan(load_scenario(scenario_path), request)
    show(
        "",
        "Try next:",
        f"  radmpc verify {plan_path}",
        f"  radmpc fly {plan_path} -o {folder / f'{DEMO_NAME}.flight.jsonl'}",
        f"  radmpc plan {scenario_path} --seed 1 --ledger {folder / 'ledger.png'}",
        "  radmpc planners",
    )
    return code


def _write_scenario(path: Path) -> None:
    """Write the shipped scenario, but not over one that somebody has changed.

    Raises
    ------
    OutputError
        If another scenario stands there.
    """
    with writing(path):
        if path.exists() and path.read_bytes() not in {b"", demo_text().encode()}:
            raise OutputError(
                f"cannot write {path}: it differs from the shipped scenario; choose another --out"
            )
        write_text(path, demo_text())
