"""The walls: data flows one way, each concept has one home, and what is public is documented."""

import ast
import importlib
import re

import pytest
from source_tree import CHECKOUT, FILES, ROOT, tree

import beamprop as bp

#: A module imports only from those before it. A new module takes its place here, and in docs/architecture.md.
ORDER = [
    "_version",
    "conventions",
    "memory",
    "validate",
    "progress",
    "arrays",
    "media",
    "response",
    "sources",
    "modes",
    "contour",
    "fields",
    "profiles",
    "io",
    "fem",
    "api",
    "comparison",
    "plot",
    "parameters",
    "study",
    "cli",
    "__main__",
]
#: Those that see less than all that stands before them.
ONLY = {
    "conventions": set(),
    "memory": set(),
    "validate": {"memory"},
    "progress": {"validate"},
    "arrays": {"memory"},
    "media": {"conventions", "memory", "validate"},
    "response": {"conventions", "media", "arrays"},
    "sources": {"arrays", "conventions", "memory", "validate"},
    "modes": {"response"},
    "contour": {"arrays", "memory", "response", "sources", "modes"},
    "fields": {"arrays", "media", "response", "sources", "contour"},
    "profiles": {"arrays", "memory", "response", "sources", "modes", "contour", "fields"},
    "io": {"memory", "validate", "media", "sources"},
    "fem": {"conventions", "memory", "validate", "progress", "media", "sources", "io"},
    "comparison": {"validate", "sources", "profiles", "io", "api"},
    "plot": {"validate", "media", "profiles", "io"},
    "parameters": {"memory", "validate", "media", "sources"},
    "study": {"memory", "validate", "progress", "media", "io", "api", "plot", "parameters"},
}


MODULES = sorted(set(FILES.values()) - {"__init__"})


def own_imports(path):
    """Names of the package's modules that a file imports, anywhere in it."""
    depth = len(path.relative_to(ROOT).parts) - 1
    modules = set()
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.ImportFrom) and node.level > depth:
            modules |= {node.module.split(".")[0]} if node.module else {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith("beamprop"):
            modules |= {*node.module.split(".")[1:2]} or {alias.name for alias in node.names}
        elif isinstance(node, ast.Import):
            modules |= {
                name for alias in node.names if alias.name.startswith("beamprop") for name in alias.name.split(".")[1:2]
            }
    return modules - {FILES[path]}


def foreign_imports(path):
    """Full names of all that a file imports from other packages."""
    imports = set()
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.ImportFrom) and not node.level:
            imports |= {f"{node.module}.{alias.name}" for alias in node.names} | {node.module}
        elif isinstance(node, ast.Import):
            imports |= {alias.name for alias in node.names}
    return imports


def files_of(module):
    return [path for path, name in FILES.items() if name == module]


# --- one way ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("module", MODULES)
def test_data_flows_one_way(module):
    """A module imports only from those that stand before it in ORDER, function-level imports included."""
    assert module in ORDER, f"{module} has no place in ORDER"
    before = set(ORDER[: ORDER.index(module)])
    for path in files_of(module):
        allowed = ONLY.get(module, before)
        assert allowed <= before
        assert own_imports(path) - {"_version"} <= allowed, path.name


def test_the_documentation_lists_the_rooms_in_order():
    """The table of docs/architecture.md is ORDER."""
    text = (CHECKOUT / "docs" / "architecture.md").read_text(encoding="utf-8")
    assert re.findall(r"^\| `(\w+)` \|", text, re.MULTILINE) == ORDER


def test_the_checker_sees_imports():
    """It finds relative and function-level imports in files and folders (or the tests here would hold by themselves)."""
    assert {"io", "fields", "response", "sources", "media"} <= set().union(*map(own_imports, files_of("api")))
    assert {"parameters", "io", "api", "plot"} <= set().union(*map(own_imports, files_of("cli")))
    assert "pyfftw" in set().union(*map(foreign_imports, files_of("arrays")))
    assert len(FILES) >= 18


@pytest.mark.parametrize("module", MODULES)
def test_one_user_of_fft_libraries(module):
    """arrays/fft.py alone imports pyfftw or scipy.fft."""
    for path in files_of(module):
        fft = {name for name in foreign_imports(path) if name.split(".")[0] == "pyfftw" or name.startswith("scipy.fft")}
        assert not fft or path.name == "fft.py"


def makes_datasets(path):
    """Lines on which a file calls xr.Dataset(...) or Dataset(...)."""
    calls = (node for node in ast.walk(tree(path)) if isinstance(node, ast.Call))
    return [
        node.lineno
        for node in calls
        if (isinstance(node.func, ast.Attribute) and node.func.attr == "Dataset")
        or (isinstance(node.func, ast.Name) and node.func.id == "Dataset")
    ]


@pytest.mark.parametrize("module", MODULES)
def test_one_maker_of_datasets(module):
    """datasets alone makes them, so that every one has units, long names and provenance."""
    for path in files_of(module):
        assert not makes_datasets(path) or path.name == "datasets.py", path


def test_one_branch_of_the_square_root():
    """outgoing_kz is defined in conventions, and nothing else is called so."""
    homes = [
        FILES[path]
        for path in FILES
        for node in ast.walk(tree(path))
        if isinstance(node, ast.FunctionDef) and node.name in ("outgoing_kz", "branch_wavenumber")
    ]
    assert homes == ["conventions", "conventions"]


def test_one_home_of_checks():
    """What is a number, a count, an axis, an angle, a path is decided in validate, and what fits in memory."""
    names = {"as_number", "as_count", "as_path", "instance", "flag", "word"}
    homes = {
        (node.name, FILES[path])
        for path in FILES
        for node in ast.walk(tree(path))
        if isinstance(node, ast.FunctionDef) and node.name in names | {"available"}
    }
    assert homes == {(name, "validate") for name in names} | {("available", "memory")}


@pytest.mark.parametrize(
    "module",
    ["conventions", "arrays", "media", "response", "sources", "modes", "contour", "fields", "profiles"],
)
def test_kernels_know_arrays_only(module):
    """Below the questions nothing imports xarray, matplotlib, click or tqdm."""
    for path in files_of(module):
        assert not {name.split(".")[0] for name in foreign_imports(path)} & {
            "xarray",
            "matplotlib",
            "click",
            "tqdm",
            "h5netcdf",
        }


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_nothing_prints_and_nothing_is_global(path):
    """No print in the package (the command uses click.echo), no `global`, no star import, no bare except."""
    for node in ast.walk(tree(path)):
        assert not (isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "print"), (
            node.lineno
        )
        assert not isinstance(node, ast.Global), node.lineno
        assert not (isinstance(node, ast.ImportFrom) and node.names[0].name == "*"), node.lineno
        assert not (isinstance(node, ast.ExceptHandler) and node.type is None), node.lineno


# --- what is public ---------------------------------------------------------------------------------------


def undocumented(path):
    """Public functions and classes of a file, at its top level, that have no docstring."""
    return [
        node.name
        for node in tree(path).body
        if isinstance(node, ast.FunctionDef | ast.ClassDef)
        and not node.name.startswith("_")
        and not ast.get_docstring(node)
    ]


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_docstrings(path):
    """Every file, public function and public class says what it is for."""
    assert undocumented(path) == []
    assert ast.get_docstring(tree(path)) or path.name == "_version.py"


@pytest.mark.parametrize("name", bp.__all__)
def test_public_names_exist_and_are_documented(name):
    """Each name of __all__ can be had; functions, classes and their public members have docstrings."""
    value = getattr(bp, name)
    if isinstance(value, type) or (callable(value) and hasattr(value, "__name__")):
        assert value.__doc__
        assert value.__module__.startswith("beamprop")
    if isinstance(value, type) and not issubclass(value, Warning):
        members = [
            m
            for m, v in vars(value).items()
            if not m.startswith("_") and (callable(v) or isinstance(v, property | classmethod))
        ]
        assert [m for m in members if not getattr(value, m).__doc__] == []


def test_public_names_have_one_home():
    """What type checkers see is what users get: the names imported under TYPE_CHECKING are those of __all__."""
    checked = {
        alias.name: node.module
        for node in ast.walk(tree(ROOT / "__init__.py"))
        if isinstance(node, ast.ImportFrom) and node.level
        for alias in node.names
    }
    assert set(checked) == set(bp.__all__)
    for name, home in checked.items():
        if home and not name.startswith("__"):
            assert getattr(importlib.import_module(f"beamprop.{home}"), name) is getattr(bp, name)


# --- storage ----------------------------------------------------------------------------------------------


#: Files of the storage package, in the order in which they may import one another.
STORAGE = [
    *("blocked", "parts", "rounding", "whole", "settled", "guarded", "seal"),
    *("netcdf", "zarr_store", "matlab", "__init__"),
]


@pytest.mark.parametrize("name", STORAGE)
def test_storage_is_in_layers(name):
    """Paths know nothing of formats, formats nothing of save and load."""
    path = ROOT / "io" / "storage" / f"{name}.py"
    inner = {
        alias
        for node in ast.walk(tree(path))
        if isinstance(node, ast.ImportFrom) and node.level == 1
        for alias in ([node.module] if node.module else [a.name for a in node.names])
    }
    assert inner <= set(STORAGE[: STORAGE.index(name)])
    assert {p.stem for p in (ROOT / "io" / "storage").glob("*.py")} == set(STORAGE)
