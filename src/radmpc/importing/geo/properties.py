"""Properties of drawn features: which are read, and which drawing programs add."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Mapping

__all__ = ["OBSTACLES", "SETTINGS", "misplaced_properties", "stated", "unknown_properties"]

SETTINGS: Mapping[str, tuple[str, str]] = {
    "radius": ("radius", "m"),
    "speed_limit": ("speed_limit", "m/s"),
    "speed": ("speed_limit", "m/s"),
    "control_limit": ("control_limit", "m/s²"),
    "acceleration": ("control_limit", "m/s²"),
}
"""Properties that describe a vehicle: what each sets, and its unit."""

_MOVING = ("course", "position_deviation", "speed_deviation", "course_deviation")
_RELATIONS = ("for", "except", "keep", "range")

OBSTACLES = ("speed", *_MOVING, "for", "except")
"""Properties that tell obstacles of one shape apart."""

_VISITS = ("order", "half_width", "after", "before")
_KNOWN = (
    *("name", "role", "kind", "vehicle", "height", "layer"),
    *SETTINGS,
    *_MOVING,
    *_VISITS,
    *_RELATIONS,
)
_HINTED = tuple(name for name in _KNOWN if len(name) > 3)
"""Properties that are guessed at: half of all words of three letters are near to another one."""

_ENDS = ("start", "goal")
_ROLES: Mapping[str, tuple[str, ...]] = {
    "vehicle": (*_ENDS, "via"),
    "height": ("origin",),
    **dict.fromkeys(SETTINGS, _ENDS),
    "speed": (*_ENDS, "via", "obstacle"),
    **dict.fromkeys(_MOVING, ("obstacle",)),
    "order": ("via",),
    "half_width": ("via",),
    "after": ("via", "goal"),
    "before": ("via", "goal"),
    "range": _ENDS,
}
"""Properties that are read of features of some roles only. Relations of others are refused."""

# What drawing programs add: colors, texts, times.
_STYLES = re.compile(
    r"(stroke|fill|marker|style|icon|line|poly|label|balloon|_|@).*|title|description|comment|"
    r"desc|id|fid|ogc_fid|color|opacity|visibility|tessellate|extrude|timestamp|begin|end|"
    r"altitudemode|draworder|created.*|updated.*|area|length|perimeter",
    re.IGNORECASE,
)


def stated(properties: Mapping[str, object]) -> Mapping[str, object]:
    """Return the properties that say something: tables give all features all columns.

    Parameters
    ----------
    properties : mapping
        Of a feature; null and blank where it has none.
    """
    return {
        key: value
        for key, value in properties.items()
        if value is not None and not (isinstance(value, str) and not value.strip())
    }


def unknown_properties(keys: Iterable[str]) -> list[str]:
    """Return the properties that are not read, but for those of drawing programs.

    Parameters
    ----------
    keys : iterable of str
        Of a feature.

    Returns
    -------
    list of str
        Each with the nearest that is read, if one is near.
    """
    notes = []
    for key in keys:
        if key not in _KNOWN and not _STYLES.fullmatch(key):
            near = difflib.get_close_matches(key[:100].lower(), _HINTED, n=1)
            notes.append(f"{key} (did you mean {near[0]}?)" if near else key)
    return notes


def misplaced_properties(keys: Iterable[str], role: str) -> list[str]:
    """Return the properties that are read, but not of what has this role.

    Parameters
    ----------
    keys : iterable of str
        Of a feature.
    role : str
        Of the same.

    Returns
    -------
    list of str
        Each with the role, as in a message.
    """
    article = "an" if role[0] in "aeiou" else "a"
    return [f"{key} of {article} {role}" for key in keys if role not in _ROLES.get(key, (role,))]
