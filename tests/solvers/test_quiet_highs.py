"""HiGHS prints nothing: stdout belongs to the caller, as JSON or as a report."""

from __future__ import annotations

import highspy
import numpy as np
import pytest

from radmpc.solvers.lp.quiet_highs import optimum, quiet_highs


def test_highs_prints_nothing_from_its_first_moment_on(capfd: pytest.CaptureFixture[str]) -> None:
    highs = quiet_highs()
    highs.addVar(1.0, 2.0)
    highs.changeColCost(0, 1.0)
    np.testing.assert_allclose(optimum(highs), [1.0])
    captured = capfd.readouterr()
    assert (captured.out, captured.err) == ("", "")


def test_highs_is_silent_before_its_constructor_calls_it(monkeypatch: pytest.MonkeyPatch) -> None:
    # From 1.16 on it prints its version at the first call, which the constructor makes itself.
    seen = []
    enable = highspy.Highs.enableCallbacks

    def watched(highs: highspy.Highs) -> None:
        seen.append(highs.getOptionValue("output_flag")[1])
        enable(highs)

    monkeypatch.setattr(highspy.Highs, "enableCallbacks", watched)
    quiet_highs()
    assert seen == [False]
