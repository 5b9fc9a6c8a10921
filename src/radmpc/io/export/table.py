"""CSV: one line per vehicle and step, in the plan's own coordinates."""

from __future__ import annotations

import csv
from io import StringIO

from radmpc.io.export.job import Job
from radmpc.io.export.tracks import TimedPath

__all__ = ["write_table"]

_AXES = "xyz"


def write_table(job: Job) -> bytes:
    """Return a plan as a table.

    Parameters
    ----------
    job : Job
        The plan; its place on earth is not used.

    Returns
    -------
    bytes
        Columns as in `radmpc.to_pandas`. Numbers read back equal. What a vehicle does not have is
        empty: a velocity, some of the controls, those after the last step.
    """
    axes = _AXES[: job.plan.scenario.dimension]
    num_controls = max(track.controls.shape[1] for track in job.tracks)
    buffer = StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(
        ["t", "name", *axes, *(f"v{axis}" for axis in axes)]
        + [f"three_sigma_{axis}" for axis in axes]
        + [f"u{i + 1}" for i in range(num_controls)]
    )
    for track in job.tracks:
        writer.writerows(_row(track, step, num_controls) for step in range(len(track.times)))
    return buffer.getvalue().encode()


def _row(track: TimedPath, step: int, num_controls: int) -> list[str]:
    """Return the cells of a vehicle at a step."""
    position = track.positions[step].tolist()
    velocity = None if track.velocities is None else track.velocities[step].tolist()
    is_last = step == len(track.controls)
    controls = [] if is_last else track.controls[step].tolist()
    numbers = [
        *position,
        *(velocity or [None] * len(position)),
        *track.three_sigma[step].tolist(),
        *controls,
        *[None] * (num_controls - len(controls)),
    ]
    cells = ["" if number is None else repr(number) for number in numbers]
    return [repr(float(track.times[step])), track.name, *cells]
