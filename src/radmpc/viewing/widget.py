"""The widget that shows values in notebooks."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import anywidget
import traitlets

from radmpc.viewing.content import ViewContent

__all__ = ["ValueView"]


class ValueView(anywidget.AnyWidget):
    """Map or view in space, timeline and ledger of a value.

    Attributes
    ----------
    content : dict
        What is shown, as plain data.
    time : float
        Where the timeline stands [steps]; to be read and set.
    """

    _esm = traitlets.Unicode().tag(sync=True)
    _style = traitlets.Unicode().tag(sync=True)
    content = traitlets.Dict().tag(sync=True)
    time = traitlets.Float(0.0).tag(sync=True)

    def __init__(self, content: ViewContent, bundle: Path) -> None:
        code, style = (
            (bundle / f"widget.{kind}").read_text(encoding="utf-8") for kind in ("js", "css")
        )
        super().__init__(content=dict(content), _esm=code, _style=style)
        self._bundle = bundle
        self.on_msg(self._answer)

    def _answer(self, _widget: object, asked: Any, _buffers: object) -> None:
        """Send the code for scenes of three dimensions: most values need none of it."""
        if asked == {"ask": "space"}:
            self.send({"answer": "space"}, [(self._bundle / "space.js").read_bytes()])
