"""Write a table that an experiment printed into the page that shows it, between its marks: ``update_docs.py NAME TABLE.md``."""

from __future__ import annotations

import re
import sys
from pathlib import Path

PAGES = Path(__file__).parents[1] / "docs"


def place(name: str, pages: Path = PAGES) -> tuple[Path, re.Match[str]]:
    """The one page that has the marks of a table, and the match: what stands between them is its second group."""
    pattern = re.compile(rf"(<!-- table:{re.escape(name)} -->\n)(.*?)(<!-- end -->)", re.DOTALL)
    found = [
        (page, m) for page in sorted(pages.glob("*.md")) for m in pattern.finditer(page.read_text(encoding="utf-8"))
    ]
    if len(found) != 1:
        sys.exit(f"expected one table named {name} in {pages}, found {len(found)}")
    return found[0]


def put(name: str, rows: str, pages: Path = PAGES) -> None:
    """Replace what stands between ``<!-- table:NAME -->`` and ``<!-- end -->`` in the one page that has these marks."""
    page, match = place(name, pages)
    text = match.string[: match.start(2)] + rows.rstrip("\n") + "\n" + match.string[match.end(2) :]
    page.write_text(text, encoding="utf-8")


def main(name: str, table: Path, pages: Path = PAGES) -> None:
    """Put a table from a file into its place."""
    put(name, table.read_text(encoding="utf-8"), pages)


if __name__ == "__main__":
    main(sys.argv[1], *map(Path, sys.argv[2:4]))
