"""Documents as text: the comments that a file held when it was read, the values of now."""

from __future__ import annotations

from io import StringIO
from typing import Any

from radmpc.errors import FileFormatError
from radmpc.io.text.json_text import write_json
from radmpc.io.text.yaml_text import read_yaml
from radmpc.io.text.yaml_writing import write_yaml
from radmpc.records import dataclass
from radmpc.serving.protocol import Content

__all__ = ["Original", "text_of"]

_WIDE = 1_000_000
"""Letters after which lines are broken: never, what was one line stays one."""


@dataclass(frozen=True, slots=True)
class Original:
    """The text that a document was read from.

    Attributes
    ----------
    text : str
        YAML, with its comments.
    """

    text: str


def text_of(content: Content, suffix: str, origin: Original | None) -> str:
    """Return a document as the text of a file.

    Parameters
    ----------
    content : mapping
        The document.
    suffix : str
        ``.json``, ``.yaml`` or ``.yml``.
    origin : Original or None
        What it was read from: comments, order and spelling of what has not changed are kept.

    Returns
    -------
    str
        It reads back equal.
    """
    if suffix == ".json":
        return write_json(content)
    if origin is not None:
        text = _merged(origin.text, content)
        if text is not None:
            return text
    return write_yaml(content)


def _merged(text: str, content: Content) -> str | None:
    """Return a text with the values of a document; None where that does not read back equal."""
    from ruamel.yaml import YAML  # noqa: PLC0415 - to save is rare
    from ruamel.yaml.error import YAMLError  # noqa: PLC0415 - to save is rare
    from ruamel.yaml.util import load_yaml_guess_indent  # noqa: PLC0415 - to save is rare

    yaml = YAML(typ="rt")
    yaml.preserve_quotes = True
    yaml.width = _WIDE
    # Comments would keep the ends of their lines, all else would get others.
    ends = "\r\n" if "\r\n" in text else "\n"
    text = text.replace("\r\n", "\n")
    try:
        _, mapping, offset = load_yaml_guess_indent(text)
        if mapping is not None:
            offset = offset or 0
            yaml.indent(mapping=2, sequence=offset + 2, offset=offset)
        tree = yaml.load(text)
        _sync_mapping(tree, dict(content), set())
        out = StringIO()
        yaml.dump(tree, out)
        merged = out.getvalue().replace("\n", ends)
        value, _ = read_yaml(merged, "document")
    except (YAMLError, FileFormatError, AttributeError, TypeError, ValueError):
        return None
    return merged if value == content else None


def _sync_mapping(tree: Any, content: dict[str, Any], seen: set[int]) -> None:
    """Make a mapping of the tree say what the document does."""
    seen.add(id(tree))
    for key in [key for key in tree if key not in content]:
        del tree[key]
    for key, value in content.items():
        if key in tree:
            tree[key] = _synced(tree[key], value, seen)
        else:
            tree[key] = _fresh(value)


def _sync_list(tree: Any, content: list[Any], seen: set[int]) -> None:
    """Make a list of the tree say what the document does; named entries keep their comments."""
    seen.add(id(tree))
    names = [item.get("name") if isinstance(item, dict) else None for item in content]
    if all(isinstance(name, str) for name in names):
        # What was taken away takes its comments along, not those of the last one.
        for place in reversed(range(len(tree))):
            item = tree[place]
            if isinstance(item, dict) and item.get("name") not in names and len(tree) > len(names):
                del tree[place]
    while len(tree) > len(content):
        del tree[len(tree) - 1]
    for place, value in enumerate(content):
        if place < len(tree):
            tree[place] = _synced(tree[place], value, seen)
        else:
            tree.append(_fresh(value))


def _synced(node: Any, value: Any, seen: set[int]) -> Any:
    """Return the node that says what a value does: the same one wherever that can be."""
    if isinstance(value, dict) and isinstance(node, dict):
        if id(node) in seen:  # an alias: the other place says something else, perhaps
            return node if node == value else _fresh(value)
        _sync_mapping(node, value, seen)
        return node
    if isinstance(value, list) and isinstance(node, list):
        if id(node) in seen:
            return node if node == value else _fresh(value)
        _sync_list(node, value, seen)
        return node
    is_same = type(value) is type(node) or not isinstance(value, bool)
    return node if is_same and not isinstance(node, bool) and node == value else value


def _fresh(value: Any) -> Any:
    """Return a value as a part of the tree: short ones on one line."""
    from ruamel.yaml.comments import CommentedMap, CommentedSeq  # noqa: PLC0415 - to save is rare

    if isinstance(value, dict):
        made = CommentedMap((key, _fresh(entry)) for key, entry in value.items())
        made.fa.set_flow_style()
        return made
    if isinstance(value, list):
        items = CommentedSeq(_fresh(item) for item in value)
        items.fa.set_flow_style()
        return items
    return value
