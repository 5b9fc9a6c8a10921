from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from radmpc.identification import Track, identify
from radmpc.plotting.residuals import plot_residuals
from simulator import Truth, fly


def drawn(axes, gid: str):
    return next(artist for artist in axes.get_children() if artist.get_gid() == gid)


def test_gaussian_residuals_lie_on_the_line_and_white_ones_in_the_band() -> None:
    quantiles, past = plot_residuals(identify(fly(Truth(steps=800), 1)))
    for axis in range(4):
        across, up = drawn(quantiles, f"quantiles:{axis}").get_data()
        inner = np.abs(across) < 1.5
        assert np.abs(up - across)[inner].max() < 0.25
    assert drawn(past, "white") is not None
    assert all(artist.get_gid() != "memory" for artist in past.get_children())


def test_memory_is_drawn_with_what_was_identified() -> None:
    found = identify(fly(Truth(steps=800, color=0.8), 2))
    figure = Figure()
    _, past = plot_residuals(found, figure)
    assert past.get_figure() is figure
    seconds, values = drawn(past, "memory").get_data()
    np.testing.assert_allclose(values, found.pooled.color ** (seconds / 0.5))
    assert past.get_xlabel() == "lag [s]"


def labels(axes) -> list[str]:
    return [text.get_text() for text in axes.get_legend().get_texts()]


def test_a_legend_names_the_states_of_the_colors() -> None:
    quantiles, _ = plot_residuals(identify(fly(Truth(steps=300), 3)))
    assert labels(quantiles) == ["x", "y", "vx", "vy"]


def test_a_legend_leaves_out_an_axis_that_never_moves() -> None:
    [track] = fly(Truth(steps=300), 4)
    parts = {name: np.array(getattr(track, name)) for name in track.parts()}
    for part in parts.values():
        part[:, 1] = 0.0
    quantiles, _ = plot_residuals(identify([track.changed(parts)]))
    assert labels(quantiles) == ["x", "vx"]


def test_colors_without_a_state_of_their_own_are_called_components() -> None:
    [track] = fly(Truth(steps=300), 5)
    parts = {name: np.array(getattr(track, name)) for name in track.parts()}
    for part in parts.values():
        part[:, 1] = part[:, 0]
    quantiles, _ = plot_residuals(identify([track.changed(parts)]))
    assert labels(quantiles) == ["component 1", "component 2"]


def test_residuals_of_vehicles_that_differ_lie_on_the_line_of_their_own_covariances() -> None:
    [calm], [wild] = fly(Truth(steps=800), 6), fly(Truth(steps=800, scale=9.0), 7)
    wild = Track("wild", "log.csv", "one", wild.times, wild.positions, wild.velocities,
                 wild.controls)  # fmt: skip
    found = identify([calm, wild])
    assert found.differ
    quantiles, _ = plot_residuals(found)
    for axis in range(4):
        across, up = drawn(quantiles, f"quantiles:{axis}").get_data()
        assert np.abs(up - across)[np.abs(across) < 2.0].max() < 0.25
