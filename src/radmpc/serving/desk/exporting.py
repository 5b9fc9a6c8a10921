"""Plans in the formats of other tools, for the page to download."""

from __future__ import annotations

import asyncio
import base64
import io
import zipfile
from collections.abc import Mapping
from typing import Any

from radmpc.errors import ScenarioError
from radmpc.model.plan import Plan
from radmpc.serving.desk import arguments as given
from radmpc.serving.desk.desk import Desk
from radmpc.serving.failures import refused
from radmpc.serving.protocol import Named

__all__ = ["exported", "exports"]

Args = Mapping[str, Any]

_EXPORTS = {
    "geojson": "GeoJSON: paths, goals and obstacles on a map",
    "kml": "KML: the same for Google Earth, with times",
    "csv": "Table: every vehicle at every step",
    "mcap": "MCAP: ROS 2 paths and markers",
    "qgc": "QGroundControl: a mission for each vehicle",
    "waypoints": "Waypoints: a mission for each vehicle, as MAVLink text",
}


def exports() -> list[Named]:
    """Return the formats that plans are written in."""
    return [{"name": name, "text": text} for name, text in _EXPORTS.items()]


async def exported(desk: Desk, args: Args) -> object:
    """Return a plan in another format: one file, or several in an archive."""
    kept = desk.plan(given.text(args, "plan"))
    kind = given.text(args, "format")
    if kind not in _EXPORTS:
        raise refused(f"format must be one of {', '.join(_EXPORTS)}")
    try:
        name, content, warnings = await asyncio.to_thread(_export, kept.plan, kind)
    except ScenarioError as error:
        if error.path != ("origin",):
            raise
        raise refused(
            f"{kind} needs the plan's place on earth: state it in the scenario's file as "
            "'source: {origin: {latitude: …, longitude: …}}', or save the plan and use "
            "radmpc export --origin"
        ) from error
    encoded = base64.b64encode(content).decode("ascii")
    return {"name": name, "base64": encoded, "warnings": warnings}


def _export(plan: Plan, kind: str) -> tuple[str, bytes, list[str]]:
    """Return the name and the content of an export, and what is to be known before it is used."""
    from radmpc.io.export.exporting import export_plan  # noqa: PLC0415 - few are asked for
    from radmpc.io.export.names import file_part  # noqa: PLC0415 - few are asked for

    suffix = {"qgc": "plan"}.get(kind, kind)
    stem = file_part(plan.scenario.name) or "plan"
    made = export_plan(plan, kind, f"{stem}.{suffix}")
    files = {path.name: content for path, content in made.files.items()}
    certified, bound = plan.risk.certified, plan.scenario.risk_bound
    warnings = list(made.warnings)
    if certified is None or certified > bound:
        warnings.append(f"the plan is not certified within its risk bound {bound:g}")
    if len(files) == 1:
        ((name, content),) = files.items()
        return name, content, warnings
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as packed:
        for name, content in files.items():
            packed.writestr(name, content)
    return f"{stem}.{kind}.zip", archive.getvalue(), warnings
