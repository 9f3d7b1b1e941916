"""How the accuracy study judges: what counts as broken, too sure and needless; the terms of the estimate; its command line."""

import ast
import importlib
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

sys.path.insert(0, str(Path(__file__).parents[1] / "experiments"))

from accuracy_study import report, terms

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
        "truth": np.full(n, ""), "fan": np.zeros(n, bool), "many_planes": np.zeros(n, bool), "seconds": np.ones(n),
    }  # fmt: skip
    return xr.Dataset({k: ("case", v) for k, v in {**columns, **more}.items()}, {"case": np.arange(n)})


@pytest.mark.parametrize("row", VERDICTS, ids=lambda row: f"{row[0]}-{'-'.join(sorted(row[6])) or 'right'}")
def test_verdicts(row):
    v = report.verdicts(dataset([row]))
    assert {name for name, which in v.items() if which[0]} - {"judged"} == row[6]
    assert v["judged"][0] == (row[0] == "answered")


def test_tables_count_and_list_what_is_needless():
    ds = dataset(VERDICTS)
    head, _, first = report.class_table(ds).splitlines()[:3]
    cells = dict(zip((c.strip() for c in head.split("|")), (c.strip() for c in first.split("|")), strict=True))
    assert (cells["cases"], cells["refused"], cells["warned"], cells["judged"], cells["crashed"]) == (
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
    assert sorted(zeroed) == sorted(error.ErrorBudget._fields)


@pytest.mark.parametrize(
    "name",
    [
        "a spectrum that is cut off",
        "rounding of a profile's samples",
        "mixing of angles",
        "brightness outside the window",
    ],
)
def test_terms_are_needed(name):
    """Those that take a second or less; `--terms` shows the others."""
    term = next(t for t in terms.TERMS if t.name == name)
    found = terms.decided(term)
    assert found is not None
    assert found.needed, found


def test_the_command_runs_one_case_and_one_class():
    """What the user types; a case that is judged is listed only if something is to be said of it."""
    done = subprocess.run(
        [sys.executable, "experiments/accuracy.py", "--case", "0", "--class", "nearly rigid half-space", "--count", "1", "--workers", "1"],
        cwd=ROOT, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert "| air alone | 1 |" in done.stdout
    assert "| nearly rigid half-space | 1 |" in done.stdout


# --- the study's own walls ----------------------------------------------------------------------------------

STUDY = sorted((ROOT / "experiments" / "accuracy_study").glob("*.py"))
#: What the package does none of: these see its media and sources, never an answer.
TRUTH = ("source", "medium", "near_axis", "misplaced", "contour", "bands", "reference")
#: A file of the study imports only from those before it.
ORDER = ("slabs", "source", "cases", "hard", "numbering", "medium", "near_axis", "misplaced", "contour", "bands", "reference",
         "study", "report", "limit", "term_cases", "terms", "command")  # fmt: skip


def used(path):
    """Names that a file takes from beamprop, and the files of the study that it imports."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    names = {
        n.attr
        for n in ast.walk(tree)
        if isinstance(n, ast.Attribute) and isinstance(n.value, ast.Name) and n.value.id == "bp"
    }
    own = {n.module or "" for n in ast.walk(tree) if isinstance(n, ast.ImportFrom) and n.level}
    inner = [n for n in ast.walk(tree) if isinstance(n, ast.ImportFrom) and (n.module or "").startswith("beamprop")]
    return names, own, inner


@pytest.mark.parametrize("path", STUDY, ids=lambda path: path.stem)
def test_the_truth_uses_nothing_that_it_judges(path):
    """Only definitions of media and sources come from the package, through its public names; files are short, one way."""
    names, own, inner = used(path)
    assert not inner
    assert len(path.read_text(encoding="utf-8").splitlines()) <= 350
    if path.stem in TRUTH:
        assert names <= {"Slab", "Fluid", "GaussianBeam", "Profile", "Slits"}
    if path.stem != "__init__":
        assert own - {""} <= set(ORDER[: ORDER.index(path.stem)])
