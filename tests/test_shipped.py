"""What ships: no private path, documents whose tests exist, dependencies with one minimum."""

import re
import subprocess
import sys

import pytest
from source_tree import CHECKOUT

#: A path of somebody's machine, or one outside the checkout.
PRIVATE = re.compile(r"(?<![\w$.})/])/(home|Users|root|tmp|work|mnt)/[\w.]|(?<![\w/.])[s]hared/\w|C:\\\\Users")


def shipped():
    kinds = ("*.py", "*.md", "*.toml", "*.cfg", "*.yml", "*.sh")
    tops = [CHECKOUT / name for name in ("beamprop", "tests", "experiments", "docs")]
    inner = [path for top in tops for kind in kinds for path in sorted(top.rglob(kind))]
    return inner + [
        path
        for name in ("README.md", "CONTRIBUTING.md", "CITATION.cff", "pyproject.toml", ".ci/run")
        if (path := CHECKOUT / name).exists()
    ]


def test_no_file_names_a_private_path():
    """Nothing that ships points into the folders of the machine it was written on."""
    files = shipped()
    assert len(files) > 20
    private = [
        f"{path.relative_to(CHECKOUT)}: {match.group()}"
        for path in files
        if (match := PRIVATE.search(path.read_text(encoding="utf-8")))
    ]
    assert private == []


def test_the_tests_that_the_documentation_names_exist():
    """Each statement of docs/what-happens-when.md names a test that holds it."""
    known = {path.name: path.read_text(encoding="utf-8") for path in (CHECKOUT / "tests").glob("test_*.py")}
    text = (CHECKOUT / "docs" / "what-happens-when.md").read_text(encoding="utf-8")
    named = re.findall(r"`(?:(test_\w+\.py)(?:::)?)?(test_\w+)?`", text)
    assert len(named) > 25
    for file, test in named:
        assert not file or file in known, file
        assert not test or f"def {test}(" in (known[file] if file else "".join(known.values())), test


def test_each_dependency_states_one_minimum():
    """What the gate installs as minima is read from pyproject.toml: every dependency, pinned."""
    script = CHECKOUT / ".ci" / "minima.py"
    pins = subprocess.run([sys.executable, str(script), "test"], capture_output=True, text=True, check=True).stdout
    names = {
        re.split("==", line)[0] for line in pins.splitlines() if re.fullmatch(r"[\w-]+(\[\w+\])?==[\d.]+(; .*)?", line)
    }
    assert len(names) == len(pins.splitlines())
    assert {"numpy", "xarray", "h5netcdf", "h5py", "zarr", "netCDF4"} <= names


@pytest.mark.parametrize("folder", ["home", "Users", "root", "tmp", "work"])
def test_private_paths_are_recognised(folder):
    """The pattern finds what it is for, and leaves URLs, shell variables and other words alone."""
    for text in (f"/{folder}/ann/x", f"open('/{folder}/a.nc')", f"in /{folder}/a"):
        assert PRIVATE.search(text)
    for text in (f"https://example.org/{folder}/x", f"${folder}/x", f"docs/{folder}/y", f"/{folder}s/x"):
        assert not PRIVATE.search(text)
