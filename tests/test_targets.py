"""Where files may be written: what is replaced, what is left alone, and what is found before the work."""

import os

import pytest
from click.testing import CliRunner
from versions import names, version, versions_in

import beamprop as bp
from beamprop.cli import main
from beamprop.io.storage import whole

pytestmark = pytest.mark.skipif(os.name == "nt", reason="POSIX links and permissions")
NAMES = ["a.nc", "a.zarr"]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    "place", ["thesis.txt", "x/thesis.txt", "x/c/thesis.txt", "folder/thesis.txt", "x/c/1/thesis.txt"]
)
def test_a_store_with_something_else_in_it_is_not_replaced(tmp_path, name, place):
    """A zarr.json does not make a folder one that may be deleted."""
    path = tmp_path / name
    bp.save(version(1), tmp_path / "store.zarr")
    os.rename(tmp_path / "store.zarr", path)
    file = path / place
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text("years of work")
    with pytest.raises(
        ValueError, match=r"^path: expected a file or a Zarr store to replace, got a folder with other things"
    ):
        bp.save(version(2), path)
    assert file.read_text() == "years of work"
    assert names(tmp_path) == [name]


def test_a_folder_that_only_claims_to_be_a_store(tmp_path):
    """An empty zarr.json beside a thesis."""
    path = tmp_path / "a.zarr"
    path.mkdir()
    (path / "zarr.json").write_text("{}")
    with pytest.raises(ValueError, match=r"^path: .*other things"):
        bp.save(version(1), path)
    assert (path / "zarr.json").exists()


@pytest.mark.parametrize("target", ["empty", "store", "link to a store", "link to nothing", "file"])
@pytest.mark.parametrize("name", NAMES)
def test_what_may_be_replaced(tmp_path, name, target):
    """Files, stores and empty folders; of a link, the link alone."""
    path = tmp_path / name
    if target == "empty":
        path.mkdir()
    elif target == "store":
        bp.save(version(1), tmp_path / "b.zarr")
        os.rename(tmp_path / "b.zarr", path)
    elif target == "link to a store":
        bp.save(version(1), tmp_path / "b.zarr")
        path.symlink_to(tmp_path / "b.zarr")
    elif target == "link to nothing":
        path.symlink_to(tmp_path / "nothing")
    else:
        path.write_text("old")
    bp.save(version(2), path)
    assert versions_in(bp.load(path)) == {2}
    if target == "link to a store":
        assert versions_in(bp.load(tmp_path / "b.zarr")) == {1}


@pytest.mark.parametrize("ending", [".nc", ".zarr"])
@pytest.mark.parametrize("length", [245, 246, 250, 255])
def test_long_names(tmp_path, ending, length):
    """All that the file system takes, and beyond it a message; in letters of two bytes, too."""
    for letter in ("a", "é"):
        count = (length - len(ending)) // len(letter.encode())
        name = letter * count + "a" * (length - len(ending) - count * len(letter.encode())) + ending
        assert len(name.encode()) == length
        bp.save(version(1), tmp_path / name)
        bp.save(version(2), tmp_path / name)
        assert versions_in(bp.load(tmp_path / name)) == {2}
        with pytest.raises(ValueError, match=r"^path: expected a name that the file system takes, got .*too long"):
            bp.save(version(1), tmp_path / ("a" * (256 - length) + name))


def wrong_paths(tmp_path, ending):
    """Paths that cannot be written, and what is said of them."""
    (tmp_path / f"way{ending}").mkdir()
    (tmp_path / f"way{ending}" / "thesis.txt").write_text("years of work")
    (tmp_path / "file").write_text("")
    return {
        tmp_path / "none" / f"a{ending}": "existing folder",
        tmp_path / "file" / f"a{ending}": "existing folder",
        tmp_path / f"way{ending}": "other things",
        tmp_path / ("a" * 256 + ending): "too long",
        tmp_path / "closed" / f"a{ending}": "can be written",
    }


@pytest.fixture
def closed(tmp_path, monkeypatch):
    """A folder that may not be written to, for the superuser too."""
    (tmp_path / "closed").mkdir()
    may = os.access
    monkeypatch.setattr(os, "access", lambda path, mode: may(path, mode) and os.path.basename(path) != "closed")


@pytest.mark.usefixtures("closed")
@pytest.mark.parametrize("ending", [".nc", ".zarr"])
def test_save_field_finds_wrong_paths_before_the_work(tmp_path, monkeypatch, ending):
    """Not even the question is set up."""
    monkeypatch.setattr("beamprop.api.save_field.question_at", lambda *a: pytest.fail("work was begun"))
    for path, said in wrong_paths(tmp_path, ending).items():
        with pytest.raises(ValueError, match=rf"^path: .*{said}"):
            bp.save_field(path, bp.Slab(bp.lmmd_cell(), 5), bp.GaussianBeam(0.1), 2500.0, [0.0, 0.1], [0.0, 0.1])
    assert (tmp_path / f"way{ending}" / "thesis.txt").exists()


@pytest.mark.usefixtures("closed")
@pytest.mark.parametrize("command", ["field", "width", "spectrum", "bloch", "modes", "compare", "convert"])
def test_commands_find_wrong_paths_before_the_work(tmp_path, monkeypatch, command):
    """Exit 2 for every --output and --plot, and nothing is asked."""
    monkeypatch.setattr("beamprop.cli.questions.answer", lambda *a, **o: pytest.fail("work was begun"))
    monkeypatch.setattr("beamprop.cli.files.answer", lambda *a, **o: pytest.fail("work was begun"))
    source = tmp_path / "source.nc"
    bp.save(version(1), source)
    arguments = {"compare": [str(source)] * 2, "convert": [str(source)]}.get(command, [])
    for option, ending in (("--output", ".nc"), ("--output", ".zarr"), ("--plot", ".png")):
        if option == "--plot" and command == "convert":
            continue
        folder = tmp_path / ending
        (folder / "closed").mkdir(parents=True)
        for path, said in wrong_paths(folder, ending).items():
            target = [str(path)] if command == "convert" else [option, str(path)]
            result = CliRunner().invoke(main, [command, *arguments, *target])
            assert result.exit_code == 2, (path, result.output)
            assert said in " ".join(result.stderr.split())


def test_a_path_that_becomes_wrong_during_the_work(tmp_path):
    """A folder of others' that appeared meanwhile is left alone; the command says so, without a traceback."""
    path = tmp_path / "a.nc"

    def write(draft):
        draft.write_text("new")
        path.mkdir()
        (path / "thesis.txt").write_text("years of work")

    with pytest.raises(ValueError, match=r"^path: .*other things"):
        whole.write_whole(path, write)
    assert (path / "thesis.txt").read_text() == "years of work"
    assert names(tmp_path) == ["a.nc"]


def test_writing_leaves_the_mask_of_permissions_alone(tmp_path, monkeypatch):
    """Setting it, even for a moment, would open the files of other threads."""
    monkeypatch.setattr(os, "umask", lambda mask: pytest.fail("the mask was set"))
    for name in NAMES:
        bp.save(version(1), tmp_path / name)


@pytest.mark.parametrize("name", ["a\0.nc", "a\0.zarr", "a" * 300 + ".nc"])
def test_names_that_no_file_system_takes(tmp_path, name):
    """Said of the path, by save and load alike."""
    for ask in (lambda: bp.save(version(1), tmp_path / name), lambda: bp.load(tmp_path / name)):
        with pytest.raises(ValueError, match=r"^path: expected a name that the file system takes"):
            ask()
