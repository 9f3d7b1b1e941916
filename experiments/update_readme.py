"""Write a table that an experiment printed into the README, between its marks: ``update_readme.py NAME TABLE.md``."""

from __future__ import annotations

import re
import sys
from pathlib import Path

README = Path(__file__).parents[1] / "README.md"


def main(name: str, table: Path) -> None:
    """Replace what stands between ``<!-- table:NAME -->`` and ``<!-- end -->``."""
    pattern = re.compile(rf"(<!-- table:{name} -->\n).*?(<!-- end -->)", re.DOTALL)
    text, count = pattern.subn(lambda m: m[1] + table.read_text() + m[2], README.read_text())
    if count != 1:
        sys.exit(f"expected one table named {name} in the README, found {count}")
    README.write_text(text)


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]))
