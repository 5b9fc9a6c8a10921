"""What a mission makes of a measurement: what is known now, and what speaks against the model."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Vector
from radmpc.errors import ArgumentError
from radmpc.flying.knowing import expected_anew
from radmpc.flying.leg import Leg
from radmpc.flying.measuring import are_known_alike
from radmpc.flying.sensing.alarms import Watcher
from radmpc.flying.sensing.evidence import Evidence
from radmpc.flying.sensing.observing import Observer
from radmpc.model.scenario import Scenario
from radmpc.records import dataclass, replace

__all__ = ["Sensing"]


@dataclass(slots=True, eq=False)
class Sensing:
    """Everything that measurements have left behind.

    Attributes
    ----------
    watcher : Watcher
        Compares them with what was expected.
    observer : Observer
        Makes of them what is known of vehicles.
    evidence : Evidence
        And of covariances known up to a factor.
    seen : tuple or None
        The last step that was looked at, what is known by it, and its alarms; None before one was.
    """

    watcher: Watcher
    observer: Observer
    evidence: Evidence
    seen: tuple[int, tuple[Vector, ...], tuple[str, ...]] | None = None

    @classmethod
    def of(cls, scenario: Scenario) -> Sensing:
        """Return what there is before anything is measured.

        Parameters
        ----------
        scenario : Scenario
            Of the mission.
        """
        return cls(Watcher(scenario), Observer.of(scenario), Evidence.of(scenario))

    def begin_again(
        self, leg: Leg, tail: Leg, expected: Sequence[Vector]
    ) -> tuple[Leg, tuple[Vector, ...]]:
        """Go on with a leg of another scenario, with all that is known where its plan says so.

        Parameters
        ----------
        leg : Leg
            Of the steps that are left.
        tail : Leg
            In the air until then.
        expected : sequence of (n,), (2 n + s,) or (3 (2 n + s),) array
            What was expected to be known.

        Returns
        -------
        Leg, tuple of array
            The leg by what is known of covariances, and what is expected now.

        Raises
        ------
        ScenarioError
            If its plan does not say what is known where vehicles learn of each other's states.
        """
        scenario, step = leg.plan.scenario, leg.began
        if self.seen is not None and self.seen[0] == step:
            rest = self.evidence.left(tail, step, self.seen[1], scenario.risk_bound)
            if are_known_alike(scenario, rest):
                known = leg.begun(self.seen[1])
                self.seen = step, known, self.seen[2]
                self.evidence = self.evidence.elsewhere(scenario, step)
                return replace(leg, scale=self.evidence.scale), known
        begun = expected_anew(scenario, expected)
        self.watcher = Watcher(scenario, self.watcher.squares)
        self.observer = Observer.of(scenario, step)
        self.evidence = Evidence.of(scenario, step)
        self.seen = None
        return leg, begun

    def look(
        self,
        step: int,
        expected: Sequence[Vector],
        states: Sequence[Vector],
        leg: Leg | None = None,
        *,
        is_certain: bool,
    ) -> tuple[tuple[Vector, ...], list[str]]:
        """Take note of a measurement, once; return what is known by it, and alarms.

        Parameters
        ----------
        step : int
            Of the mission.
        expected : sequence of (n,) or (2 n,) array
            What was expected to be known.
        states : sequence of (n,) array
            Measured states, or estimates.
        leg : Leg or None
            In the air; None is the first one.
        is_certain : bool
            Whether it was known at the step before where vehicles were: what was not measured may
            be off by twice the noise.

        Raises
        ------
        ArgumentError
            If other states were measured at this step before.
        """
        if self.seen is not None and self.seen[0] == step:
            self._check_same(states)
            return self.seen[1], list(self.seen[2])
        acting = None if leg is None else (leg.began, leg.plan.scenario)
        known = self.observer.observed(step, expected, states, acting)
        seen = step, expected, states, self.observer.corrections(step)
        together = self.observer.joint_innovation(*seen[:3])
        alarms = []
        if is_certain:
            shaken = together or self.evidence.shaken(*seen[:3])
            alarms = self.watcher.look(*seen, self.evidence.scale, shaken)
        self.evidence = self.evidence.after(*seen, together)
        self.seen = step, known, tuple(alarms)
        return known, alarms

    def _check_same(self, states: Sequence[Vector]) -> None:
        """Refuse states that are not those of the step that was looked at."""
        before = () if self.seen is None else self.seen[1]
        for i, (known, state) in enumerate(zip(before, states, strict=True)):
            if not np.array_equal(known[: state.size], state):
                raise ArgumentError(
                    f"states[{i}] must be as this step was measured already, "
                    f"{known[: state.size].tolist()}, got {state.tolist()}"
                )
