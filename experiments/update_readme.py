"""Write a table that an experiment printed into a README, between its marks: ``update_readme.py NAME TABLE.md [README.md]``."""

from __future__ import annotations

import re
import sys
from pathlib import Path

README = Path(__file__).parents[1] / "README.md"


def main(name: str, table: Path, readme: Path = README) -> None:
    """Replace what stands between ``<!-- table:NAME -->`` and ``<!-- end -->``."""
    pattern = re.compile(rf"(<!-- table:{name} -->\n).*?(<!-- end -->)", re.DOTALL)
    text, count = pattern.subn(lambda m: m[1] + table.read_text() + m[2], readme.read_text())
    if count != 1:
        sys.exit(f"expected one table named {name} in {readme}, found {count}")
    readme.write_text(text)


if __name__ == "__main__":
    main(sys.argv[1], *map(Path, sys.argv[2:4]))
