"""The documentation is true: snippets run, commands parse, links and names lead somewhere, the README's lines make its picture."""

import ast
import re
import shlex
from pathlib import Path

import click
import doc_snippets
import materials
import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import picture
import pytest
import steps
import update_docs
from click.testing import CliRunner
from common import save_all

from beamprop.cli import main

CHECKOUT = Path(__file__).parents[1]
README = CHECKOUT / "README.md"
PAGES = [README, CHECKOUT / "CONTRIBUTING.md", *sorted((CHECKOUT / "docs").glob("*.md"))]


def blocks(page, kind):
    """(the line before it, text) of every block of a kind."""
    return [(block.before, block.text) for block in doc_snippets.blocks(page.read_text(encoding="utf-8"), kind)]


def with_blocks(kind):
    return [pytest.param(page, id=page.name) for page in PAGES if blocks(page, kind)]


@pytest.fixture
def scratch(tmp_path, monkeypatch):
    """An empty folder to be in, and no figure left open."""
    monkeypatch.chdir(tmp_path)
    with mpl.rc_context({"backend": "agg"}):
        yield tmp_path
    plt.close("all")


# --- snippets and commands --------------------------------------------------------------------------------


@pytest.mark.parametrize("page", with_blocks("python"))
def test_snippets_run(page, scratch):
    """Every Python block, from the top of a page to its end; warnings are errors. What a page says that they print and draw, they do.

    `python experiments/doc_snippets.py PAGE.md` writes both anew.
    """
    text = page.read_text(encoding="utf-8")
    for block, printed in doc_snippets.run(text, page.name):
        if block.before == doc_snippets.OWN_PROCESS:  # HDF5's end on a full disk
            assert "File too large" in printed
        elif block.printed is not None:
            assert printed == block.printed, block.text
    for name in doc_snippets.images(text):
        made, shown = (plt.imread(folder / name) for folder in (scratch, page.parent / "images"))
        assert shown.shape == made.shape, name
        assert np.mean(np.abs(shown - made)) < 0.01, name


def commands():
    """Every line of a shell block that calls the command, as its arguments."""
    found = []
    for page in PAGES:
        for _, text in blocks(page, "sh"):
            for line in text.replace("\\\n", " ").splitlines():
                for part in line.split("&&"):
                    words = shlex.split(part, comments=True)
                    if words and Path(words[0]).name == "beamprop":
                        found.append(pytest.param(words[1:], id=" ".join(words[1:])))
    return found


@pytest.fixture
def inputs(scratch):
    """The files that commands read."""
    for name in ("beam.nc", "comsol_export.txt", "study.toml", "angles.toml"):
        (scratch / name).touch()
    return scratch


@pytest.mark.parametrize("words", commands())
def test_commands_parse(words, inputs):
    """Every command and option exists and takes what is given to it."""
    command = main.get_command(click.Context(main), words[0])
    command.make_context(words[0], words[1:])


def test_commands_of_the_guide_run(scratch):
    """All but those that write gigabytes or read another program's file; in order, for the last reads what the first wrote."""
    ran = 0
    for words in (param.values[0] for param in commands()):
        if words[0] != "compare" and "--memory" not in words:
            result = CliRunner().invoke(main, words)
            assert result.exit_code == 0, (words, result.output)
            ran += 1
    assert ran >= 7
    assert {path.name for path in scratch.iterdir()} >= {"beam.png", "beam.nc", "beam.zarr", "spectrum.png", "width.nc"}


# --- the README -------------------------------------------------------------------------------------------


def test_the_readme_is_short():
    assert 4000 <= README.stat().st_size <= 6000


def test_the_lines_of_the_readme_make_its_picture(scratch):
    """Ten lines; pixel by pixel what experiments/picture.py makes, and the picture that is shown.

    The stored file may differ by another version's rendering of letters, 1/100 of the scale at the mean.
    """
    text = blocks(README, "python")[0][1]
    assert len(text.splitlines()) == 10
    exec(compile(text, "README.md", "exec"), {})
    data = picture.compute()
    save_all("experiment", scratch, {}, picture.plot(data))
    made, drawn = (plt.imread(scratch / name) for name in ("beam.png", "experiment.png"))
    np.testing.assert_array_equal(made, drawn)
    shown = plt.imread(CHECKOUT / "experiments" / "pictures" / "beam.png")
    assert shown.shape == made.shape
    assert np.mean(np.abs(shown - made)) < 0.01


# --- what the pages name ----------------------------------------------------------------------------------


def anchor(heading):
    """The anchor that a heading gets."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page):
    """Every relative link names a file, and a heading of it if it names one."""
    for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text(encoding="utf-8")):
        if target.startswith("http"):
            continue
        name, _, heading = target.partition("#")
        file = page.parent / name if name else page
        assert file.exists(), target
        if heading:
            headings = re.findall(r"^#+ (.*)$", file.read_text(encoding="utf-8"), re.MULTILINE)
            assert heading in map(anchor, headings), target


#: Where a file may lie that a page names by a part of its path.
ROOTS = [CHECKOUT / part for part in ("", "beamprop", "tests")]


def defined(path):
    """Names that a module defines at its top level."""
    body = ast.parse(path.read_text(encoding="utf-8")).body
    return {node.name for node in body if isinstance(node, ast.FunctionDef | ast.ClassDef)}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_files_that_are_named_exist(page):
    """`room/file.py` is a file of the package, the tests or the checkout; "`room/file.py`: `name`, `name`" defines the names."""
    text = page.read_text(encoding="utf-8")
    for name, names in re.findall(r"`([\w/]+\.py)`(?:: ((?:`\w+`(?:, )?)+))?", text):
        found = [root / name for root in ROOTS if (root / name).exists()]
        assert found, name
        assert set(re.findall(r"\w+", names)) <= defined(found[0]), name


def test_scripts_that_are_called_exist():
    """`python experiments/...py` names a script."""
    called = {
        name for page in PAGES for name in re.findall(r"experiments/[\w/]+\.py", page.read_text(encoding="utf-8"))
    }
    assert {"experiments/accuracy.py", "experiments/reproduce.py", "experiments/fuzz.py"} <= called
    assert [name for name in called if not (CHECKOUT / name).exists()] == []


# --- tables -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name",
    [
        "accuracy",
        "limit",
        "statements",
        "benchmarks",
        "shares",
        "steps",
        "materials",
        "point",
        "kills",
        "sweep",
        "conformance",
    ],
)
def test_tables_are_filled_by_their_name(name, tmp_path):
    """Each table has one place; what is written there is the table, and nothing else of any page changes."""
    before = {page.name: page.read_text(encoding="utf-8") for page in (CHECKOUT / "docs").glob("*.md")}
    for file, text in before.items():
        (tmp_path / file).write_text(text, encoding="utf-8")
    table = tmp_path / "table.txt"
    table.write_text(r"| \1 | new |", encoding="utf-8")
    update_docs.main(name, table, tmp_path)
    mark = f"<!-- table:{name} -->\n"
    changed = {file: text for file, text in before.items() if (tmp_path / file).read_text(encoding="utf-8") != text}
    ((file, text),) = changed.items()
    head, _, rest = text.partition(mark)
    _, end, tail = rest.partition("<!-- end -->")
    assert (tmp_path / file).read_text(encoding="utf-8") == head + mark + "| \\1 | new |\n" + end + tail


def test_the_table_of_materials_is_the_one_that_is_printed():
    """As experiments/materials.py prints it, to the last digit."""
    text = (CHECKOUT / "docs" / "media.md").read_text(encoding="utf-8")
    assert f"<!-- table:materials -->\n{materials.table()}\n<!-- end -->" in text


def test_a_table_without_a_place_is_refused(tmp_path):
    (tmp_path / "page.md").write_text("no marks\n", encoding="utf-8")
    with pytest.raises(SystemExit, match="expected one table named accuracy"):
        update_docs.main("accuracy", tmp_path / "page.md", tmp_path)


def test_shares_of_time_are_those_of_functions_that_exist():
    """Each stage of experiments/benchmarks/steps.py names a function of a file, and a row of the page."""
    script = (CHECKOUT / "experiments" / "benchmarks" / "steps.py").read_text(encoding="utf-8")
    page = (CHECKOUT / "docs" / "benchmarks.md").read_text(encoding="utf-8")
    stages = re.findall(r'"([^"]+)": \("([\w/]+\.py)", "(\w+)"\)', script)
    assert len(stages) > 10
    for stage, file, function in stages:
        assert f"def {function}(" in (CHECKOUT / "beamprop" / file).read_text(encoding="utf-8"), stage
        assert f"| {stage} |" in page


def test_steps_switch_off_what_exists():
    """Each step of experiments/benchmarks/steps.py replaces a name that its module has, and has a row of the page."""
    page = (CHECKOUT / "docs" / "benchmarks.md").read_text(encoding="utf-8")
    assert len(steps.STEPS) > 5
    for step in steps.STEPS:
        assert hasattr(step.where, step.what), step.name
        assert f"| {step.name} |" in page
