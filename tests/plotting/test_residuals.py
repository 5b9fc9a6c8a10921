from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from radmpc.identification import identify
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
