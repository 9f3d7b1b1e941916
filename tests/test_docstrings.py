"""Every public name has an example in its docstring, and it runs and prints what it says."""

import doctest
import inspect

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest

import beamprop as bp

#: Public functions and classes by the names that users type; values and modules have no docstring of their own to hold one.
PUBLIC = {name: getattr(bp, name) for name in bp.__all__ if callable(getattr(bp, name))}
PUBLIC |= {f"fem.{name}": getattr(bp.fem, name) for name in ("field", "plan")}
PUBLIC |= {
    f"plot.{name}": getattr(bp.plot, name)
    for name in ("animate", "bloch", "comparison", "cut", "field", "modes", "scattering", "sweep", "width")
}
PUBLIC |= {
    "Fluid.from_speed": bp.Fluid.from_speed,
    "Membrane.drude": bp.Membrane.drude,
    "Membrane.lorentz": bp.Membrane.lorentz,
    "Profile.from_data": bp.Profile.from_data,
    "Profile.from_file": bp.Profile.from_file,
    "Slab.from_table": bp.Slab.from_table,
    "Solid.from_material": bp.Solid.from_material,
    "Solid.from_moduli": bp.Solid.from_moduli,
    "SourcePlane.from_data": bp.SourcePlane.from_data,
    "SourcePlane.from_file": bp.SourcePlane.from_file,
    "Slab.interface": bp.Slab.interface,
    "Slab.stack": bp.Slab.stack,
    "Slab.uniform": bp.Slab.uniform,
}


@pytest.fixture
def scratch(tmp_path, monkeypatch):
    """An empty folder to be in, and no figure left open."""
    monkeypatch.chdir(tmp_path)
    with mpl.rc_context({"backend": "agg"}):
        yield
    plt.close("all")


def test_no_public_function_is_left_out():
    """What is in plot and fem and meant for users is in PUBLIC; the two that are no functions are known."""
    assert {name for name in bp.__all__ if name not in PUBLIC} == {"AIR", "__version__", "fem", "plot"}
    assert {f"fem.{name}" for name in bp.fem.__all__ if inspect.isfunction(getattr(bp.fem, name))} <= set(PUBLIC)
    drawn = [name for name, value in vars(bp.plot).items() if inspect.isfunction(value) and not name.startswith("_")]
    assert {f"plot.{name}" for name in drawn} <= set(PUBLIC)


def test_no_other_way_to_make_a_record_is_left_out():
    """Class methods are typed by users, too."""
    made = {
        f"{name}.{member}"
        for name, value in PUBLIC.items()
        if isinstance(value, type)
        for member, kind in vars(value).items()
        if isinstance(kind, classmethod) and not member.startswith("_")
    }
    assert len(made) > 7
    assert made <= set(PUBLIC)


@pytest.mark.parametrize("name", [*PUBLIC, "beamprop"])
def test_example(name, scratch):
    """At least one line that uses the package, and no line whose output differs. Warnings are errors."""
    value = PUBLIC.get(name, bp)
    text = inspect.getdoc(value)
    test = doctest.DocTestParser().get_doctest(text, {"np": np, "bp": bp}, name, None, 0)
    assert any("bp." in example.source for example in test.examples), "no example"
    printed = []
    result = doctest.DocTestRunner(verbose=False).run(test, out=printed.append)
    assert result.failed == 0, "".join(printed)


def test_a_wrong_example_is_noticed():
    """The runner sees an output that differs, an exception, and a warning that is an error."""
    for text in (
        ">>> 1 + 1\n3\n",
        ">>> bp.Layer(bp.AIR, -1.0)\n",
        ">>> import warnings\n>>> warnings.warn('no', UserWarning)\n",
    ):
        test = doctest.DocTestParser().get_doctest(text, {"np": np, "bp": bp}, "wrong", None, 0)
        assert doctest.DocTestRunner(verbose=False).run(test, out=lambda _: None).failed == 1
