"""What a mission can be flown with, by name: the scenario's model, simulators, vehicles.

A backend is loaded when it is asked for: simulators come as extras, and most runs need none.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from inspect import Parameter, signature
from types import MappingProxyType

import numpy as np

from radmpc.arguments import value_text
from radmpc.errors import ArgumentError, ArgumentTypeError, ScenarioError
from radmpc.flying.model import Backend
from radmpc.model.scenario import Scenario
from radmpc.records import dataclass

__all__ = ["BACKENDS", "Backend", "BackendKind", "backend_named"]

_GIVEN = ("self", "scenario", "rng")
"""What every backend is made of, and what is therefore no option of it."""


@dataclass(frozen=True, slots=True)
class BackendKind:
    """A kind of backend, not loaded yet.

    Attributes
    ----------
    name : str
        As on the command line.
    factory : str
        Where it is made, as ``module:name``; called with the scenario, ``rng`` and options.
    extra : str or None
        The extra that it needs; None needs none.
    help : str
        What it is, in a few words.
    repeats : bool
        Whether the same seed and controls lead to the same states: vehicles do not repeat.
    is_exact : bool
        Whether its states are exact, and its obstacles where they are expected.
    """

    name: str
    factory: str
    extra: str | None
    help: str
    repeats: bool = True
    is_exact: bool = False

    def make(
        self, scenario: Scenario, rng: np.random.Generator | int | None = None, **options: object
    ) -> Backend:
        """Return one of it.

        Parameters
        ----------
        scenario : Scenario
            What is flown.
        rng : Generator or int or None
            Source of its noise, or its seed.
        **options : object
            What else it takes.

        Returns
        -------
        Backend
            Not yet reset.

        Raises
        ------
        ArgumentError
            If its extra is not installed.
        ArgumentTypeError
            If it does not take an option.
        RadmpcError
            If it cannot fly the scenario.
        """
        if self.is_exact:
            self._check_exact(scenario)
        self.check_options(options)
        try:
            return self._loaded()(scenario, rng=rng, **options)
        except ImportError as error:
            raise ArgumentError(self._lack(error)) from error

    def check_options(self, options: Mapping[str, object]) -> None:
        """Refuse options that it does not take; scenario and rng are none.

        Parameters
        ----------
        options : mapping
            By name, as given.

        Raises
        ------
        ArgumentError
            If its extra is not installed.
        ArgumentTypeError
            If it does not take one of them.
        """
        try:
            taken = list(signature(self._loaded()).parameters.values())[1:]
        except ImportError as error:
            raise ArgumentError(self._lack(error)) from error
        names = [each.name for each in taken if each.name != "rng"]
        is_open = any(each.kind is Parameter.VAR_KEYWORD for each in taken)
        for name, value in options.items():
            if name in _GIVEN or not (is_open or name in names):
                raise ArgumentTypeError(
                    f"backend {self.name!r} takes no option {name!r}, got {value_text(value)}; "
                    f"it takes {', '.join(names) or 'none'}"
                )

    def _check_exact(self, scenario: Scenario) -> None:
        """Refuse what is charged for not being known exactly, where it would be."""
        for i, vehicle in enumerate(scenario.vehicles):
            if vehicle.measurement is not None:
                message = f"backend {self.name!r} reports exact states, and no estimates"
                raise ScenarioError(message, ("vehicles", i, "measurement"))
        for i, obstacle in enumerate(scenario.obstacles):
            if obstacle.spread is not None:
                message = (
                    f"backend {self.name!r} has {obstacle.name!r} where it is expected, and does "
                    "not let it stray"
                )
                raise ScenarioError(message, ("obstacles", i, "moving", "covariance"))

    def _loaded(self) -> Callable[..., Backend]:
        """Return the factory."""
        module, name = self.factory.split(":")
        found: Callable[..., Backend] = getattr(import_module(module), name)
        return found

    def _lack(self, error: ImportError) -> str:
        """Return what is missing, and what installs it."""
        if self.extra is None:
            return f"backend {self.name!r} cannot be loaded: {error}"
        return f"backend {self.name!r} needs: pip install 'radmpc[{self.extra}]' ({error})"


BACKENDS: Mapping[str, BackendKind] = MappingProxyType(
    {
        kind.name: kind
        for kind in (
            BackendKind("model", "radmpc.flying.model:Model", None, "the scenario's own dynamics"),
            BackendKind(
                "rotorpy",
                "radmpc.simulators.rotorpy:Rotorpy",
                "rotorpy",
                "quadrotors with drag, motor lag and gusts",
                is_exact=True,
            ),
            BackendKind(
                "irsim",
                "radmpc.simulators.irsim:IrSim",
                "irsim",
                "differential and car-like robots",
                is_exact=True,
            ),
            BackendKind(
                "boat",
                "radmpc.simulators.boat:Boat",
                None,
                "boats in a current",
                is_exact=True,
            ),
            BackendKind(
                "mavlink",
                "radmpc.simulators.mavlink:Mavlink",
                "mavlink",
                "vehicles that speak MAVLink",
                repeats=False,
            ),
        )
    }
)
"""Kinds of backend by name."""


def backend_named(name: str) -> BackendKind:
    """Return the kind of backend that has a name.

    Parameters
    ----------
    name : str
        As on the command line.

    Returns
    -------
    BackendKind
        Not loaded yet.

    Raises
    ------
    ArgumentError
        If there is none of this name.
    """
    if name not in BACKENDS:
        raise ArgumentError(f"backend must be one of {', '.join(BACKENDS)}, got {value_text(name)}")
    return BACKENDS[name]
