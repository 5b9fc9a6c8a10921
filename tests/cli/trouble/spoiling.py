"""Files spoiled at random: bytes, lines, numbers and values, whatever their format."""

from __future__ import annotations

import copy
import json
import random
import re
from collections.abc import Callable
from functools import cache
from typing import Any

from ruamel.yaml import YAML

__all__ = ["spoiled"]

NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")

NUMBERS = [
    b"nan", b"NaN", b".nan", b"inf", b"-Infinity", b".inf", b"1e308", b"-1e308", b"1e999", b"-0",
    b"-0.0", b"0", b"1", b"-1", b"1e-320", b"1e-300", b"1e-9", b"1e9", b"1000000000", b"1e6",
    b"999999999", b"2147483648", b"9223372036854775808", b"1" + b"0" * 400, b"9" * 5000, b"1_0",
    b"0x10", b"0o17", b"1.5", b"0.1", b"180", b"90", b"true", b"null", b"''", b"[]", b"[1]", b"{}",
    b"\xd9\xa3", b"1e5", b"3e4", b"1.", b".5", b"+1", b"1e+400", b"-1e-400", b"0.4999999", b"1e-16",
]  # fmt: skip

BITS = [
    b"", b"\0", b"\t", b"\n", b"\r", b"  ", b"-", b"- ", b": ", b"[", b"]", b"{", b"}", b'"', b"'",
    b"#", b"&here ", b"*here", b"!!str ", b"!!python/object/apply:os.system ", b"|", b">", b"?",
    b"%YAML 1.1\n---\n", b"---\n", b"...\n", b"<<: *here\n", b"\xff", b"\xc3", b"\xed\xa0\xbd",
    b"\xe2\x80\xa8", b"\xc2\x85", b"\\ud800", b"\\", b"@", b"`", b",", b"[" * 300, b"\xef\xbb\xbf",
    b"<", b">", b"</", b"<!--", b"<![CDATA[", b"&lt;", b"&#0;", b"&e;", b"<!DOCTYPE kml>",
    b"\x1b[2J",
    b"version 1\n", b"map\n", b"x" * 20_000, b"1 " * 500,
]  # fmt: skip

VALUES = [
    None, True, False, "", "x", "nan", 0, -1, 1, 2.5, -0.0, 1e9, -1e9, 1e308, 1e-320, 1e-300, 1e-9,
    float("nan"), float("inf"), -float("inf"), 10**400, -(10**30), 10**9,
    2**63, 2**31, [], {}, [[]],
    [[], []], [None], ["x"], [1, 2, 3], [0, 0], [1, 2, 3, 4], [[1, 2], [3]], {"": 1}, {"name": 1},
    "\ud800", "\0", "\x1b[2J", "a\nb", "../..", "/", "x" * 100_000, [0] * 5000, [[0, 0]] * 3,
    [[0, 0], [1, 0], [0, 1]], [[1e9, 1e9], [-1e9, 1e9], [1e-9, 0]], [[1e-300, 0]] * 4, 360, 1000,
    "intervals", "steps", 0.499, 1e-12, 1e5,
]  # fmt: skip


def spoiled(content: bytes, suffix: str, rng: random.Random) -> bytes:
    """Return a file's content with one to three things wrong in it."""
    ways: list[Callable[[bytes, random.Random], bytes]] = [_bytes, _bytes, _number, _number, _lines]
    if suffix in {".yaml", ".json", ".geojson"} and rng.random() < 0.65:
        return _values(content, suffix, rng)
    for _ in range(rng.choice([1, 1, 1, 2, 3])):
        content = rng.choice(ways)(content, rng)
    return content


def _bytes(content: bytes, rng: random.Random) -> bytes:
    """Flip, insert, delete, repeat or cut off."""
    at = rng.randrange(len(content) + 1)
    end = min(len(content), at + rng.choice([0, 1, 1, 5, 40]))
    action = rng.random()
    if action < 0.1:
        return content[:at]
    if action < 0.3 and at < len(content):
        return content[:at] + bytes([content[at] ^ 1 << rng.randrange(8)]) + content[at + 1 :]
    if action < 0.4:
        other = rng.randrange(len(content) + 1)
        return content[:other] + content[at:end] * rng.choice([1, 2, 200]) + content[other:]
    return content[:at] + rng.choice(BITS) + content[end:]


def _number(content: bytes, rng: random.Random) -> bytes:
    """Put a hostile number in place of one, sometimes of all that are equal to it."""
    found = list(NUMBER.finditer(content))
    if not found:
        return content
    match = rng.choice(found)
    new = rng.choice(NUMBERS)
    if rng.random() < 0.2:
        return content.replace(match[0], new)
    return content[: match.start()] + new + content[match.end() :]


def _lines(content: bytes, rng: random.Random) -> bytes:
    """Drop, repeat or swap lines."""
    lines = content.split(b"\n")
    at, other = rng.randrange(len(lines)), rng.randrange(len(lines))
    action = rng.random()
    if action < 0.4:
        del lines[at]
    elif action < 0.7:
        lines[other:other] = [lines[at]] * rng.choice([1, 1, 2, 100])
    else:
        lines[at], lines[other] = lines[other], lines[at]
    return b"\n".join(lines)


def _values(content: bytes, suffix: str, rng: random.Random) -> bytes:
    """Change values of a tree and write it again."""
    text = content.decode("utf-8")
    tree = copy.deepcopy(_yaml(text)) if suffix == ".yaml" else json.loads(text)
    for _ in range(rng.choice([1, 1, 2, 3])):
        _spoil(tree, tree, rng)
    written = json.dumps(tree)
    if suffix == ".yaml":
        # YAML's names for what JSON calls NaN and Infinity.
        written = re.sub(r"\b(NaN|Infinity)\b", lambda m: f".{m[0][:3].lower()}", written)
    return written.encode("utf-8")


@cache
def _yaml(text: str) -> Any:
    """Return the content of YAML text."""
    return YAML(typ="safe", pure=True).load(text)


def _spoil(tree: Any, data: Any, rng: random.Random) -> None:
    """Go down at random and replace, remove, rename, repeat or swap what is there."""
    while isinstance(data, dict | list) and data:
        key = rng.choice(list(data)) if isinstance(data, dict) else rng.randrange(len(data))
        if isinstance(data[key], dict | list) and data[key] and rng.random() < 0.85:
            data = data[key]
            continue
        _change(tree, data, key, rng)
        return


def _change(tree: Any, data: Any, key: Any, rng: random.Random) -> None:
    """Change one entry of a mapping or list."""
    action = rng.random()
    if action < 0.12:
        del data[key]
    elif action < 0.2 and isinstance(data, list):
        data.extend(copy.deepcopy(data[key]) for _ in range(rng.choice([1, 1, 5, 500])))
    elif action < 0.25 and isinstance(data, dict):
        data[f"{key}{rng.choice(['x', ' ', 's'])}"] = data.pop(key)
    elif action < 0.35:
        data[key] = copy.deepcopy(_somewhere(tree, rng))
    elif action < 0.5 and isinstance(data[key], int | float) and abs(data[key]) < 1e12:
        factor = rng.choice([-1, 0, 1e-12, 1e-6, 1e-3, 0.5, 2, 1e3, 1e6, 1e9])
        data[key] = type(data[key])(data[key] * factor)
    else:
        data[key] = copy.deepcopy(rng.choice(VALUES))


def _somewhere(tree: Any, rng: random.Random) -> Any:
    """Return a random part of a tree."""
    while isinstance(tree, dict | list) and tree and rng.random() < 0.7:
        tree = rng.choice(list(tree.values() if isinstance(tree, dict) else tree))
    return tree
