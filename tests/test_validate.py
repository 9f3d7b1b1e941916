"""What is said of wrong arguments: one form of error, the argument's name in all of them, and nothing lost on the way."""

import contextlib
import datetime
import decimal
import fractions
import pathlib

import matplotlib.pyplot as plt
import numpy as np
import pytest

import beamprop as bp
from beamprop import validate

SLAB = bp.Slab(bp.lmmd_cell(), periods=3)
BEAM = bp.GaussianBeam(0.1, z0=-0.1)

#: No real number, though NumPy or Python would make one of most of them.
NO_NUMBERS = {
    "flag": True,
    "NumPy's flag": np.True_,
    "text": "2500",
    "bytes": b"2500",
    "none": None,
    "date": np.datetime64("2024-01-01"),
    "span": np.timedelta64(2500, "s"),
    "Python's date": datetime.datetime(2024, 1, 1),
    "complex": 2500 + 1j,
    "NumPy's complex": np.complex128(2500 + 1j),
    "complex without imaginary part": np.complex64(2500),
    "masked": np.ma.masked,
    "masked array": np.ma.array([2500.0, 2600.0], mask=[False, True]),
    "list with a masked value": [2500.0, np.ma.masked],
    "list of flags": [True, 2500.0],
    "array of flags": np.array([True, False]),
    "list of text": ["2500"],
    "array of dates": np.array(["2024-01-01"], "datetime64[D]"),
    "too large for a double": 10**400,
    "of too many digits to be written": 10**5000,
    "list of one too large": [2500.0, 10**400],
    "object": object(),
    "dict": {},
    "set": {2500.0},
    "nan": np.nan,
    "infinity": np.inf,
    "list of nothing": [],
    "ragged": [[1.0], [1.0, 2.0]],
    "function": abs,
}

#: A call for every argument that takes a real number or an axis: name -> a function of its value.
TAKERS = {
    "frequency": lambda v: bp.scattering(SLAB, v, kx=0.0),
    "kx_over_k0_max": lambda v: bp.guided_modes(SLAB, 2500.0, v),
    "strip_over_k0": lambda v: bp.guided_modes(SLAB, 2500.0, 10.0, v),
    "x": lambda v: bp.field(SLAB, BEAM, 2500.0, v, 0.1),
    "z": lambda v: bp.field(SLAB, BEAM, 2500.0, 0.0, v),
    "rtol": lambda v: bp.field(SLAB, BEAM, 2500.0, 0.0, 0.1, rtol=v),
    "thickness": lambda v: bp.Layer(bp.AIR, v),
    "fwhm": lambda v: bp.GaussianBeam(v),
    "x0": lambda v: bp.GaussianBeam(0.1, x0=v),
    "z0": lambda v: bp.GaussianBeam(0.1, z0=v),
    "angle": lambda v: bp.GaussianBeam(0.1, angle=v),
    "width": lambda v: bp.Slits(v, 0.2),
    "separation": lambda v: bp.Slits(0.1, v),
    "delta_rho": lambda v: bp.lmmd_cell(delta_rho=v),
    "eta": lambda v: bp.lmmd_cell(eta=v),
    "design_frequency": lambda v: bp.lmmd_cell(design_frequency=v),
    "periods": lambda v: bp.Slab(bp.lmmd_cell(), v),
    "n_layers": lambda v: bp.lmmd_cell(n_layers=v),
    "count": lambda v: bp.Slits(0.1, 0.2, v),
    "memory": lambda v: bp.save_field("never.nc", SLAB, BEAM, 2500.0, 0.0, 0.1, memory=v),
    "period": lambda v: bp.fem.plan(SLAB, BEAM, 2500.0, v),
    "order": lambda v: bp.fem.plan(SLAB, BEAM, 2500.0, 1.0, v),
    "layer_rows": lambda v: bp.fem.plan(SLAB, BEAM, 2500.0, 1.0, layer_rows=v),
}

#: The same for complex numbers: NaN and infinity are refused too, complex values are not.
COMPLEX_TAKERS = {
    "density": lambda v: bp.Fluid(v, 1e5),
    "bulk_modulus": lambda v: bp.Fluid(1.0, v),
    "density_x": lambda v: bp.Fluid(1.0, 1e5, v),
    "sound_speed": lambda v: bp.Fluid.from_speed(1.0, v),
    "areal_density": lambda v: bp.Membrane(v),
    "rho_m": lambda v: bp.lmmd_cell(v),
    "kx": lambda v: bp.scattering(SLAB, 2500.0, kx=v),
    "kx_over_k0": lambda v: bp.scattering(SLAB, 2500.0, kx_over_k0=v),
}


@pytest.mark.parametrize("kind", NO_NUMBERS)
@pytest.mark.parametrize("name", TAKERS)
def test_no_numbers_are_refused_by_name(name, kind):
    """A ValueError that begins with the argument's name, and no warning (which would be an error here)."""
    with pytest.raises(ValueError, match=rf"^{name}: expected .*, got "):
        TAKERS[name](NO_NUMBERS[kind])


@pytest.mark.parametrize("kind", NO_NUMBERS)
@pytest.mark.parametrize("name", COMPLEX_TAKERS)
def test_no_complex_numbers_are_refused_by_name(name, kind):
    """So where complex numbers are taken; a property may be a function, density_x none or infinite, and kx none."""
    legitimate = ("complex" in kind and name != "angle") or kind == "function"
    if (
        legitimate
        or (name == "density_x" and kind in ("none", "infinity"))
        or (name.startswith("kx") and kind == "none")
    ):
        pytest.skip("legitimate")
    with pytest.raises(ValueError, match=rf"^{name}: expected .*, got "):
        COMPLEX_TAKERS[name](NO_NUMBERS[kind])


@pytest.mark.parametrize(
    "value",
    [
        2500,
        2500.0,
        np.float32(2500),
        np.int8(25) * np.int64(100),
        np.array(2500.0),
        fractions.Fraction(2500),
        np.uint16(2500),
    ],
    ids=lambda v: type(v).__name__,
)
def test_numbers_of_every_kind_pass(value):
    """Whatever stands for one real number is taken as that number."""
    assert validate.as_number(value, "x") == 2500.0
    assert validate.as_complex(value, "x") == 2500.0
    assert validate.axis(value, "x") == 2500.0
    assert validate.as_count(value, "x") == 2500


def test_axes_of_every_kind_pass():
    """Lists, ranges, objects and masked arrays without a masked value; the caller's array is not shared."""
    for value in ([1, 2.5], (1, 2.5), np.array([1, 2.5], object), np.ma.array([1, 2.5]), [fractions.Fraction(1), 2.5]):
        np.testing.assert_array_equal(validate.axis(value, "x"), [1.0, 2.5])
    np.testing.assert_array_equal(validate.axis(range(1, 3), "x"), [1.0, 2.0])
    given = np.array([1.0, 2.0])
    assert not np.shares_memory(validate.axis(given, "x"), given)
    with pytest.raises(ValueError, match=r"^x: expected "):
        validate.axis([decimal.Decimal("sNaN"), 1.0], "x")


def test_an_imaginary_part_is_kept():
    """np.complex128 has a __float__ that drops it: a density keeps it, a thickness refuses it."""
    assert bp.Fluid(np.complex64(1 + 2j), 1e5).density == 1 + 2j
    with pytest.raises(ValueError, match=r"^thickness: expected a real number, got "):
        bp.Layer(bp.AIR, np.complex128(0.1 + 0.2j))


@pytest.mark.parametrize("value", [np.array([1 + 0j, 2.0]), [1j]])
def test_complex_axes_are_refused_where_real_ones_are_meant(value):
    with pytest.raises(ValueError, match=r"^frequency: expected real numbers, got complex ones"):
        bp.scattering(SLAB, value, kx=0.0)


@pytest.mark.parametrize(
    ("name", "ask"),
    {
        "active": lambda v: bp.Fluid(1.0, 1e5, active=v),
        "interface": lambda v: bp.lmmd_emt_slab(SLAB, v),
        "conjugate": lambda v: bp.read_comsol("never.txt", conjugate=v),
    }.items(),
)
@pytest.mark.parametrize("value", [1, "yes", None, np.array([True, False]), [True]], ids=str)
def test_flags(name, ask, value):
    """True or False, and nothing that Python takes for either."""
    with pytest.raises(ValueError, match=rf"^{name}: expected True or False, got "):
        ask(value)


@pytest.mark.parametrize("value", [1, None, ["open"], np.array(["open", "periodic"]), {}, "Open"], ids=str)
def test_words(value):
    """One of some words; arrays and lists, which compare by elements or have no hash, are refused alike."""
    field = bp.field(SLAB, BEAM, 2500.0, np.linspace(-1, 1, 8), 0.1).p
    for name, ask in {
        "boundary": lambda: bp.field(SLAB, BEAM, 2500.0, 0.0, 0.1, boundary=value),
        "width_of": lambda: bp.GaussianBeam(0.1, width_of=value),
        "form": lambda: bp.GaussianBeam(0.1, form=value),
        "method": lambda: bp.fem.plan(SLAB, BEAM, 2500.0, 1.0, method=value),
        "quantity": lambda: bp.plot.field(field.to_dataset(), quantity=value),
    }.items():
        with pytest.raises(ValueError, match=rf"^{name}: expected '"):
            ask()
    with pytest.raises(ValueError, match=r"^width_of: expected '"):
        bp.fwhm(field, width_of=value)


@pytest.mark.parametrize("value", [None, 1, 2.5, [], "", "a\0b", b"a.nc", {}], ids=repr)
def test_paths(value):
    """Text, or an object that stands for a path."""
    for ask in (
        lambda: bp.save_field(value, SLAB, BEAM, 2500.0, 0.0, 0.1),
        lambda: bp.read_comsol(value),
        lambda: bp.Profile.from_file(value),
    ):
        with pytest.raises(ValueError, match=r"^path: expected the path of a file, got "):
            ask()
    assert validate.as_path("a.nc") == validate.as_path(pathlib.Path("a.nc")) == pathlib.Path("a.nc")


def test_objects():
    """An instance, not the class itself, which has the members of a protocol too; and a function where one is meant."""
    for ask in (
        lambda: bp.field(SLAB, bp.GaussianBeam, 2500.0, 0.0, 0.1),
        lambda: bp.beam_width(SLAB, None, 2500.0),
        lambda: bp.fem.plan(SLAB, 3, 2500.0, 1.0),
    ):
        with pytest.raises(ValueError, match=r"^beam: expected a Beam \(GaussianBeam, Profile, Slits\), got "):
            ask()
    with pytest.raises(ValueError, match=r"^progress: expected True, False or a function, got 'yes'"):
        bp.field(SLAB, BEAM, 2500.0, 0.0, 0.1, progress="yes")
    with pytest.raises(ValueError, match=r"^ds: expected a Dataset, got 3"):
        bp.provenance(3)
    with pytest.raises(ValueError, match=r"^ax: expected Axes of matplotlib, got 3"):
        bp.plot.scattering(bp.scattering(SLAB, 2500.0, kx_over_k0=[0.0, 0.5]), ax=3)
    plt.close("all")


def test_messages_are_short():
    """Whatever came is shown shortened, and never fails to be shown."""

    class Silent:
        def __repr__(self):
            raise RuntimeError("no repr")

    for value in (list(range(100_000)), np.full((4, 100_000), np.nan), "x" * 10_000, Silent(), 10**5000):
        with pytest.raises(ValueError, match=r"^x0: expected ") as caught:
            bp.GaussianBeam(0.1, x0=value)
        assert len(str(caught.value)) < 300


# --- the range of double precision ------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "ask"),
    {
        "frequency": lambda: bp.scattering(SLAB, 1e155, kx=0.0),
        "bulk_modulus": lambda: bp.Fluid(1.0, 1e-300),
        "density": lambda: bp.Fluid(5e-324, 1e5),
        "density_x": lambda: bp.Fluid(1.0, 1e5, 1e-200),
        "areal_density": lambda: bp.Membrane(1e300),
        "thickness": lambda: bp.Layer(bp.AIR, 1e200),
        "kx": lambda: bp.scattering(SLAB, 2500.0, kx=[0.0, 1e160]),
        "kx_over_k0": lambda: bp.scattering(SLAB, 1e40, kx_over_k0=1e40),
        "x": lambda: bp.field(SLAB, BEAM, 2500.0, 1e300, 0.1),
        "z": lambda: bp.field(SLAB, BEAM, 2500.0, 0.0, 1e300),
        "x0": lambda: bp.GaussianBeam(0.1, x0=1e300),
        "fwhm": lambda: bp.GaussianBeam(1e-200),
        "p": lambda: bp.Profile([0.0, 1.0], [1e300, 1.0]),
        "sound_speed": lambda: bp.Fluid.from_speed(1.0, 1e40),
    }.items(),
)
def test_out_of_range(name, ask):
    """What would overflow inside is refused by name, with the range, and without a warning."""
    with pytest.raises(ValueError, match=rf"^{name}: expected a magnitude of .*1e\+50, which double precision .* got "):
        ask()


def test_functions_of_frequency_are_held_to_the_range():
    """At the frequencies that are asked."""
    slab = bp.Slab.uniform(bp.Fluid(lambda f: 1e60 * f, 1e5), 0.1)
    with pytest.raises(ValueError, match=r"^density: expected a magnitude "):
        bp.scattering(slab, 2500.0, kx=0.0)


def test_a_function_may_overwrite_what_it_is_given():
    """The frequencies that it gets are its own."""

    def doubled(f):
        f *= 2
        return f

    plain = bp.Slab.uniform(bp.Fluid(lambda f: 2 * f, 1e5), 0.1)
    rude = bp.Slab.uniform(bp.Fluid(doubled, 1e5), 0.1)
    kx = np.linspace(0, 30, 5)
    assert bp.scattering(plain, [800.0, 900.0], kx=kx).t.equals(bp.scattering(rude, [800.0, 900.0], kx=kx).t)


@pytest.mark.parametrize("size", [1e50, 1e-50])
def test_the_ends_of_the_range_are_computed_with(size):
    """Every property, length and frequency at an end of the range: a finite answer, and a warning where no digit is left of it."""
    slab = bp.Slab.uniform(bp.Fluid(size, size, size), size, bp.Fluid(1.0, 1.0), bp.Fluid(1.0, 1.0))
    with contextlib.nullcontext() if size < 1 else pytest.warns(bp.AccuracyWarning, match="last bits"):
        answer = bp.scattering(slab, size, kx=[0.0, size])
    assert np.all(np.isfinite(answer.r))
    assert np.all(np.isfinite(answer.t))


def test_phases_that_are_no_numbers_end():
    """Inside, infinite and undefined phases raise instead of recursing without end."""
    from beamprop.response.layer import entire

    for wrong in (np.nan, np.inf, complex(np.nan, np.inf)):
        with pytest.raises(ValueError, match="slab: expected layers whose phase squared"):
            entire(np.array([1.0, wrong], complex))
