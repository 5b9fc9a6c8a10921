"""Backends by name: found, refused, and loaded no sooner than they are asked for."""

import sys
from types import ModuleType

import pytest

import radmpc
from radmpc.errors import ArgumentError, ArgumentTypeError
from radmpc.experiments.families import paper
from radmpc.flying.backends import BACKENDS, BackendKind, backend_named
from radmpc.io.flight.record import FlightSettings


def test_the_model_is_a_backend_and_its_seed_counts() -> None:
    scenario = paper(2, seed=1)
    one, two, other = (backend_named("model").make(scenario, rng=seed) for seed in (3, 3, 4))
    assert isinstance(one, radmpc.Model)
    states = [backend.reset()[0][0].tolist() for backend in (one, two, other)]
    assert states[0] == states[1] != states[2]


def test_a_name_that_no_backend_has_is_refused_with_those_there_are() -> None:
    with pytest.raises(ArgumentError, match="one of model, rotorpy, irsim, boat, mavlink, got 'x'"):
        backend_named("x")


@pytest.mark.parametrize("name", ["rotorpy", "irsim", "mavlink"])
def test_a_backend_whose_extra_is_missing_names_what_installs_it(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    kind = BACKENDS[name]
    monkeypatch.setitem(sys.modules, kind.factory.split(":")[0], None)
    with pytest.raises(ArgumentError) as error:
        kind.make(paper(2, seed=1), rng=0)
    assert f"backend {name!r} needs: pip install 'radmpc[{name}]'" in str(error.value)
    assert "\n" not in str(error.value)


def test_an_extra_that_is_missed_only_when_the_backend_is_made_is_named_too(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def factory(*given: object, **options: object) -> None:
        raise ModuleNotFoundError("No module named 'rotor'")

    module = ModuleType("made_up")
    monkeypatch.setattr(module, "factory", factory, raising=False)
    monkeypatch.setitem(sys.modules, "made_up", module)
    kind = BackendKind("rotor", "made_up:factory", "rotor", "")
    with pytest.raises(ArgumentError, match=r"pip install 'radmpc\[rotor\]' \(No module named"):
        kind.make(paper(2, seed=1), rng=0)
    without = BackendKind("rotor", "made_up:factory", None, "")
    with pytest.raises(ArgumentError, match="backend 'rotor' cannot be loaded: No module named"):
        without.make(paper(2, seed=1), rng=0)


def test_an_option_that_a_backend_does_not_take_is_named() -> None:
    with pytest.raises(ArgumentTypeError, match="'model' takes no option 'wind', got 3"):
        backend_named("model").make(paper(2, seed=1), rng=0, wind=3)


def test_options_that_a_backend_takes_are_listed_where_another_is_given() -> None:
    taken = "it takes current, current_deviation, force, gust_time"
    with pytest.raises(ArgumentTypeError, match=f"no option 'curent', got '1,0'; {taken}"):
        backend_named("boat").check_options({"curent": "1,0"})
    with pytest.raises(ArgumentTypeError, match="got 3; it takes none"):
        backend_named("model").check_options({"wind": 3})


@pytest.mark.parametrize("name", ["scenario", "rng", "self"])
@pytest.mark.parametrize("backend", ["model", "boat"])
def test_what_every_backend_is_made_of_is_no_option(backend: str, name: str) -> None:
    plan = radmpc.plan(paper(2, seed=1)).require()
    settings = FlightSettings(backend=backend, replan=None, options={name: "3"})
    with pytest.raises(ArgumentTypeError, match=f"'{backend}' takes no option '{name}', got '3'"):
        radmpc.begin_flight(plan, settings)


def test_a_defect_of_a_backend_is_not_told_as_an_option_that_it_does_not_take(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def factory(scenario: object, rng: object, *, wind: float) -> None:
        raise TypeError(f"blow() got an unexpected keyword argument 'wind': {wind}")

    module = ModuleType("made_up")
    monkeypatch.setattr(module, "factory", factory, raising=False)
    monkeypatch.setitem(sys.modules, "made_up", module)
    with pytest.raises(TypeError, match=r"blow\(\) got") as caught:
        BackendKind("gale", "made_up:factory", None, "").make(paper(2, seed=1), rng=0, wind=3)
    assert not isinstance(caught.value, ArgumentError)
