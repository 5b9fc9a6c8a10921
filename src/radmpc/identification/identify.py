"""From logs to noise and feedback, with what the logs do not tell."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arguments import check_integer, check_kind
from radmpc.errors import FileFormatError
from radmpc.identification.cleaning import clean, without_copies
from radmpc.identification.commands import command_warning
from radmpc.identification.differing import scaled_apart, vehicles_differ
from radmpc.identification.estimate import Estimate, estimate
from radmpc.identification.model import StepModel
from radmpc.identification.sampling import Samples, sample
from radmpc.identification.segments import Evidence, Transitions, segments, without_jumps
from radmpc.identification.sharing import Shared, shared_part
from radmpc.identification.timing import evened, native_period, phase, rounded_step
from radmpc.identification.track import Track, check_tracks
from radmpc.identification.unknown import unknowns
from radmpc.ranges import check_range
from radmpc.records import dataclass
from radmpc.wording import count_text

__all__ = ["Identification", "identify"]

_LEAST_STEPS = 10
"""Steps beyond the number of unknowns per row of the dynamics that estimates need at least."""

_FEW_STEPS = 100.0
"""Independent steps below which the numbers are called rough: variances by chi-square within -25 to
+35 %."""


@dataclass(frozen=True, slots=True, eq=False)
class Identification:
    """What logs tell of noise and feedback.

    Attributes
    ----------
    model : StepModel
        Step and dynamics that everything refers to.
    evidence : {'commands', 'references', 'states'}
        What was known beside the states.
    sources : tuple of str
        The files.
    start : float or None
        When the earliest log begins [s since 1970], if it says.
    pooled : Estimate
        Of all vehicles together; where they differ, tails and worth are those of residuals that
        each vehicle's own covariance scales.
    each : tuple of Estimate
        Of every vehicle that has enough steps of its own.
    differ : bool
        Whether vehicles differ beyond chance.
    shared : Shared or None
        The part of the noise they have in common; None where that cannot be told.
    unknown : tuple of str
        What the logs do not tell, and why.
    warnings : tuple of str
        Flaws of the logs, and what was done about them.
    """

    model: StepModel
    evidence: Evidence
    sources: tuple[str, ...]
    start: float | None
    pooled: Estimate
    each: tuple[Estimate, ...]
    differ: bool
    shared: Shared | None
    unknown: tuple[str, ...]
    warnings: tuple[str, ...]

    @property
    def groups(self) -> tuple[Estimate, ...]:
        """One estimate for all vehicles, or one for each where they differ."""
        return self.each if self.differ else (self.pooled,)


def identify(
    tracks: Sequence[Track],
    *,
    dt: float | None = None,
    dimension: int | None = None,
    warnings: Sequence[str] = (),
) -> Identification:
    """Return what logs tell of noise and feedback.

    Parameters
    ----------
    tracks : sequence of Track
        As logged, one or more per vehicle.
    dt : float or None
        Step that the numbers are to refer to [s]; None is the logs' own.
    dimension : int or None
        Axes to look at, 2 or 3; None is all that every log has.
    warnings : sequence of str
        What reading the logs had to say; goes before what is found here.

    Returns
    -------
    Identification
        Estimates with intervals.

    Raises
    ------
    ArgumentTypeError
        If the first is no sequence of tracks, or the dimension no integer.
    ArgumentError
        If the dimension is neither 2 nor 3.
    FileFormatError
        If a log contradicts itself, or there is too little of it.
    ScenarioError
        If the step is no number from 1e-6 to 1e6 s.

    Examples
    --------
    >>> import numpy as np
    >>> import radmpc
    >>> times, pushes = 0.5 * np.arange(400), np.random.default_rng(0).normal(size=(400, 2))
    >>> positions = np.cumsum(0.1 * pushes, axis=0)  # a raft that drifts at random
    >>> found = radmpc.identify([radmpc.Track("raft", "by hand", "mine", times, positions)])
    >>> np.round(np.sqrt(np.diag(found.pooled.covariance.value)), 1)
    array([0.1, 0.1])
    """
    asked = None if dt is None else check_range(dt, "s", ("dt",))
    axes = None if dimension is None else check_integer(dimension, "dimension", 2, 3)
    check_tracks(tracks)
    check_kind(warnings, (list, tuple), "warnings", "a list or tuple of texts")
    told = list(warnings)
    cleaned = _cleaned(tracks, axes, told)
    step = asked or _step(cleaned)
    at_steps = _sampled(cleaned, step, told)
    evidence = _evidence(cleaned, told)
    told += [line for one in at_steps for line in command_warning(one, evidence)]
    model = StepModel(step, cleaned[0].dimension, all(t.velocities is not None for t in cleaned))
    vehicles = _vehicles(at_steps, evidence, model, told)
    pooled = estimate(vehicles, model, evidence)
    own = [one for one in vehicles if one.num_steps >= _least(model, evidence)]
    each = (
        (pooled,) if len(vehicles) == 1 else tuple(estimate([one], model, evidence) for one in own)
    )
    differ = len(each) == len(vehicles) and vehicles_differ(pooled, each, model)
    shared = _shared(vehicles, each if differ else (pooled,), pooled)
    if shared is not None and shared.is_sure:
        pooled = estimate(vehicles, model, evidence, share=float(shared.share.value))
    if differ:
        alike = 0.0 if shared is None or not shared.is_sure else float(shared.share.value)
        pooled = scaled_apart(pooled, each, alike)
    if pooled.worth < _FEW_STEPS:
        worth = count_text(round(pooled.worth), "independent step")
        told.append(f"the logs are worth about {worth}: the numbers are rough")
    return Identification(
        model=model,
        evidence=evidence,
        sources=tuple(dict.fromkeys(track.source for track in tracks)),
        start=_start(cleaned),
        pooled=pooled,
        each=each,
        differ=differ,
        shared=shared,
        unknown=unknowns(pooled, shared, model, evidence, len(vehicles)),
        warnings=tuple(told),
    )


def _cleaned(tracks: Sequence[Track], dimension: int | None, warnings: list[str]) -> list[Track]:
    """Return what can be used of the logs, all with the same axes and parts of the state."""
    axes = min(track.dimension for track in tracks) if dimension is None else dimension
    if any(track.dimension > axes for track in tracks):
        warnings.append(f"only the first {axes} axes are looked at")
    found = []
    for track in tracks:
        kept, told = clean(track, dimension=axes)
        warnings += told
        if kept is not None:
            even, told = evened(kept)
            warnings += told
            found.append(even)
    own = [without_copies(track) for track in found]
    if any(a is not b for a, b in zip(found, own, strict=True)):
        warnings.append("references that are where the vehicle was are not used")
    found = own
    if not found:
        why = next((line for line in reversed(warnings) if "left out" in line), "")
        raise FileFormatError(f"the logs hold no sample that can be used{why and f': {why}'}")
    if any(t.velocities is None for t in found) and any(t.velocities is not None for t in found):
        lacking = next(t for t in found if t.velocities is None)
        raise FileFormatError(
            f"{lacking.where}: has no velocities, other vehicles have: identify them apart"
        )
    return found


def _step(tracks: Sequence[Track]) -> float:
    """Return the logs' own step, the longest of all, with as few digits as do."""
    periods = [native_period(track) for track in tracks]
    longest = max((period for period in periods if np.isfinite(period)), default=0.0)
    if longest <= 0.0:
        raise FileFormatError(f"{tracks[0].where}: has a single sample, too few for anything")
    return rounded_step(longest, max(round(float(np.ptp(t.times)) / longest) for t in tracks))


def _sampled(tracks: Sequence[Track], dt: float, warnings: list[str]) -> list[Samples]:
    """Return the tracks at steps that are common to those of one clock."""
    first: dict[str, Track] = {}
    for track in tracks:
        earlier = first.get(track.clock)
        if earlier is None or track.times[0] < earlier.times[0]:
            first[track.clock] = track
    starts = {clock: phase(track.times, dt) for clock, track in first.items()}
    found = []
    for track in tracks:
        samples, told = sample(track, dt, starts[track.clock])
        found.append(samples)
        warnings += told
    return found


def _evidence(tracks: Sequence[Track], warnings: list[str]) -> Evidence:
    """Return what all tracks have beside states."""
    for evidence, part in (("commands", "controls"), ("references", "references")):
        having = [t for t in tracks if getattr(t, part) is not None]
        if evidence == "commands" and having and having[0].velocities is None:
            continue
        if len(having) == len(tracks):
            return evidence  # type: ignore[return-value] # one of its literals
        if having:
            lacking = next(t for t in tracks if getattr(t, part) is None)
            warnings.append(f"{lacking.where}: has no {evidence}, so those of others are not used")
    return "states"


def _vehicles(
    at_steps: Sequence[Samples], evidence: Evidence, model: StepModel, warnings: list[str]
) -> list[Transitions]:
    """Return the transitions of every vehicle, those of several logs together."""
    found: dict[str, Transitions] = {}
    for samples in at_steps:
        one, jumps, largest = without_jumps(segments(samples, evidence), model.dimension)
        if jumps:
            word = "a jump" if jumps == 1 else f"{jumps} jumps, the largest"
            warnings.append(
                f"{samples.track.where}: has {word} of {largest:.3g} m, left out: no noise of the "
                "other steps gets there"
            )
        if one.name in found:
            one = found[one.name].joined(one)
        found[one.name] = one
    total = sum(one.num_steps for one in found.values())
    least = _least(model, evidence)
    if total < least:
        raise FileFormatError(
            f"{at_steps[0].track.source}: {total} steps of {model.dt:g} s are too few: at least "
            f"{least} are needed, and some hundreds for useful intervals"
        )
    return [one for one in found.values() if one.num_steps]


def _least(model: StepModel, evidence: Evidence) -> int:
    """Return how many steps estimates need."""
    return _LEAST_STEPS + model.num_states * (2 if evidence == "references" else 1)


def _shared(
    vehicles: Sequence[Transitions], groups: Sequence[Estimate], pooled: Estimate
) -> Shared | None:
    """Return the common part of the noise of vehicles whose times are comparable."""
    clocks: dict[str, list[str]] = {}
    for one in vehicles:
        clocks.setdefault(one.clock, []).append(one.name)
    names = max(clocks.values(), key=len)
    noise = {}
    for name in names:
        pieces = [(k, rows) for e in groups for owner, k, rows in e.noise if owner == name]
        steps = np.concatenate([np.arange(k, k + len(rows)) for k, rows in pieces])
        rows = np.concatenate([rows for _, rows in pieces])
        order = np.argsort(steps, kind="stable")
        if np.all(np.diff(steps[order]) > 0):
            noise[name] = (steps[order], rows[order] - rows.mean(axis=0))
    return shared_part(noise, max(pooled.color, 0.0), pooled.covariance.value)


def _start(tracks: Sequence[Track]) -> float | None:
    """Return when the earliest log begins, if its times count from 1970."""
    earliest = min(float(track.times[0]) for track in tracks)
    return earliest if earliest > 1e8 else None
