"""Several charts as one: features of all files, with names kept apart."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from pathlib import Path as FilePath

from radmpc.errors import ScenarioError
from radmpc.geodesy import Origin
from radmpc.importing.geo.feature import Feature
from radmpc.importing.geo.geojson import geojson_features, is_geojson
from radmpc.importing.geo.ground import Ground, ground_of
from radmpc.importing.geo.kml import is_kml, kml_features
from radmpc.importing.geo.layers import Layers
from radmpc.importing.geo.problem import geo_problem
from radmpc.importing.geo.properties import OBSTACLES
from radmpc.importing.geo.relations import renamed_relations
from radmpc.importing.problem import ForeignProblem
from radmpc.io.export.names import distinct
from radmpc.io.text.document import Document
from radmpc.records import dataclass, replace
from radmpc.wording import count_text

__all__ = ["is_chart", "read_charts", "read_ground"]

_OF_VEHICLES = ("start", "goal", "via")


@dataclass(frozen=True, slots=True, eq=False)
class _Kind:
    """A format of charts: its name, how it is known, how its features are read."""

    name: str
    recognizes: Callable[[object], bool]
    features: Callable[[Document, Layers, Sequence[str]], Iterator[Feature]]


_KINDS = (
    _Kind("geojson", is_geojson, geojson_features),
    _Kind("kml", is_kml, kml_features),
)


def is_chart(value: object) -> bool:
    """Whether a file's content is a chart: GeoJSON or KML.

    Parameters
    ----------
    value : object
        What the file holds.
    """
    return any(kind.recognizes(value) for kind in _KINDS)


def read_charts(documents: Sequence[Document], layer: Sequence[str] = ()) -> ForeignProblem:
    """Return the problem drawn in one chart or in several together.

    Parameters
    ----------
    documents : sequence of Document
        Charts, at least one.
    layer : sequence of str
        Layers that are taken, as in `ImportOptions`; none takes all.

    Returns
    -------
    ForeignProblem
        Names that stand in several files for different things are led by the file's.

    Raises
    ------
    ScenarioError
        If something is missing or not known here. With several files the first part of its path is
        the file's index, unless it is about no file in particular.
    """
    layers = Layers.asked(layer)
    kinds = [next(k for k in _KINDS if k.recognizes(d.value)) for d in documents]
    files = distinct((str(i) for i in range(len(documents))), lambda i: _stem(documents[int(i)]))
    drawn: list[list[Feature]] = []
    for i, (kind, document) in enumerate(zip(kinds, documents, strict=True)):
        # Files of one name are one layer by that, and each a layer by the name told in choices.
        names = tuple(dict.fromkeys((_stem(document), files[str(i)])))
        try:
            found = list(kind.features(document, layers, names))
        except ScenarioError as error:
            raise error.under(i) from error
        drawn.append([_placed(feature, i) for feature in found])
    layers.check()
    if len(documents) > 1:
        features, told = _together(drawn, list(files.values()))
    else:
        features, told = drawn[0], ()
    problem = geo_problem(features)
    return replace(
        problem,
        name=_stem(documents[0]),
        format=" + ".join(dict.fromkeys(kind.name for kind in kinds)),
        file=", ".join(FilePath(document.name).name for document in documents),
        reasons=(*told, *layers.notes(), *problem.reasons),
        warnings=(*layers.warnings(), *problem.warnings),
    )


def read_ground(document: Document, origin: Origin | None = None) -> Ground:
    """Return what stands on one chart, vehicles or not.

    Parameters
    ----------
    document : Document
        A chart.
    origin : Origin or None
        Of the plane that it is drawn in; None leaves that to the chart.

    Raises
    ------
    ScenarioError
        As in `read_charts`.
    """
    kind = next(k for k in _KINDS if k.recognizes(document.value))
    features = list(kind.features(document, Layers.asked(()), (_stem(document),)))
    return ground_of(features, origin)


def _stem(document: Document) -> str:
    """Return a file's name without folder and ending."""
    return FilePath(document.name).stem


def _placed(feature: Feature, index: int) -> Feature:
    """Return a feature whose paths begin with the index of its file."""
    return replace(
        feature,
        path=(index, *feature.path),
        shape_path=(index, *feature.shape_path),
        properties_path=(index, *feature.properties_path),
    )


def _together(
    drawn: Sequence[Sequence[Feature]], files: Sequence[str]
) -> tuple[list[Feature], tuple[tuple[str, str], ...]]:
    """Return the features of several files, and what was done about their names.

    What stands alike in several charts, such as a pier on neighboring sheets, is taken once. A
    vehicle may start in one file and end in another; if it starts in two, they are two.
    """
    seen: set[object] = set()
    kept: list[list[Feature]] = []
    repeated = 0
    starts = _clashes(drawn, "start")
    drawn = [_own(features, file, starts) for features, file in zip(drawn, files, strict=True)]
    for features in drawn:
        alike = [(feature, _content(feature)) for feature in features]
        fresh = [feature for feature, content in alike if content is None or content not in seen]
        repeated += len(features) - len(fresh)
        # Within one file the same twice is a mistake, which is told later.
        seen.update(content for _, content in alike if content is not None)
        kept.append(fresh)
    clashes = _clashes(kept, "obstacle")
    features = [
        _apart(feature, file, clashes)
        for features, file in zip(kept, files, strict=True)
        for feature in features
    ]
    counts = (f"{count_text(len(k), 'feature')} of {f}" for k, f in zip(kept, files, strict=True))
    told = [("charts", ", ".join(counts))]
    if repeated:
        twice = count_text(repeated, "feature")
        told.append(("drawn alike", f"{twice} of several charts, each taken once"))
    names = sorted(starts | clashes)
    if names:
        told.append(("names", f"{', '.join(names[:5])}: led by the file's, as several have them"))
    return features, tuple(told)


def _own(features: Sequence[Feature], file: str, clashes: Collection[str]) -> list[Feature]:
    """Return the features of a file under names of vehicles that no other file has.

    The name of a vehicle means that of the same file, if one starts there.
    """
    own = {feature.vehicle for feature in features if feature.role == "start"}
    names = {name: f"{file}/{name}" for name in own if name in clashes}
    found = []
    for feature in features:
        one = renamed_relations(feature, names)
        if one.role in _OF_VEHICLES and one.vehicle in clashes:
            renamed = f"{file}/{one.vehicle}"
            one = replace(one, properties={**one.properties, "vehicle": renamed})
        found.append(one)
    return found


def _content(feature: Feature) -> object:
    """Return what a feature of an obstacle, an area or an origin says; None of vehicles' places."""
    role = feature.role
    if role in _OF_VEHICLES:
        return None
    rings = tuple(ring.tobytes() for ring in feature.rings)
    if role == "origin":
        return role, rings
    stated = (str(feature.properties.get(key)) for key in OBSTACLES)
    return role, feature.kind, rings, feature.name, *stated


def _clashes(drawn: Sequence[Sequence[Feature]], role: str) -> set[str]:
    """Return names of obstacles, or of vehicles that start, in more than one file."""
    clashes: set[str] = set()
    taken: set[str] = set()
    for features in drawn:
        own = {_name(feature) for feature in features if feature.role == role} - {None}
        clashes |= {name for name in own if name in taken}
        taken |= {name for name in own if name is not None}
    return clashes


def _name(feature: Feature) -> str | None:
    """Return the name of an obstacle, or of the vehicle whose place it is."""
    return feature.vehicle if feature.role in _OF_VEHICLES else feature.name


def _apart(feature: Feature, file: str, clashes: Collection[str]) -> Feature:
    """Return an obstacle under a name that no other file has; anything else as it is."""
    if feature.role != "obstacle" or feature.name is None or feature.name not in clashes:
        return feature
    return replace(feature, properties={**feature.properties, "name": f"{file}/{feature.name}"})
