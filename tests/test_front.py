"""Packages whose names are loaded when they are first used."""

from __future__ import annotations

from importlib import import_module

import pytest

from radmpc.front import late_names

FRONTS = ["radmpc", "radmpc.planners", "radmpc.planners.policies", "radmpc.referee"]


@pytest.mark.parametrize("front", FRONTS)
def test_a_front_has_every_name_that_it_lists(front: str) -> None:
    package = import_module(front)
    assert dir(package) == sorted(package.__all__)
    assert [name for name in package.__all__ if not hasattr(package, name)] == []


@pytest.mark.parametrize("front", FRONTS)
def test_a_front_has_no_other_names(front: str) -> None:
    with pytest.raises(AttributeError, match=rf"module '{front}' has no attribute 'plam'"):
        _ = import_module(front).plam


def test_a_name_is_kept_once_it_is_loaded(monkeypatch: pytest.MonkeyPatch) -> None:
    package = import_module("radmpc.referee")
    monkeypatch.delattr(package, "certify", raising=False)
    load, _ = late_names("radmpc.referee", {"referee.bound.certificate": ("certify",)})
    certify = load("certify")
    assert vars(package)["certify"] is certify
