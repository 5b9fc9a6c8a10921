"""Python of the pages as files, one per page, for `make types`."""

from __future__ import annotations

import sys
from pathlib import Path

from pages import fences, name_of, pages_with


def write_programs(folder: Path) -> list[Path]:
    """Write every page's blocks that are run, each on the line where it stands there."""
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("*.py"):
        old.unlink()  # of a page that is no more
    written = []
    for page in pages_with("python"):
        lines: list[str] = []
        for fence in fences(page, "python"):
            if fence.reason is None:
                # Empty lines before it make an error name the line of the page.
                lines += [""] * (fence.line - 1 - len(lines)) + fence.text.splitlines()
        path = folder / f"{name_of(page).removesuffix('.md').replace('/', '_')}.py"
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
        written.append(path)
    return written


if __name__ == "__main__":
    write_programs(Path(sys.argv[1]))
