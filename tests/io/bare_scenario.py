"""A scenario file with nothing but what is needed."""

BARE: dict[str, object] = {
    "format": "radmpc/scenario/1",
    "name": "bare",
    "dt": 0.5,
    "horizon": 4,
    "risk_bound": 0.1,
}


def bare(**fields: object) -> dict[str, object]:
    """One vehicle with the fewest fields, and more."""
    vehicle = {
        "name": "a",
        "start": [0, 0],
        "goal": {"center": [1, 1]},
        "radius": 1,
        "control_limit": 1,
    }
    return {**BARE, "vehicles": [{**vehicle, **fields}]}
