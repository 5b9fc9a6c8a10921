from __future__ import annotations

import math
import sys
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

import calibration
from calibrating.noise import FEATURES, with_noise
from calibrating.overlap import measure_overlap
from calibrating.report import doubtful, lower_limit, report, second_look, violations
from calibrating.scenes import random_planner, random_scenario
from calibrating.trial import Trial, run_trial, trial_of
from calibrating.world import world_collisions
from radmpc import to_dict
from radmpc.planners.presets import PRESETS
from radmpc.planning import plan
from radmpc.referee import simulate

DONE = Trial(
    seed=0, index=0, samples=1000, planner="dlp", avoidance="steps", status="feasible",
    dimension=2, vehicles=2, obstacles=0, horizon=4, bound=0.1, certified=0.05,
    certified_pair=0.05, certified_obstacle=0.0, certified_workspace=0.0, certified_later=0.05,
    num_sets=1, hits=40, hits_pair=40, hits_obstacle=0, hits_workspace=0,
    overlap_joint=40, overlap_encounters=40, overlap_events=50,
    plan_seconds=0.1, certify_seconds=0.1, fly_seconds=0.1,
)  # fmt: skip


def same(first: Trial, second: Trial) -> bool:
    """Whether all fields agree, clocks left out; nan equals nan."""
    names = [f.name for f in fields(Trial) if not f.name.endswith("_seconds")]
    pairs = [(getattr(first, name), getattr(second, name)) for name in names]
    return all(str(a) == str(b) for a, b in pairs)


def test_a_seed_decides_the_scenario_and_many_seeds_make_valid_ones():
    dimensions, avoidances, sizes = set(), set(), set()
    for seed in range(40):
        first, second = (random_scenario(np.random.default_rng(seed), "s") for _ in range(2))
        assert [v.start.tolist() for v in first.vehicles] == [
            v.start.tolist() for v in second.vehicles
        ]
        dimensions.add(first.dimension)
        avoidances.add(first.avoidance)
        sizes.add(first.num_vehicles)
    assert dimensions == {2, 3}
    assert avoidances == {"steps", "intervals"}
    assert {1, 8} <= sizes


def test_every_preset_takes_part_the_slow_ones_in_small_fleets():
    rng = np.random.default_rng(0)
    small = {random_planner(rng, 2)[0] for _ in range(300)}
    large = {random_planner(rng, 8)[0] for _ in range(300)}
    assert set(PRESETS) <= small
    assert "uncoupled" in large
    assert "milp" not in large


def test_a_line_of_the_table_reads_back():
    assert same(trial_of(DONE.as_row()), DONE)
    assert math.isnan(trial_of(DONE.as_row()).own)


@pytest.mark.slow
def test_repeating_a_trial_gives_the_same_numbers():
    assert same(run_trial(0, 3, 600, 60.0), run_trial(0, 3, 600, 60.0))


@pytest.mark.slow
def test_overlap_counts_what_the_simulation_counts_and_repetitions_besides():
    rng = np.random.default_rng(8)
    checked = 0
    while checked < 4:
        scenario = random_scenario(rng, "s")
        found = plan(scenario, "dlp").plan
        if found is None:
            continue
        flown, overlap = simulate(found, 8_000, rng=1), measure_overlap(found, 8_000, 2)
        assert overlap.joint <= overlap.encounters <= overlap.events
        # Two estimates of one rate, five standard deviations apart at most.
        spread = math.sqrt(2.0 * max(flown.rate * (1.0 - flown.rate), 1e-3) / 8_000)
        assert abs(overlap.joint / 8_000 - flown.rate) <= 5.0 * spread
        checked += flown.collisions > 100


def test_the_lower_limit_is_that_of_clopper_and_pearson():
    assert lower_limit(0, 100, 0.05) == 0.0
    # With all of n hits it is the rate whose n-th power is the level.
    assert lower_limit(100, 100, 0.05) == pytest.approx(0.05 ** (1 / 100))


def test_a_certificate_below_the_rate_is_found_and_reported():
    low = replace(DONE, index=7, certified=0.01)
    assert violations([DONE, low], 0.05 / 2) == [low]
    text = "\n".join(report([DONE, low]))
    assert "VIOLATION: 7" in text
    assert "VIOLATION" not in "\n".join(report([DONE]))


def test_the_least_likely_plans_get_a_second_look_first():
    likely = replace(DONE, index=1, certified=0.2)
    odd = replace(DONE, index=2, certified=0.03)
    never = replace(DONE, index=3, hits=0)
    assert [t.index for t in doubtful([likely, never, odd, DONE])] == [2, 0, 1]
    (row,) = second_look([DONE])[4:]
    low, high = (float(word) for word in row.split("|")[4].split("to"))
    assert low == pytest.approx(0.02873, abs=1e-4)
    assert high == pytest.approx(0.05407, abs=1e-4)


def test_a_plan_that_breaks_its_bound_is_reported():
    broken = replace(DONE, bound=0.02, certified=0.019)
    assert "Lower limits above Δ: **1** of 1" in "\n".join(report([broken]))


def test_the_slack_is_split_into_its_factors():
    lines = report([DONE])
    (single,) = [line for line in lines if line.startswith("| steps: bound of single events")]
    (time,) = [line for line in lines if line.startswith("| steps: one encounter, several")]
    assert single.split("|")[3].strip() == "1"
    assert time.split("|")[3].strip() == "1.25"


@pytest.mark.slow
def test_an_interrupted_run_goes_on_where_it_stopped(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    table = tmp_path / "table.csv"

    def run(plans: int, samples: int = 200) -> None:
        words = ["calibration", "--plans", str(plans), "--samples", str(samples)]
        monkeypatch.setattr(sys, "argv", [*words, "--out", str(table)])
        calibration.main()

    run(1)
    before = table.read_text(encoding="utf-8")
    table.write_text(before + "0,99,2", encoding="utf-8")  # killed while it wrote
    run(2)
    after = table.read_text(encoding="utf-8")
    assert after.startswith(before)
    assert "0,99,2" not in after
    assert "2 plans" in capsys.readouterr().out
    with pytest.raises(
        SystemExit, match="with --seed 0 --samples 200, not with --seed 0 --samples 100"
    ):
        run(2, samples=100)


def noisy_plan(features, seeds):
    """The first plan of a few random scenarios with some features, and how the rest is drawn."""
    for seed in seeds:
        rng = np.random.default_rng(seed)
        scenario = random_scenario(rng, "s")
        for name in features:
            scenario = FEATURES[name](rng, scenario)
        found = plan(scenario, "dlp", time_limit=30.0).plan
        if found is not None and simulate(found, 500, rng=0).collisions > 25:
            return found
    raise AssertionError("no plan")


def test_the_world_as_it_is_measured_is_drawn_from_a_seed_and_every_feature_comes_up():
    seen = set()
    for seed in range(30):
        base = random_scenario(np.random.default_rng(seed), "s")
        (one, names), (two, _) = (with_noise(np.random.default_rng(seed), base) for _ in range(2))
        assert to_dict(one) == to_dict(two) != to_dict(base)
        assert names
        seen |= set(names.split("+"))
    assert seen == set(FEATURES)


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("features", [("current", "receivers"), ("gusts", "freighter")])
def test_missions_in_the_world_collide_as_often_as_samples(features):
    """At steps, where looking at moments misses nothing: two estimates of one rate."""
    found = noisy_plan(features, range(50, 90))
    found = replace(found, scenario=replace(found.scenario, avoidance="steps"))
    missions = 6_000
    counts = [simulate(found, missions, rng=1).collisions, world_collisions(found, missions, 2)]
    rate = sum(counts) / (2 * missions)
    assert 0.0 < rate < 1.0
    assert abs(counts[0] - counts[1]) <= 5.0 * math.sqrt(2 * missions * rate * (1.0 - rate))


def test_the_report_tells_what_was_flown_in_the_world_by_what_was_added():
    good = replace(DONE, noise="current+gusts", world_samples=4000, world_hits=150)
    bad = replace(DONE, index=1, noise="gusts", world_samples=4000, world_hits=400)
    text = "\n".join(report([good, bad]))
    assert "**1** of 2 above" in text
    assert "| current | 1 | 0 | 1.33 |" in text
    assert "| gusts | 2 | 1 |" in text
    assert "- VIOLATION: 1 (dlp, gusts)" in text
    assert "In the world" not in "\n".join(report([DONE]))


def test_tables_from_before_the_world_still_read():
    row = {key: value for key, value in DONE.as_row().items() if "world" not in key}
    assert same(trial_of(row), DONE)
