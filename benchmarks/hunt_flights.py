"""A hunt among flights: small scenes of every feature, planned, flown in many ways, and compared.

Run ``python benchmarks/hunt_flights.py --scenes 1000 --seed 0 --out flights.csv``. Each scene is a
line of the table, written and synced at once; the same command goes on where an interrupted one
stopped. Every decision is looked at by code that decides nothing, in a world written anew; flights
are written, read, verified, cut short, gone on with and changed; every tenth scene is flown from
the command line. In the end contacts are summed and held against what was certified.
``--scenes 0`` reports on what there is, ``--index 17`` plays one scene again, and with ``--save
scene.json`` writes it as a scenario file.
"""

from __future__ import annotations

import argparse
import math
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import numpy as np
from scipy.special import logsumexp
from scipy.stats import poisson

import radmpc
from hunting.catch import Notes, watched
from hunting.flights_console import check_console
from hunting.flights_files import check_files
from hunting.flights_missions import KINDS_OF_FLIGHT, Flown, flown, is_repeated, made
from hunting.flights_scenes import draw_flown_scene
from hunting.flights_world import World
from hunting.record_table import add_row, rows_of
from radmpc.io.native.scenario_file import save_scenario
from radmpc.model.plan import Plan

_OFTEN: Mapping[str, int] = {"kept": 8, "warm": 3, "windows": 1, "late": 1, "blind": 1, "again": 1}
"""Missions of a kind; 2 of all others."""

_LEVEL = 1e-3
"""Chance of calling sound certificates unsafe, all of them together [-]."""

_MORE = (0.1, 0.3, 1.0, 3.0)
"""Shares by which hits may be more than they were charged [-]: of each the likelihood against what
was charged is a martingale, and so is their mean, which exceeds 1 / `_LEVEL` that rarely."""

_ALARMED = 1e-3
"""How many ticks have an alarm of several disturbances together, at most [-]."""

_HANG = 60.0
"""Seconds after which a call does not come back."""


@dataclass(slots=True)
class Found:
    """One line of the table.

    Attributes
    ----------
    seed, index : int
        Which scene.
    status : str
        What planning said.
    vehicles, horizon : int
        Size.
    bound, certified : float
        Δ, and the certificate of the plan; nan where there is none.
    missions, ticks, adopted : int
        Flown, decided, legs bought.
    kept, kept_hits, anew, anew_hits : int
        Missions flown as planned and by any other rule, and how many of them hit something before
        a control saturated.
    charged : float
        What steps of all of these were charged when they began, until something was hit.
    worth : float
        Sum over those that were not flown as planned of 1 where something was hit, else of the
        wealth at the end.
    alarms : int
        Of several disturbances together.
    seconds : float
        Of the whole scene.
    kinds, notes : str
        What is wrong, and what exactly.
    """

    seed: int
    index: int
    status: str = "none"
    vehicles: int = 0
    horizon: int = 0
    bound: float = float("nan")
    certified: float = float("nan")
    missions: int = 0
    ticks: int = 0
    adopted: int = 0
    kept: int = 0
    kept_hits: int = 0
    anew: int = 0
    anew_hits: int = 0
    charged: float = 0.0
    worth: float = 0.0
    alarms: int = 0
    seconds: float = 0.0
    kinds: str = ""
    notes: str = ""


_COLUMNS = tuple(f.name for f in fields(Found))


def main() -> None:
    """Play one scene, or all that are missing, and print what was found."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=200, help="scenes in all")
    parser.add_argument("--seed", type=int, default=0, help="of everything random")
    parser.add_argument("--time-limit", type=float, default=1.0, help="seconds of the first plan")
    parser.add_argument("--out", type=Path, help="table of scenes, CSV")
    parser.add_argument("--index", type=int, help="play this scene alone")
    parser.add_argument("--save", type=Path, help="scenario file for it")
    options = parser.parse_args()
    if options.index is not None:
        if options.save is not None:
            save_scenario(draw_flown_scene(options.seed, options.index), options.save)
        found = play(options.seed, options.index, options.time_limit)
        for name, value in asdict(found).items():
            print(*(f"{name:>10}  {line}" for line in str(value).split(" | ")), sep="\n")
        return
    if options.out is None:
        sys.exit("--out is needed: the table of scenes, CSV")
    kinds = {"int": int, "float": float, "str": str}
    table = [
        Found(**{f.name: kinds[str(f.type)](row[f.name]) for f in fields(Found)})
        for row in rows_of(options.out)
    ]
    done = {found.index for found in table}
    for index in (i for i in range(options.scenes) if i not in done):
        found = play(options.seed, index, options.time_limit)
        add_row(options.out, _COLUMNS, asdict(found))
        table.append(found)
    print("\n".join(summary(table)))


def play(seed: int, index: int, time_limit: float) -> Found:
    """Plan a scene, fly it in all ways, and look at its files.

    Parameters
    ----------
    seed, index : int
        Which scene.
    time_limit : float
        Seconds of the first plan.
    """
    begun, notes, scenario = time.perf_counter(), Notes(), draw_flown_scene(seed, index)
    found = Found(seed, index, vehicles=scenario.num_vehicles, horizon=scenario.horizon)
    found.bound = scenario.risk_bound
    plan = None
    with watched(notes, "plan", time_limit + _HANG):
        plan = radmpc.plan(scenario, rng=0, time_limit=time_limit).record
        found.status = plan.status.value
    certified = None if plan is None else plan.risk.certified
    if plan is not None and plan.trajectories and certified is not None:
        found.certified = certified
        if certified <= plan.risk.bound:
            _fly(found, plan, notes)
    found.seconds = time.perf_counter() - begun
    found.kinds = " ".join(notes.kinds)
    found.notes = " | ".join(" ".join(text.split()) for text in dict.fromkeys(notes.texts))[:4000]
    return found


def _fly(found: Found, plan: Plan, notes: Notes) -> None:
    """Fly a plan in all ways, and look at its files."""
    seed = found.seed, found.index
    for kind in KINDS_OF_FLIGHT:
        if kind == "windows" and found.horizon < 2:
            continue
        for number in range(_OFTEN.get(kind, 2)):
            with watched(notes, f"{kind} {number}", _HANG):
                _fly_once(found, plan, notes, (kind, number))
    for kind in ("kept", "warm"):
        with watched(notes, f"{kind} again", _HANG):
            if not is_repeated(kind, plan, [*seed, 99]):
                notes.add("repeat", f"{kind}: the same seed made another flight")
    with tempfile.TemporaryDirectory() as folder:
        with watched(notes, "files", 2.0 * _HANG):
            found.missions += check_files(plan, Path(folder), np.random.default_rng(seed), notes)
        if found.index % 10 == 0:
            with watched(notes, "console", 10.0 * _HANG):
                check_console(plan, Path(folder), np.random.default_rng(seed), notes)


def _fly_once(found: Found, plan: Plan, notes: Notes, which: tuple[str, int]) -> None:
    """Fly a mission, and add up what came of it."""
    kind, number = which
    rng = np.random.default_rng([found.seed, found.index, *kind.encode(), number])
    try:
        mission, deadline = made(kind, plan, rng)
    except radmpc.NoPlanError:
        return  # no guide, or no first window: nobody promised any
    noise = [found.seed, found.index, *kind.encode(), number, 1]
    # In the package's own model contacts are looked for, too.
    has_model = kind == "kept" and number == 0
    drawn = np.random.default_rng(noise)
    world = radmpc.Model(plan.scenario, drawn) if has_model else World(plan.scenario, noise)
    blind = rng if kind == "blind" else None
    name, again = f"{kind} {number}", kind == "again"
    became = flown(mission, world, notes, name, deadline=deadline, blind=blind, is_restarted=again)
    found.missions, found.ticks = found.missions + 1, found.ticks + became.ticks
    found.adopted += became.adopted
    if kind not in {"blind", "again"}:
        _count(found, became, notes, is_kept=kind == "kept")


def _count(found: Found, became: Flown, notes: Notes, *, is_kept: bool) -> None:
    """Add up hits and alarms of a mission of which something is promised."""
    found.alarms, found.charged = found.alarms + became.unlikely, found.charged + became.charged
    if became.odd or became.far:
        notes.add("alarm", f"{became.odd} where there is no noise, {became.far} far ones")
    if is_kept:
        found.kept, found.kept_hits = found.kept + 1, found.kept_hits + became.is_hit
    else:
        found.anew, found.anew_hits = found.anew + 1, found.anew_hits + became.is_hit
        found.worth += became.worth


def summary(table: Sequence[Found]) -> list[str]:
    """Return the lines of the summary: what was flown, hits against bounds, what is wrong where."""
    flown_at = [found for found in table if found.missions]
    states = Counter(found.status for found in table)
    told = ", ".join(f"{count} {status}" for status, count in sorted(states.items()))
    ticks, alarms = (sum(getattr(f, name) for f in table) for name in ("ticks", "alarms"))
    lines = [
        f"{len(table)} scenes ({told}), {len(flown_at)} of them flown: "
        f"{sum(f.missions for f in table)} missions, {ticks} decisions, "
        f"{sum(f.adopted for f in table)} legs adopted",
        f"worth at the end {sum(f.worth for f in flown_at):.4g}, at the start "
        f"{sum(f.anew * f.bound for f in flown_at):.4g}; alarms of several disturbances: {alarms}, "
        f"expected {_ALARMED * ticks:.3g}",
        "",
    ]
    for name, hits, bound in (
        ("as planned", "kept_hits", sum(f.kept * f.certified for f in flown_at)),
        ("planned anew", "anew_hits", sum(f.anew * f.bound for f in flown_at)),
    ):
        count = sum(getattr(f, hits) for f in flown_at)
        chance = float(poisson.sf(count - 1, bound)) if bound > 0.0 else 1.0
        verdict = "UNSAFE" if chance < _LEVEL else "no contradiction"
        lines.append(f"- {name}: {count} hits, certified {bound:.4g}: p = {chance:.3g}, {verdict}")
    hits, charged = (sum(f.kept_hits + f.anew_hits for f in table), sum(f.charged for f in table))
    likelihoods = [hits * math.log1p(more) - more * charged for more in _MORE]
    evidence = float(logsumexp(likelihoods)) - math.log(len(_MORE))
    verdict = "UNSAFE" if evidence > -math.log(_LEVEL) else "no contradiction"
    lines.append(f"- step by step: {hits} hits, charged {charged:.4g}: {verdict}")
    kinds = Counter(kind for found in table for kind in found.kinds.split())
    for kind, count in sorted(kinds.items()):
        where = [str(found.index) for found in table if kind in found.kinds.split()]
        lines.append(f"- **{kind}** {count}: {', '.join(where[:40])}")
    return lines


if __name__ == "__main__":
    main()
