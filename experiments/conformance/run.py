"""The conformance page, `docs/conformance.md`: regenerate it, or check that it is what this checkout gives.

Without options the page's tables are written anew. `--check` writes nothing and ends with 1 where they have drifted. Either ends with 1
where a row is outside its tolerance, and then nothing is written. `--with-programs` runs the named programs, or all, in environments of
their own first: their answers are stored, or with `--check` held to those that are stored.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

import update_docs

from conformance import page
from conformance.programs import live
from conformance.programs.stacks import PROGRAMS
from conformance.records import Row, Section
from conformance.sections import SECTIONS

#: The name of the page's table.
TABLE = "conformance"


def arguments(words: list[str] | None) -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--check", action="store_true", help="write nothing, end with 1 where the page has drifted")
    parser.add_argument(
        "--with-programs", nargs="*", metavar="NAME", help=f"run {', '.join(PROGRAMS)}, or those that are named"
    )
    parser.add_argument("--environments", type=Path, help="folder that keeps the programs' environments")
    options = parser.parse_args(words)
    unknown = [name for name in options.with_programs or [] if name not in PROGRAMS]
    if unknown:
        parser.error(f"--with-programs: expected names among {', '.join(PROGRAMS)}, got {', '.join(unknown)}")
    return options


def run_programs(names: list[str], folder: Path | None, check: bool) -> list[str]:
    """Run programs; store their answers, or tell which differ from those stored."""
    with tempfile.TemporaryDirectory() as scratch:
        fresh = {name: live.run(PROGRAMS[name], folder or Path(scratch)) for name in names}
    if check:
        return [line for name, answers in fresh.items() for line in live.changed(name, answers)]
    live.store({name: (PROGRAMS[name].version, answers) for name, answers in fresh.items()})
    return []


def complaints(answers: list[tuple[Section, list[Row]]]) -> list[str]:
    """Rows that are not as they should be."""
    return [page.row_text(row) for _, rows in answers for row in rows if not row.holds]


def main(words: list[str] | None = None, pages: Path = update_docs.PAGES) -> int:
    """Ask, compare, write or check; the exit status."""
    options = arguments(words)
    wrong = []
    if options.with_programs is not None:
        wrong = run_programs(options.with_programs or list(PROGRAMS), options.environments, options.check)
    answers = [(section, section.rows()) for section in SECTIONS]
    wrong += complaints(answers)
    text = page.page_text(answers) + "\n"
    if options.check:
        wrong += page.drift(update_docs.place(TABLE, pages)[1][2], text)
    elif not wrong:
        update_docs.put(TABLE, text, pages)
    for line in wrong:
        print(line, file=sys.stderr)
    print(f"{sum(len(rows) for _, rows in answers)} rows, {len(wrong)} complaints")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
