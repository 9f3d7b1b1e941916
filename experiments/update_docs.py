"""Write a table that an experiment printed into the page that shows it, between its marks: ``update_docs.py NAME TABLE.md``."""

from __future__ import annotations

import re
import sys
from pathlib import Path

PAGES = Path(__file__).parents[1] / "docs"


def main(name: str, table: Path, pages: Path = PAGES) -> None:
    """Replace what stands between ``<!-- table:NAME -->`` and ``<!-- end -->`` in the one page that has these marks."""
    pattern = re.compile(rf"(<!-- table:{re.escape(name)} -->\n).*?(<!-- end -->)", re.DOTALL)
    texts = {page: page.read_text(encoding="utf-8") for page in sorted(pages.glob("*.md"))}
    holders = [page for page, text in texts.items() for _ in pattern.findall(text)]
    if len(holders) != 1:
        sys.exit(f"expected one table named {name} in {pages}, found {len(holders)}")
    rows = table.read_text(encoding="utf-8").rstrip("\n") + "\n"
    holders[0].write_text(pattern.sub(lambda m: m[1] + rows + m[2], texts[holders[0]]), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1], *map(Path, sys.argv[2:4]))
