"""Every figure of the paper: data, pictures, and a table of what the paper states against what this run computed."""

from __future__ import annotations

import sys

import fig2
import fig3
import fig4
import fig5
import fig5_fem
import fig6
from common import arguments, save_all, table
from tqdm import tqdm

FIGURES = {"fig2": fig2, "fig3": fig3, "fig4": fig4, "fig5": fig5, "fig5_fem": fig5_fem, "fig6": fig6}


def main() -> None:
    """Run all, write results/, print the table."""
    options = arguments(__doc__)
    rows = []
    for name, figure in tqdm(FIGURES.items(), desc="figures", file=sys.stderr):
        data = figure.compute(options.quick)
        save_all(name, options.output, data, figure.plot(data))
        rows += figure.statements(data)
    text = table(rows)
    (options.output / "statements.md").write_text(text + "\n")
    print(text)


if __name__ == "__main__":
    main()
