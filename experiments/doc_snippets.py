"""The Python blocks of the documentation: run them, and write what they print and draw: ``doc_snippets.py [PAGE.md ...]``.

A page's blocks share their names from top to bottom; below the mark ``<!-- sections alone -->`` each section has those of
the blocks above the mark and its own. A ``text`` block right behind a Python block is what that prints. A picture
``images/NAME.png`` that a page shows is the file ``NAME.png`` that its blocks write. `tests/test_docs.py` holds all of it.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

DOCS = Path(__file__).parents[1] / "docs"
ALONE = "<!-- sections alone -->"
#: A mark before a block that ends the process it runs in: HDF5's end on a full disk.
OWN_PROCESS = "<!-- own process -->"
_BLOCK = re.compile(
    r"^(?P<before>[^\n]*)\n```(?P<kind>[^\n`]*)\n(?P<text>.*?)^```\n(?:\n```text\n(?P<printed>.*?)^```\n)?",
    re.MULTILINE | re.DOTALL,
)
_HEADING = re.compile(r"^##+ .*$", re.MULTILINE)


class Block(NamedTuple):
    """A fenced block: the line before it, its kind and text, what it says that it prints, and where on the page that stands."""

    before: str
    kind: str
    text: str
    printed: str | None
    span: tuple[int, int]
    section: int


def blocks(text: str, kind: str) -> list[Block]:
    """Every block of a kind on a page, from top to bottom."""
    mark = text.find(ALONE)
    starts = [m.start() for m in _HEADING.finditer(text)] if mark >= 0 else []
    return [
        Block(
            *m.group("before", "kind", "text", "printed"), m.span("printed"), sum(mark < s < m.start() for s in starts)
        )
        for m in _BLOCK.finditer(text)
        if m["kind"] == kind
    ]


def run(text: str, name: str) -> Iterator[tuple[Block, str]]:
    """Each Python block of a page in turn, and what it printed, in the current folder."""
    names: dict[int, dict] = {0: {}}
    for block in blocks(text, "python"):
        if block.before == OWN_PROCESS:
            done = subprocess.run(
                [sys.executable, "-c", block.text], capture_output=True, text=True, timeout=60, check=False
            )
            yield block, done.stdout + done.stderr
            continue
        here = names.setdefault(block.section, dict(names[0]))
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            exec(compile(block.text, f"{name}: {block.text.splitlines()[0]}", "exec"), here)
        yield block, out.getvalue()


def images(text: str) -> list[str]:
    """Names of the pictures that a page shows and its blocks write."""
    return re.findall(r"\]\(images/([\w-]+\.png)\)", text)


def update(page: Path) -> None:
    """Write what the blocks of a page print into it, and the pictures that it shows into ``images/`` beside it."""
    import matplotlib.pyplot as plt

    text, here = page.read_text(encoding="utf-8"), Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            ran = list(run(text, page.name))
        finally:
            os.chdir(here)
            plt.close("all")
        for name in images(text):
            (page.parent / "images").mkdir(exist_ok=True)
            shutil.copy(Path(folder) / name, page.parent / "images" / name)
    for block, printed in reversed(ran):
        if block.printed is not None:
            start, end = block.span
            text = text[:start] + printed + text[end:]
    page.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    os.environ["MPLBACKEND"] = "agg"
    for page in map(Path, sys.argv[1:] or sorted(DOCS.glob("*.md"))):
        update(page.resolve())
