"""Print the stated minima of the dependencies, and of extras named as arguments, as exact pins: one source, pyproject.toml."""

import sys
import tomllib
from pathlib import Path

project = tomllib.loads((Path(__file__).parent.parent / "pyproject.toml").read_text(encoding="utf-8"))["project"]
wanted = [*project["dependencies"], *(r for extra in sys.argv[1:] for r in project["optional-dependencies"][extra])]
for requirement in wanted:
    if requirement.count(">=") != 1 or "," in requirement:
        sys.exit(f"expected one minimum, as in 'name>=1.2', got {requirement!r}")
    print(requirement.replace(">=", "=="))
