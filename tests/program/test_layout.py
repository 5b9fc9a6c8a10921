"""A program knows where things lie in it, and so does every part of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.experiments.families import clutter, paper
from radmpc.program.build import build_program, condensed_models, controls_of
from radmpc.program.restrict import avoidance_blocks, restrict, restrict_around


def _built(scenario):
    models = condensed_models(scenario)
    return models, build_program(scenario, models, risk_bound=scenario.risk_bound)


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_positions_and_controls_are_found_among_the_outputs(avoidance):
    models, program = _built(replace(paper(3, 0), avoidance=avoidance))
    layout = program.layout
    z = np.random.default_rng(0).uniform(0.0, 1.0, program.num_columns)
    outputs = program.outputs @ z + program.constant
    for i, (model, controls) in enumerate(zip(models, controls_of(models, z), strict=True)):
        shape = (layout.horizon + 1, layout.dimension)
        expected = model.drift_position + model.position @ controls.ravel()
        assert np.allclose(outputs[layout.positions[i]].reshape(shape), expected)
        plus, minus = np.split(outputs[layout.controls[i]], 2)
        assert np.array_equal(plus - minus, controls.ravel())
    assert layout.positions[-1].stop == layout.controls[0].start == program.num_positions
    assert layout.controls[-1].stop == outputs.size


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_windows_count_from_the_first_whatever_step_the_program_starts_at(avoidance):
    scenario = replace(clutter(1, 10, 0), avoidance=avoidance)
    models = condensed_models(scenario)
    for first_step in (0, 4):
        program = build_program(scenario, models, risk_bound=0.1, first_step=first_step)
        layout = program.layout
        windows = [layout.window_of(label.step) for label in program.avoidances]
        assert layout.intervals == (avoidance == "intervals")
        assert min(windows) >= 0
        assert max(windows) < layout.horizon
        # The far end of window j is step j + 1, along intervals and at steps.
        positions = program.rows.normals[:, layout.positions[0]].tocoo()
        steps = np.zeros(program.rows.count, dtype=int)
        np.maximum.at(steps, positions.row, positions.col // layout.dimension)
        for avoidance_number, window in enumerate(windows):
            for alternative in program.alternatives_of(avoidance_number):
                assert steps[program.rows_of(alternative)].max() == window + 1


def test_every_alternative_knows_its_avoidance_in_the_whole_and_in_parts():
    _, program = _built(paper(4, 0))
    touched = avoidance_blocks(program)
    z = np.zeros(program.num_columns)
    parts = [
        program,
        restrict(program, np.array([0, 2]), touched).program,
        restrict_around(program, np.array([1]), np.array([3]), z, touched).program,
    ]
    for part in parts:
        owners = part.layout.owners
        assert owners.size == part.num_alternatives > 0
        for avoidance in range(part.num_avoidances):
            assert np.array_equal(
                np.flatnonzero(owners == avoidance), part.alternatives_of(avoidance)
            )
        assert part.entry_owners().size == part.alternative_rows.size
        for alternative in range(part.num_alternatives):
            members = part.alternative_rows[part.entry_owners() == alternative]
            assert np.array_equal(members, part.rows_of(alternative))
    assert parts[2].num_avoidances < program.num_avoidances
