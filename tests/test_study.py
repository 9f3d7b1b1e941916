"""How the accuracy study counts: what counts as broken, too sure and needless; the terms of the estimate; its command line."""

import ast
import importlib
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from accuracy_study.study import report, terms

from beamprop.contour import error

ROOT = Path(__file__).parents[1]
NAN = np.nan
#: status, warned, dark planes, true error, what the truth knows, estimate; and what that is. rtol is 1e-6.
VERDICTS = [
    ("answered", False, 0, 1e-8, 1e-12, 1e-7, set()),
    ("answered", False, 0, 1e-5, 1e-12, 9e-6, {"broken"}),
    ("answered", False, 0, 5e-7, 1e-12, 1e-7, {"too sure"}),
    ("answered", True, 0, 1e-8, 1e-12, 1e-5, {"warned", "warned needlessly"}),
    ("answered", True, 0, 5e-7, 1e-12, 1e-5, {"warned"}),
    ("answered", True, 3, 1e-8, 1e-12, 1e-5, {"warned"}),
    ("answered", True, 0, 1e-8, 1e-6, 1e-5, {"warned"}),
    ("answered", True, 0, 1e-3, 1e-12, 1e-5, {"warned", "too sure"}),
    ("refused", False, 0, NAN, 1e-12, NAN, {"refused", "refused needlessly"}),
    ("refused", False, 0, NAN, NAN, NAN, {"refused"}),
    ("crashed", False, 0, NAN, NAN, NAN, {"crashed"}),
    ("no truth", False, 0, NAN, NAN, 1e-8, {"without truth"}),
]


def dataset(rows):
    keys = ("status", "warned", "dark", "error", "truth_error", "estimate")
    columns = dict(zip(keys, map(np.array, zip(*(r[:6] for r in rows), strict=True)), strict=True))
    n = len(rows)
    more = {
        "rtol": np.full(n, 1e-6), "kind": np.full(n, "air alone"), "source": np.full(n, "Slits"), "reason": np.full(n, "why"),
        "truth": np.full(n, ""), "many_angles": np.zeros(n, bool), "many_planes": np.zeros(n, bool), "seconds": np.ones(n),
    }  # fmt: skip
    return xr.Dataset({k: ("case", v) for k, v in {**columns, **more}.items()}, {"case": np.arange(n)})


@pytest.mark.parametrize("row", VERDICTS, ids=lambda row: f"{row[0]}-{'-'.join(sorted(row[6])) or 'right'}")
def test_verdicts(row):
    v = report.verdicts(dataset([row]))
    assert {name for name, which in v.items() if which[0]} - {"compared"} == row[6]
    assert v["compared"][0] == (row[0] == "answered")


def test_tables_count_and_list_what_is_needless():
    ds = dataset(VERDICTS)
    head, _, first = report.class_table(ds).splitlines()[:3]
    cells = dict(zip((c.strip() for c in head.split("|")), (c.strip() for c in first.split("|")), strict=True))
    assert (cells["cases"], cells["refused"], cells["warned"], cells["compared"], cells["crashed"]) == (
        "12",
        "2",
        "5",
        "8",
        "1",
    )
    assert first.split("|")[4].strip() == "1"  # refused needlessly
    assert first.split("|")[6].strip() == "1"  # warned needlessly
    assert report.faults(ds).count("\n") + 1 == sum(bool(row[6] - {"warned"}) for row in VERDICTS)
    stated = {row.stated: row.holds for row in report.statements(ds, np.array([[1.0], [0.1], [0.01], [1e-3], [1e-4]]))}
    assert not stated["refusals and warnings that are needless: fewer than 1 %"]
    assert not stated["no estimate below a third of the error"]
    assert stated["vanishing loss tends to the lossless field, linearly"]


@pytest.mark.parametrize("term", terms.TERMS, ids=lambda term: term.name)
def test_terms_are_where_the_table_says(term):
    """A term that has moved or gone is to be changed in the table too."""
    module = importlib.import_module(f"beamprop.{term.module}")
    kept = getattr(module, term.attribute)
    with terms.switched_off(term):
        assert getattr(module, term.attribute) is not kept
    assert getattr(module, term.attribute) is kept


def test_every_term_of_the_budget_is_in_the_table():
    """Each is set to zero by one row of the table: what is left of a budget of ones is 0 there."""
    ones = error.Estimate(error.uniform_budget(3, 1.0), 0.0)
    zeroed = [
        name
        for term in terms.TERMS
        if term.attribute == "terms_by_plane"
        for name, values in term.without(lambda: ones)().budget._asdict().items()
        if not values.any()
    ]
    other = {"_beyond": "band_end", "_fill_low_rank": "low_rank"}
    zeroed += [other[term.attribute] for term in terms.TERMS if term.attribute in other]
    zeroed.append("cancelling")  # of sums in three dimensions alone: tests/test_space_sums.py
    assert sorted(zeroed) == sorted(error.ErrorBudget._fields)


@pytest.mark.parametrize(
    "name",
    [
        "a spectrum that is cut off",
        "rounding of a profile's samples",
        "interpolation over angles",
        "peaks outside the window",
    ],
)
def test_terms_are_needed(name):
    """Those that take a second or less; `--terms` shows the others."""
    term = next(t for t in terms.TERMS if t.name == name)
    found = terms.decided(term)
    assert found is not None
    assert found.needed, found


def test_the_command_runs_one_case_and_one_class():
    """What the user types; a case that is compared is listed only if something is to be said of it."""
    done = subprocess.run(
        [sys.executable, "experiments/accuracy.py", "--case", "0", "--class", "nearly rigid half-space", "--count", "1", "--workers", "1"],
        cwd=ROOT, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert "| air alone | 1 |" in done.stdout
    assert "| nearly rigid half-space | 1 |" in done.stdout


# --- the study's own walls ----------------------------------------------------------------------------------

STUDY = ROOT / "experiments" / "accuracy_study"
FILES = {path: ".".join(path.relative_to(STUDY).with_suffix("").parts) for path in sorted(STUDY.rglob("*.py"))}
#: A file of the study imports only from those before it.
ORDER = [
    "case",
    *(f"reference.{name}" for name in ("source", "medium", "solid_medium", "solid", "many_digits", "near_axis", "misplaced", "contour", "bands", "quadrature", "plain", "real_axis", "radial", "in_space")),
    *(f"cases.{name}" for name in ("slabs", "first", "hard", "solid", "numbering", "built", "in_space")),
    *(f"study.{name}" for name in ("comparison", "report", "limit", "terms", "in_space", "command")),
]  # fmt: skip


def taken_from_the_package(path):
    """Names that a file takes from beamprop, and the modules inside beamprop that it imports from."""
    nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
    names = {
        n.attr for n in nodes if isinstance(n, ast.Attribute) and isinstance(n.value, ast.Name) and n.value.id == "bp"
    }
    modules = [n.module for n in nodes if isinstance(n, ast.ImportFrom) and (n.module or "").startswith("beamprop")]
    return names, modules


def taken_from_the_study(path):
    """Files of the study that a file imports, by their names in ORDER."""
    room = FILES[path].split(".")[:-1]
    imported = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = room[: len(room) + 1 - node.level] + (node.module or "").split(".")
            whole = ".".join(part for part in base if part)
            imported |= {whole} if whole in ORDER else {f"{whole}.{alias.name}" for alias in node.names}
    return imported


@pytest.mark.parametrize("path", FILES, ids=FILES.get)
def test_the_reference_uses_nothing_that_it_checks(path):
    """It sees definitions of media and sources alone, through the package's public names."""
    names, modules = taken_from_the_package(path)
    assert not modules
    if FILES[path] == "case" or FILES[path].startswith("reference."):
        assert names <= {"AIR", "Array", "Bowl", "Fluid", "GaussianBeam", "Profile", "Slab", "Slits", "Solid"}


@pytest.mark.parametrize("path", FILES, ids=FILES.get)
def test_imports_of_the_study_run_one_way(path):
    """From questions and references to their comparison; and files are short."""
    assert len(path.read_text(encoding="utf-8").splitlines()) <= 350
    if path.stem == "__init__":
        assert not taken_from_the_study(path)
    else:
        assert taken_from_the_study(path) <= set(ORDER[: ORDER.index(FILES[path])])


def test_imports_of_the_study_are_seen():
    """Those of both kinds, within a folder and across."""
    of = {name: path for path, name in FILES.items()}
    assert {"reference.source", "case", "cases.slabs"} <= taken_from_the_study(of["cases.hard"])
    assert {"study.report", "cases.numbering"} <= taken_from_the_study(of["study.command"])
