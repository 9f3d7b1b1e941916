"""The conformance page: every section's rows hold, the page is what the checkout gives, and what is wrong does not pass."""

import ast
import json
import math
import shutil
import sys
from dataclasses import replace
from pathlib import Path

import pytest
import update_docs
from conformance import page, run
from conformance.programs import live
from conformance.programs.stacks import PROGRAMS, Program
from conformance.records import Row, Section, Tolerance, rounding
from conformance.sections import SECTIONS

FOLDER = Path(run.__file__).parent


@pytest.fixture(scope="module")
def rows_of():
    """The rows of every section by its title."""
    return {section.title: section.rows() for section in SECTIONS}


@pytest.fixture
def answered(rows_of, monkeypatch):
    """The command with rows that are computed once; what is put under a title takes their place."""
    table = dict(rows_of)
    monkeypatch.setattr(run, "SECTIONS", [Section(s.title, s.text, lambda t=s.title: table[t]) for s in SECTIONS])
    return table


@pytest.fixture
def pages(tmp_path):
    """A copy of the page."""
    shutil.copy(update_docs.PAGES / "conformance.md", tmp_path)
    return tmp_path


# --- rows -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("title", [section.title for section in SECTIONS])
def test_rows_hold(title, rows_of):
    """Each is within its tolerance, or shown to be refuted; each has a source, a finite reference and a name of its own."""
    rows = rows_of[title]
    assert [page.row_text(row) for row in rows if not row.holds] == []
    assert all(row.source and row.tolerance.reason and row.tolerance.value > 0 for row in rows)
    assert all(math.isfinite(abs(row.reference)) for row in rows)
    names = [(row.quantity, row.source) for row in rows]
    assert len(set(names)) == len(names)


@pytest.mark.parametrize("title", [section.title for section in SECTIONS])
def test_a_wrong_value_is_outside_its_tolerance(title, rows_of):
    """Three times as far away as the tolerance is wide, every value fails."""
    for row in rows_of[title]:
        if not row.refuted:
            scale = row.scale or abs(row.reference)
            wrong = replace(row, ours=row.reference + 3 * row.tolerance.value * scale)
            assert wrong.share == pytest.approx(3, rel=0.1)
            assert not wrong.holds


def test_at_least_two_hundred_rows(rows_of):
    assert sum(map(len, rows_of.values())) >= 200
    assert {section.title for section in SECTIONS} >= {"Faces", "Beams", "Media", "The paper", "Other programs"}


@pytest.mark.parametrize("value", [math.nan, math.inf, complex(0, math.nan)])
def test_what_is_no_number_does_not_hold(value):
    row = Row("p", "source", value, 1.0, rounding())
    assert row.share == math.inf
    assert not row.holds
    assert page.row_text(row).endswith("| inf % |")


def test_a_reference_of_zero_needs_a_scale():
    with pytest.raises(ZeroDivisionError):
        _ = Row("p", "source", 1.0, 0.0, rounding()).share


def test_references_do_not_use_the_package():
    """Formulas, printed numbers, and what other programs are asked and answer."""
    files = [*(FOLDER / "formulas").glob("*.py"), *(FOLDER / "programs").rglob("*.py"), FOLDER / "published.py"]
    assert len(files) > 15
    for path in files:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            assert not any("beamprop" in name or "sections" in name for name in names), path


# --- the page ---------------------------------------------------------------------------------------------


def test_the_page_is_what_the_checkout_gives(answered, capsys):
    assert run.main(["--check"]) == 0, capsys.readouterr().err


def test_a_wrong_reference_fails_and_writes_nothing(answered, pages, capsys):
    """With and without --check, by its name."""
    first, *others = answered["Faces"]
    answered["Faces"] = [replace(first, reference=first.reference * 1.001), *others]
    before = (pages / "conformance.md").read_text(encoding="utf-8")
    for words in ([], ["--check"]):
        assert run.main(words, pages) == 1
        assert first.quantity in capsys.readouterr().err
    assert (pages / "conformance.md").read_text(encoding="utf-8") == before


def test_a_refuted_statement_that_holds_after_all_fails(answered, pages):
    answered["The paper"] = [replace(row, ours=row.reference) if row.refuted else row for row in answered["The paper"]]
    assert run.main([], pages) == 1


@pytest.mark.parametrize(
    ("old", "new", "status"),
    [
        ("| 0.938712 |", "| 0.938722 |", 1),  # a number
        ("| 0.938712 |", "| 0.938713 |", 0),  # its last digit
        ("| < 1e-14 |", "| < 1e-12 |", 0),  # rounding of another machine
        ("| < 1e-14 |", "| 1.0e-07 |", 1),  # no rounding
        ("section 270", "section 271", 1),
        ("| Faces | 28 |", "| Faces | 27 |", 1),
        ("### Media", "### Mediums", 1),
        ("| does not hold |", "| 12 % |", 1),
    ],
)
def test_drift(old, new, status, answered, pages):
    """A page that says something else fails, one that rounds otherwise does not; writing it anew makes it what it was."""
    file = pages / "conformance.md"
    before = file.read_text(encoding="utf-8")
    assert old in before
    file.write_text(before.replace(old, new, 1), encoding="utf-8")
    assert run.main(["--check"], pages) == status
    assert run.main([], pages) == 0
    assert run.main(["--check"], pages) == 0


def test_a_missing_row_is_drift():
    rows = "| a | b | 1 | 1 | 0 | 1 | 1 |\n"
    assert page.drift(rows, rows + rows) == ["- ", "+ " + rows.strip()]
    assert page.drift(rows, rows) == []


@pytest.mark.parametrize(
    ("value", "size", "text"),
    [
        (1 - 1e-14, 1.0, "1.00000"),
        (complex(0.3, 1e-12), 1.0, "0.300000"),
        (complex(-2e-9, 0.25), 1.0, "0.250000i"),
        (1e-17, 1.0, "0"),
        (complex(1, 1) * (1 - 1e-14), abs(1 + 1j), "1.00000+1.00000i"),
        (complex(1e-38, -2e-38), 2.2e-38, "1.00000e-38-2.00000e-38i"),
    ],
)
def test_values_are_printed_alike_on_either_side_of_rounding(value, size, text):
    assert page.value_text(value, size, 6) == text


def test_rows_say_more_digits_where_the_difference_needs_them():
    row = Row("c", "s", 344.382665, 344.38267, Tolerance(1e-7, "printed digits"))
    assert "| 344.382665 | 344.382670 | 1.5e-08 |" in page.row_text(row)


def test_what_changes_with_the_machine_is_printed_as_a_class():
    """Rounding and a requested rtol, however large; other differences by their number, and any that is too large."""
    row = Row("c", "s", 1 + 3e-7, 1.0, Tolerance(1e-6, "rounding", noise=True))
    assert page.row_text(row).endswith("| 1.00000 | 1.00000 | < 1e-06 | 1.0e-06, rounding | < 100 % |")
    assert page.row_text(replace(row, tolerance=Tolerance(1e-6, "next term"))).endswith(
        "| 3.0e-07 | 1.0e-06, next term | 30 % |"
    )
    assert page.row_text(replace(row, ours=3.0)).endswith("| 2.0e+00 | 1.0e-06, rounding | 200000000 % |")


# --- other programs ---------------------------------------------------------------------------------------


def test_unknown_programs_are_wrong_use(capsys):
    with pytest.raises(SystemExit, match="2"):
        run.main(["--check", "--with-programs", "tmn"])
    assert "expected names among tmm" in capsys.readouterr().err


def test_every_program_has_an_adapter_and_answers():
    stored = live.stored()
    assert set(stored) == set(PROGRAMS)
    for name, program in PROGRAMS.items():
        assert (live.ADAPTERS / f"with_{name.lower()}.py").exists()
        assert stored[name]["version"] == program.version
        assert len(stored[name]["answers"]) == 2 * len(program.stacks)


ADAPTER = """
from protocol import Stack, answer
answer(lambda stack: (stack.relative()[0][0], 1j * stack.angle * SCALE))
"""


@pytest.fixture
def echo(tmp_path, monkeypatch):
    """A program that this Python runs, whose answers change with a number; nothing is installed."""
    monkeypatch.setattr(live, "environment", lambda program, folder: sys.executable)
    monkeypatch.setattr(live, "ADAPTERS", tmp_path)
    monkeypatch.setattr(live, "ANSWERS", tmp_path / "answers.json")
    shutil.copy(FOLDER / "programs" / "adapters" / "protocol.py", tmp_path)
    monkeypatch.setitem(PROGRAMS, "Echo", Program("Echo", "1.0", ("three dense layers",)))

    def written(scale):
        (tmp_path / "with_echo.py").write_text(ADAPTER.replace("SCALE", repr(scale)), encoding="utf-8")

    written(1.0)
    return written


def test_live_runs_are_stored_and_held_to_what_is_stored(echo):
    """First stored with version and date; then the same within rounding, or told by their question."""
    assert run.run_programs(["Echo"], None, check=False) == []
    entry = json.loads(live.ANSWERS.read_text(encoding="utf-8"))["Echo"]
    assert entry["version"] == "1.0"
    assert entry["answers"]["three dense layers, 60°"] == [[2.0, 0.0], [0.0, math.radians(60)]]
    for scale, complaints in ((1.0, []), (1 + 1e-13, []), (1 + 1e-6, ["Echo: three dense layers, 60°"])):
        echo(scale)
        assert run.run_programs(["Echo"], None, check=True) == complaints


def test_questions_that_are_no_longer_answered_are_told(echo):
    run.run_programs(["Echo"], None, check=False)
    assert live.changed("Echo", {}) == ["Echo: three dense layers, 0°", "Echo: three dense layers, 60°"]
