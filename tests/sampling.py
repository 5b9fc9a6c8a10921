"""Which cases of a long list every check runs, and which are left to `make nightly`."""

from __future__ import annotations

import os
import random
from collections.abc import Sequence

IS_THOROUGH = bool(os.environ.get("RADMPC_THOROUGH"))
"""Whether all cases are run, as `make nightly` does."""

SEED = int(os.environ.get("RADMPC_SAMPLE", "0"))
"""Of the samples; another one draws other cases."""


def drawn(cases: Sequence[str], count: int, seed: int) -> set[str]:
    """Return as many of the cases as asked for, the same ones for whoever asks with this seed."""
    rng = random.Random(f"{seed} {len(cases)} {cases[0]}")
    return set(rng.sample(list(cases), min(count, len(cases))))


def examples(count: int) -> int:
    """Return how many examples of a law hypothesis draws: every check a third, at least five."""
    return count if IS_THOROUGH else max(5, count // 3)
