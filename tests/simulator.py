"""Flights with known noise: a simulator of the tests' own, and logs of them as text."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from radmpc.identification import Track

AXES = "xyz"


@dataclass(frozen=True)
class Truth:
    """What a simulated flight is made with; d = 2, dt = 0.5 s unless said otherwise."""

    steps: int = 600
    dt: float = 0.5
    dimension: int = 2
    vehicles: int = 1
    color: float = 0.0
    share: float = 0.0
    freedom: float | None = None
    drift: tuple[float, ...] = ()
    seen: tuple[float, ...] = ()
    feedback: tuple[float, float] = (-0.3, -0.8)
    scale: float = 1.0

    @property
    def spread(self) -> np.ndarray:
        """W."""
        d = self.dimension
        variances = [0.010, 0.020, 0.015][:d] + [0.004, 0.003, 0.005][:d]
        return self.scale * (np.diag(variances) + 0.002)

    @property
    def gain(self) -> np.ndarray:
        """K."""
        eye = np.eye(self.dimension)
        return np.hstack([self.feedback[0] * eye, self.feedback[1] * eye])

    @property
    def push(self) -> np.ndarray:
        """c."""
        return np.array(self.drift) if self.drift else np.zeros(2 * self.dimension)

    @property
    def measurement(self) -> np.ndarray:
        """R."""
        return np.diag(self.seen) if self.seen else np.zeros(2 * (2 * self.dimension,))

    @property
    def time_constant(self) -> float:
        return -self.dt / np.log(self.color)


def dynamics(dt: float, dimension: int) -> tuple[np.ndarray, np.ndarray]:
    """A and B of a double integrator."""
    eye, zero = np.eye(dimension), np.zeros((dimension, dimension))
    A = np.block([[eye, dt * eye], [zero, eye]])
    return A, np.vstack([0.5 * dt**2 * eye, dt * eye])


def fly(truth: Truth, seed: int, log: str = "commands") -> tuple[Track, ...]:
    """Fly along a winding reference; ``log`` names what is logged beside the states."""
    rng = np.random.default_rng(seed)
    common = _noise(truth, rng)
    tracks = []
    for number in range(truth.vehicles):
        own = np.sqrt(truth.share) * common + np.sqrt(1.0 - truth.share) * _noise(truth, rng)
        states, controls, references = _flown(truth, own @ np.linalg.cholesky(truth.spread).T)
        n = states.shape[1]
        seen = states + rng.multivariate_normal(np.zeros(n), truth.measurement, len(states))
        d = truth.dimension
        tracks.append(
            Track(
                f"v{number + 1}", "log.csv", "one", truth.dt * np.arange(len(states)),
                seen[:, :d], seen[:, d:],
                controls if log in {"commands", "both"} else None,
                references if log in {"references", "both"} else None,
            )
        )  # fmt: skip
    return tuple(tracks)


def _noise(truth: Truth, rng: np.random.Generator) -> np.ndarray:
    """Unit noise with memory."""
    shape = (truth.steps, 2 * truth.dimension)
    fresh = rng.standard_normal(shape)
    if truth.freedom is not None:
        nu = truth.freedom
        fresh *= np.sqrt((nu - 2.0) / rng.chisquare(nu, truth.steps))[:, None]
    if truth.color == 0.0:
        return fresh
    found = np.empty(shape)
    found[0] = fresh[0]
    for k in range(1, truth.steps):
        found[k] = truth.color * found[k - 1] + np.sqrt(1.0 - truth.color**2) * fresh[k]
    return found


def _flown(truth: Truth, noise: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """States, commands and references of one flight."""
    A, B = dynamics(truth.dt, truth.dimension)
    times = truth.dt * np.arange(truth.steps + 1)
    phases = np.arange(1, truth.dimension + 1)
    planned = 0.01 * np.sin(0.05 * phases * times[:, None] + phases)
    references = np.zeros((truth.steps + 1, 2 * truth.dimension))
    states = np.zeros_like(references)
    controls = np.zeros((truth.steps + 1, truth.dimension))
    gain, push = truth.gain, truth.push
    for k in range(truth.steps):
        references[k + 1] = A @ references[k] + B @ planned[k]
        controls[k] = planned[k] + gain @ (states[k] - references[k])
        states[k + 1] = A @ states[k] + B @ controls[k] + push + noise[k]
    return states, controls, references


def as_csv(tracks: tuple[Track, ...], digits: int = 6) -> str:
    """The same as a log in CSV, the rows of all vehicles by time."""
    axes = AXES[: tracks[0].dimension]
    forms = {"positions": "{}", "velocities": "v{}", "controls": "a{}", "references": "{}_ref"}
    names = ["time", "vehicle"]
    for part in tracks[0].parts():
        names += [forms[part].format(axis) for axis in axes]
        if part == "references" and tracks[0].references.shape[1] > len(axes):
            names += [f"v{axis}_ref" for axis in axes]
    lines = [",".join(names)]
    for k in range(len(tracks[0].times)):
        for track in tracks:
            cells = [f"{track.times[k]:.{digits}f}", track.name]
            for part in track.parts():
                cells += [f"{number:.{digits}f}" for number in getattr(track, part)[k]]
            lines.append(",".join(cells))
    return "\n".join(lines) + "\n"
