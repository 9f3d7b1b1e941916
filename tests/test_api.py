"""The contract of the public names: what is typed, what comes back, and what is said when the input is wrong."""

import json

import numpy as np
import pytest
import xarray as xr

import beamprop as bp
from beamprop import progress
from beamprop.contour import choose as contour_choice
from beamprop.io import datasets

F = 2500.0
K0 = 2 * np.pi * F / 343
NAN, INF = float("nan"), float("inf")
CELL = bp.lmmd_cell()
SLAB = bp.Slab(CELL, 20)
BEAM = bp.GaussianBeam(0.096, z0=-0.05)
X = np.linspace(-0.6, 0.6, 61)
LAYER = bp.Layer(bp.AIR, 0.01)


# --- as typed ---------------------------------------------------------------------------------------------


def test_the_calls_of_the_first_page():
    """The paper's slab from end to end, in the words that a user types."""
    slab = bp.Slab(bp.lmmd_cell(), periods=450)
    emt = bp.Slab.uniform(bp.lmmd_emt(slab.cell), slab.thickness)
    T = bp.scattering(slab, 2500.0, kx_over_k0=np.linspace(0, 5, 1001)).transmissivity
    efc = bp.bloch(slab.cell, 2500.0, kx_over_k0=np.linspace(-10, 10, 801))
    beam = bp.GaussianBeam(fwhm=0.096, angle=45, z0=-0.1)
    p = bp.field(slab, beam, 2500.0, x=np.linspace(-1.4, 1.4, 1024), z=np.linspace(-0.1, 1.3, 1000))
    w = bp.beam_width(slab, bp.GaussianBeam(0.096), np.linspace(2000, 3000, 101))
    assert slab.thickness == pytest.approx(450 * 0.1372 / 60)
    assert bp.scattering(emt, 2500.0, kx_over_k0=0.5).transmissivity == pytest.approx(
        float(T.sel(kx_over_k0=0.5)), rel=0.1
    )
    assert T.sizes == {"kx_over_k0": 1001}
    assert efc.kz_over_k0.sizes == {"kx_over_k0": 801}
    assert p.p.shape == (1000, 1024)
    assert p.error_estimate <= 1e-8
    assert w.sizes == {"frequency": 101}
    assert bool((w.fwhm_out < w.fwhm_air).all())


def test_every_public_name_is_there():
    """The table of names, and nothing undocumented in it."""
    wanted = {
        "Fluid",
        "AIR",
        "Layer",
        "Cell",
        "Slab",
        "lmmd_cell",
        "standard_emt",
        "lmmd_emt",
        "lmmd_emt_slab",
        "scattering",
        "bloch",
        "field",
        "beam_width",
        "fwhm",
        "GaussianBeam",
        "Profile",
        "Slits",
        "save",
        "load",
        "plot",
    }
    assert wanted <= set(bp.__all__)
    assert set(dir(bp)) == set(bp.__all__)
    with pytest.raises(AttributeError, match="nonsense"):
        bp.nonsense  # noqa: B018


# --- what comes back --------------------------------------------------------------------------------------

AXES = [1000.0, [1000.0], [1000.0, 1500.0, 2000.0]]


def assert_labelled(ds):
    """Every variable and coordinate says its units and its name in full."""
    for name, v in ds.variables.items():
        assert v.attrs["units"], name
        assert v.attrs["long_name"], name


def sizes(**axes):
    return {name: len(v) for name, v in axes.items() if np.ndim(v)}


@pytest.mark.parametrize("frequency", AXES)
@pytest.mark.parametrize("name", ["kx", "kx_over_k0", "angle"])
@pytest.mark.parametrize("value", [0.5, [0.0, 0.5, 0.9, 0.95]])
def test_scattering_dimensions(frequency, name, value):
    """Scalars are scalar coordinates, arrays are dimensions; kx and kx_over_k0 ride along."""
    ds = bp.scattering(SLAB, frequency, **{name: value})
    want = sizes(frequency=frequency, **{name: value})
    answers = {"r", "t", "transmissivity", "reflectivity", "energy_transmission", "absorption"}
    assert set(ds.data_vars) == answers | {"error_estimate", "r_error_estimate", "t_error_estimate"}
    for v in ds.data_vars.values():
        assert dict(v.sizes) == want
        assert list(v.dims) == [d for d in ("frequency", name) if d in want]
    assert {"frequency", name, "kx", "kx_over_k0"} <= set(ds.coords)
    np.testing.assert_allclose(ds[name], value)
    assert_labelled(ds)
    k0 = 2 * np.pi * ds.frequency / 343
    np.testing.assert_allclose(*xr.broadcast(ds.kx / k0, ds.kx_over_k0), rtol=1e-13)
    if name == "angle":
        np.testing.assert_allclose(*xr.broadcast(ds.kx_over_k0, np.sin(np.deg2rad(ds.angle))), rtol=1e-13)


def test_scattering_values():
    """transmissivity and reflectivity are |t|^2 and |r|^2, for evanescent waves too; energies are nan there."""
    ds = bp.scattering(SLAB, [2000.0, F], kx_over_k0=[0.3, 1.7])
    np.testing.assert_array_equal(ds.transmissivity, np.abs(ds.t) ** 2)
    np.testing.assert_array_equal(ds.reflectivity, np.abs(ds.r) ** 2)
    np.testing.assert_array_equal(np.isnan(ds.energy_transmission), [[False, True]] * 2)
    np.testing.assert_array_equal(np.isnan(ds.absorption), [[False, True]] * 2)
    for i, f in enumerate(ds.frequency.values):
        alone = bp.scattering(SLAB, float(f), kx_over_k0=0.3)
        assert alone.t.item() == pytest.approx(ds.t.values[i, 0], rel=1e-12)


@pytest.mark.parametrize("frequency", AXES)
@pytest.mark.parametrize("name", ["kx", "kx_over_k0"])
@pytest.mark.parametrize("value", [0.5, [-1.0, 0.0, 0.5]])
def test_bloch_dimensions(frequency, name, value):
    """kz and kz_over_k0 on (frequency, the one given)."""
    ds = bp.bloch(CELL, frequency, **{name: value})
    assert set(ds.data_vars) == {"kz", "kz_over_k0", "error_estimate"}
    assert dict(ds.kz.sizes) == sizes(frequency=frequency, **{name: value})
    k0 = 2 * np.pi * ds.frequency / 343
    np.testing.assert_allclose(*xr.broadcast(ds.kz / k0, ds.kz_over_k0), rtol=1e-13)
    assert_labelled(ds)


def test_bloch_background():
    """kz_over_k0 counts in the wavenumber of the stated background."""
    helium = bp.Fluid.from_speed(0.18, 972.0)
    ds = bp.bloch(CELL, F, kx_over_k0=0.5, background=helium)
    k0 = 2 * np.pi * F / 972
    assert ds.kz_over_k0.item() == pytest.approx(ds.kz.item() / k0, rel=1e-13)
    assert ds.kz.item() == pytest.approx(bp.bloch(CELL, F, kx=0.5 * k0).kz.item(), rel=1e-13)


@pytest.mark.parametrize("frequency", [F, [2400.0, F]])
@pytest.mark.parametrize("angle", [None, 10.0, [0.0, 20.0, 40.0]])
@pytest.mark.parametrize(("x", "z"), [(X, [-0.05, 0.1]), (0.1, [0.0, 0.02]), (X, 0.3), (0.1, 0.01)])
def test_field_dimensions(frequency, angle, x, z):
    """p on (frequency, angle, z, x), scalars dropped; error_estimate on (frequency, angle)."""
    ds = bp.field(SLAB, BEAM, frequency, x, z, angle=angle)
    assert dict(ds.p.sizes) == sizes(frequency=frequency, angle=angle, z=z, x=x)
    assert list(ds.p.dims) == [d for d in ("frequency", "angle", "z", "x") if d in ds.p.dims]
    assert dict(ds.error_estimate.sizes) == sizes(frequency=frequency, angle=angle)
    assert {"frequency", "angle", "z", "x"} <= set(ds.coords)
    assert ds.p.dtype == complex
    assert bool((ds.error_estimate <= 1e-8).all())
    assert_labelled(ds)
    assert ds.attrs["boundary"] == "open"
    assert ds.attrs["slab_thickness"] == SLAB.thickness


def test_periodic_fields():
    """The period is the grid's length by default, is recorded, and makes p periodic."""
    x = (np.arange(100) - 50) * 0.01
    ds = bp.field(SLAB, BEAM, F, x, [0.1], boundary="periodic")
    assert ds.attrs["period"] == pytest.approx(1.0)
    again = bp.field(SLAB, BEAM, F, np.concatenate([x, x + 1.0]), [0.1], boundary="periodic", period=1.0)
    np.testing.assert_allclose(again.p.values[:, :100], ds.p.values, atol=1e-12)
    np.testing.assert_allclose(again.p.values[:, 100:], ds.p.values, atol=1e-12)
    open_field = bp.field(SLAB, BEAM, F, x, [0.1])
    assert 1e-5 < np.abs(open_field.p - ds.p).max() < 0.3


@pytest.mark.parametrize("frequency", [F, [2400.0, F]])
@pytest.mark.parametrize("angle", [None, 10.0, [0.0, 20.0]])
def test_beam_width_dimensions(frequency, angle):
    """Six variables on (frequency, angle)."""
    ds = bp.beam_width(SLAB, BEAM, frequency, angle=angle)
    assert set(ds.data_vars) == {"fwhm_launch", "fwhm_in", "fwhm_out", "fwhm_air", "peak_out", "centroid_out"}
    for v in ds.data_vars.values():
        assert dict(v.sizes) == sizes(frequency=frequency, angle=angle)
    assert_labelled(ds)


def test_progress_has_one_meaning(capsys):
    """True shows a bar on stderr, for long work alone; False nothing; whatever the question."""
    questions = (
        lambda p: bp.field(SLAB, BEAM, F, 0.0, 0.1, progress=p),
        lambda p: bp.beam_width(SLAB, BEAM, F, progress=p),
        lambda p: bp.beam_measures(SLAB, BEAM, F, progress=p),
        lambda p: bp.fem.field(bp.Slab.uniform(bp.AIR, 0.05), BEAM, F, np.zeros(1), np.zeros(1), 2.21, progress=p),
    )
    for ask in questions:
        shown = [ask(p) for p in (True, False, list)]
        assert shown[0].drop_attrs().equals(shown[1].drop_attrs())
        with pytest.raises(ValueError, match=r"^progress: expected True, False or a function, got 1"):
            ask(1)
    assert capsys.readouterr().err == ""
    bars = [progress.watched(True, range(3), "work"), progress.watched(False, range(3), "work")]
    assert [list(bar) for bar in bars] == [[0, 1, 2]] * 2
    assert type(bars[0]).__name__ == "tqdm"


def test_progress_wraps_the_work():
    """`progress` sees every frequency of a field and every block of widths."""
    seen = []

    def watch(items):
        for item in items:
            seen.append(item)
            yield item

    bp.field(SLAB, BEAM, [2400.0, F], 0.0, 0.1, progress=watch)
    assert seen == [2400.0, F]
    seen.clear()
    bp.beam_width(SLAB, BEAM, np.linspace(2400, F, 200), progress=watch)
    assert len(seen) == 2


def test_an_accuracy_that_is_not_reached_is_said(monkeypatch):
    """An estimate above rtol is reported in the dataset and warned of by a category of its own."""
    choose = contour_choice.choose_contour

    def worse(*args):
        solution = choose(*args)
        return solution._replace(budget=solution.budget._replace(difference=solution.budget.difference + 3e-5))

    monkeypatch.setattr(contour_choice, "choose_contour", worse)
    with pytest.warns(
        bp.AccuracyWarning, match=r"3\.0e-05 .* above the requested rtol 1\.0e-08, mostly: the difference"
    ):
        ds = bp.field(SLAB, BEAM, F, X, [0.0])
    assert ds.error_estimate == pytest.approx(3e-5, rel=1e-2)


# --- widths -----------------------------------------------------------------------------------------------


def profile(size, x, **dims):
    return xr.DataArray(size, {"x": ("x", x, {"units": "m"}), **dims}, (*dims, "x"), attrs={"units": "Pa"})


@pytest.mark.parametrize(
    ("width_of", "factor"), [("pressure", 2 * np.sqrt(np.log(2))), ("intensity", np.sqrt(2 * np.log(2)))]
)
@pytest.mark.parametrize("points", [25, 200])
def test_fwhm_of_a_gaussian(width_of, factor, points):
    """2 a sqrt(ln 2) of |p|, a sqrt(2 ln 2) of |p|^2, to a part in 1000 with six samples in a width, 1e-6 with fifty."""
    a = 0.1
    x = np.linspace(-0.32, 0.3, points)
    p = profile(np.exp(-((x / a) ** 2) + 11j * x), x)
    got = bp.fwhm(p, width_of=width_of)
    assert got.item() == pytest.approx(a * factor, rel=2e-3 if points == 25 else 1e-6)
    assert got.attrs["units"] == "m"
    assert got.attrs["long_name"]


def test_fwhm_along_other_dimensions():
    """One width per row; the dimension can have any name and order."""
    x, a = np.linspace(-1, 1, 201), np.array([0.1, 0.2, 0.3])
    p = profile(np.exp(-((x / a[:, None]) ** 2)), x, z=("z", [0.0, 1.0, 2.0]))
    np.testing.assert_allclose(bp.fwhm(p), 2 * a * np.sqrt(np.log(2)), rtol=1e-5)
    assert bp.fwhm(p).dims == ("z",)
    np.testing.assert_allclose(bp.fwhm(p[:, ::-1].T), bp.fwhm(p), rtol=1e-12)
    renamed = bp.fwhm(p.rename(x="y"), "y")
    np.testing.assert_allclose(renamed, bp.fwhm(p))


def test_fwhm_beyond_the_window_is_nan_and_said():
    """The half level outside the window on one side is enough for nan; other rows keep their width."""
    x = np.linspace(-0.05, 0.5, 100)
    p = profile(np.exp(-((x / np.array([[0.1], [0.02]])) ** 2)), x, z=("z", [0.0, 1.0]))
    with pytest.warns(RuntimeWarning, match="half level"):
        got = bp.fwhm(p)
    assert np.isnan(got[0])
    assert got[1] == pytest.approx(0.04 * np.sqrt(np.log(2)), rel=1e-4)


def test_fwhm_is_between_the_places_nearest_to_the_peak():
    """A side lobe above half the peak does not count, and is warned of."""
    x = np.linspace(-1, 1, 801)
    p = profile(np.exp(-((x / 0.1) ** 2)) + 0.8 * np.exp(-(((x - 0.6) / 0.1) ** 2)), x)
    with pytest.warns(RuntimeWarning, match="4 times"):
        width = bp.fwhm(p)
    assert width == pytest.approx(0.2 * np.sqrt(np.log(2)), rel=1e-5)


@pytest.mark.parametrize(
    ("value", "name", "options"),
    [
        (3, "profile", {}),
        (profile(np.ones(9), np.arange(9.0)).to_dataset(name="p"), "profile", {}),
        (profile(np.ones(3), np.arange(3.0)), "profile", {}),
        (profile(np.full(9, NAN), np.arange(9.0)), "profile", {}),
        (profile(np.ones(9), np.arange(9.0)), "dim", {"dim": "y"}),
        (profile(np.ones(9), np.arange(9.0)), "width_of", {"width_of": "p"}),
    ],
)
def test_fwhm_refuses(value, name, options):
    """No DataArray, too few samples, NaN, an unknown dimension or option."""
    with pytest.raises(ValueError, match=rf"^{name}:"):
        bp.fwhm(value, **options)


@pytest.mark.parametrize("width_of", ["pressure", "intensity"])
def test_a_beam_is_as_wide_as_it_says(width_of):
    """fwhm is the width at launch of what width_of names, by field and by beam_width alike."""
    beam = bp.GaussianBeam(0.2, 25.0, z0=-0.1, width_of=width_of)
    x = np.linspace(-0.5, 0.5, 201)
    # far in front of a slab of air: the incident beam alone
    p = bp.field(bp.Slab.uniform(bp.AIR, 0.1), beam, F, x, -0.1).p
    assert bp.fwhm(p, width_of=width_of) == pytest.approx(0.2, rel=1e-6)
    ds = bp.beam_width(SLAB, beam, F)
    assert ds.fwhm_launch.item() == pytest.approx(0.2, rel=1e-9)


def test_widths_are_those_of_the_field():
    """fwhm_in, fwhm_out, fwhm_air and peak_out against the fields they are measures of."""
    beam = bp.GaussianBeam(0.096, 20.0, x0=0.05, z0=-0.1)
    ds = bp.beam_width(SLAB, beam, F, air_distance=0.3)
    x = np.linspace(-0.6, 0.9, 1501)
    nothing = bp.field(bp.Slab.uniform(bp.AIR, 0.5), beam, F, x, [0.0, 0.2]).p
    behind = bp.field(SLAB, beam, F, x, SLAB.thickness).p
    assert ds.fwhm_in.item() == pytest.approx(bp.fwhm(nothing[0]).item(), rel=1e-6)
    assert ds.fwhm_air.item() == pytest.approx(bp.fwhm(nothing[1]).item(), rel=1e-6)
    assert ds.fwhm_out.item() == pytest.approx(bp.fwhm(behind).item(), rel=1e-6)
    assert ds.peak_out.item() == pytest.approx(np.abs(behind).max().item(), rel=1e-4)
    power = np.abs(behind) ** 2
    assert ds.centroid_out.item() == pytest.approx(((power * behind.x).sum() / power.sum()).item(), abs=2e-3)


def test_a_beam_through_air_lands_where_it_aims():
    """centroid_out = x0 + (L - z0) tan(theta) for a wide beam through a slab of air."""
    slab = bp.Slab.uniform(bp.AIR, 0.4)
    ds = bp.beam_width(slab, bp.GaussianBeam(1.0, 30.0, x0=0.3, z0=-0.1), F)
    assert ds.centroid_out.item() == pytest.approx(0.3 + 0.5 * np.tan(np.deg2rad(30)), abs=2e-3)


def test_air_distance_is_two_wavelengths_by_default():
    """At each frequency of its own."""
    f = np.array([2000.0, 2500.0])
    default = bp.beam_width(SLAB, BEAM, f).fwhm_air
    for i, frequency in enumerate(f):
        stated = bp.beam_width(SLAB, BEAM, frequency, air_distance=2 * 343 / frequency).fwhm_air
        assert default[i].item() == pytest.approx(stated.item(), rel=1e-9)


def test_no_beam_behind_is_nan_and_said():
    """Behind an opaque slab there is no half level: nan with a warning, and the other widths stay."""
    with pytest.warns(RuntimeWarning, match="fwhm_out"):
        ds = bp.beam_width(bp.Slab(bp.lmmd_cell(0.05 + 0.5j, 0.25), 50_000), BEAM, F)
    assert np.isnan(ds.fwhm_out)
    assert ds.fwhm_launch == pytest.approx(0.096)


# --- spectra ----------------------------------------------------------------------------------------------

LINES = [np.linspace(-60, 60, 13), np.linspace(-60, 60, 13) - 2j]


def integral(p, lo, hi, kx, count=4000):
    """integral p(x) exp(-i kx x) dx by Gauss-Legendre nodes."""
    g, w = np.polynomial.legendre.leggauss(50)
    edges = np.linspace(lo, hi, count // 50 + 1)
    half = (edges[1] - edges[0]) / 2
    x = ((edges[:-1] + half)[:, None] + half * g).ravel()
    return np.exp(-1j * np.outer(kx, x)) @ (p(x) * half * np.tile(w, edges.size - 1))


@pytest.mark.parametrize("kx", LINES, ids=["real", "complex"])
@pytest.mark.parametrize("angle", [0.0, 40.0])
def test_spectrum_of_a_gaussian(kx, angle):
    """S(kx) is the integral of the launched profile, off centre and tilted."""
    beam = bp.GaussianBeam(0.09, angle, x0=0.2)
    np.testing.assert_allclose(
        beam.spectrum(kx, K0), integral(lambda x: beam.profile(x, K0), -0.5, 0.9, kx), atol=1e-12
    )
    a = 0.09 / (2 * np.sqrt(np.log(2)))
    x = np.array([0.2, 0.25, 0.3])
    want = np.exp(-(((x - 0.2) / a) ** 2) + 1j * K0 * np.sin(np.deg2rad(angle)) * (x - 0.2))
    np.testing.assert_allclose(beam.profile(x, K0), want, rtol=1e-12)


@pytest.mark.parametrize("kx", LINES, ids=["real", "complex"])
@pytest.mark.parametrize(("count", "angle"), [(1, 0.0), (2, 0.0), (5, 30.0)])
def test_spectrum_of_slits(kx, count, angle):
    """The integral over every slit, exactly, tilted by the phase."""
    slits = bp.Slits(0.03, 0.08, count, angle=angle)
    tilt = K0 * np.sin(np.deg2rad(angle))
    want = sum(
        integral(lambda x: np.exp(1j * tilt * x), c - 0.015, c + 0.015, kx, 100)
        for c in (np.arange(count) - (count - 1) / 2) * 0.08
    )
    np.testing.assert_allclose(slits.spectrum(kx, K0), want, atol=1e-13)
    assert slits.spectrum(np.array([tilt]), K0)[0] == pytest.approx(count * 0.03)


@pytest.mark.parametrize("kx", LINES, ids=["real", "complex"])
@pytest.mark.parametrize("even", [True, False])
@pytest.mark.parametrize("angle", [0.0, 30.0])
def test_spectrum_of_a_profile(kx, even, angle):
    """The integral of a smooth sampled profile, on even or uneven samples, tilted about its middle."""

    def p(x):
        return (1 + 3 * x) * np.exp(-((x / 0.1) ** 2) + 7j * x)

    x = np.linspace(-0.7, 0.8, 301)
    x = x if even else x + 0.001 * np.sin(9 * x)
    tilt = K0 * np.sin(np.deg2rad(angle))
    middle = (x[0] + x[-1]) / 2
    want = integral(lambda u: p(u) * np.exp(1j * tilt * (u - middle)), -0.7, 0.8, kx)
    got = bp.Profile(x, p(x), angle=angle).spectrum(kx, K0)
    np.testing.assert_allclose(got, want, atol=1e-12 if even else 1e-6)


def test_a_profile_is_interpolated_between_its_samples():
    """profile() returns the samples at the samples, and the smooth curve between."""
    x = np.linspace(-0.5, 0.5, 101)
    beam = bp.Profile(x, np.exp(-((x / 0.1) ** 2)))
    np.testing.assert_allclose(beam.profile(x, K0), beam.p, atol=1e-14)
    np.testing.assert_allclose(
        beam.profile(x[30:70] + 0.003, K0), np.exp(-(((x[30:70] + 0.003) / 0.1) ** 2)), atol=1e-9
    )


@pytest.mark.parametrize("angle", [0.0, 45.0, -60.0])
def test_a_rotated_beam_has_its_waist_across_its_axis(angle):
    """On the line through (x0, z0) across the axis |p| is the Gaussian of the stated width."""
    beam = bp.GaussianBeam(0.5, angle, x0=0.1, z0=-0.2, form="rotated")
    theta = np.deg2rad(angle)
    xi = -np.sign(angle) * np.array([0.0, 0.125, 0.25, 0.4])  # the side that lies behind the launch plane
    a = 0.5 / (2 * np.sqrt(np.log(2)))
    for s in xi if angle else np.array([0.0, 0.25, -0.4]):
        p = bp.field(bp.Slab.uniform(bp.AIR, 1.0), beam, F, 0.1 + s * np.cos(theta), -0.2 - s * np.sin(theta)).p
        assert abs(p.item()) == pytest.approx(np.exp(-((s / a) ** 2)), abs=1e-5)


@pytest.mark.parametrize(
    "beam",
    [
        bp.Slits(0.02, 0.05, 1),
        bp.GaussianBeam(0.096, form="rotated", z0=-0.1),
        bp.Profile(np.linspace(-0.3, 0.3, 121), np.exp(-((np.linspace(-0.3, 0.3, 121) / 0.08) ** 2))),
    ],
    ids=["slits", "rotated", "profile"],
)
def test_every_source_answers_every_question(beam):
    """field behind the slab and beam_width with their default accuracy."""
    ds = bp.field(SLAB, beam, F, X, [SLAB.thickness, 0.2])
    assert ds.error_estimate <= 1e-8
    assert 0 < bp.beam_width(SLAB, beam, F).fwhm_out < 1


# --- provenance -------------------------------------------------------------------------------------------

STACK = bp.Slab(CELL, 3) + bp.Slab([LAYER, bp.Membrane(0.1 + 0.2j)], after=bp.Fluid(2 + 1j, 1e5 - 3j, INF))
ACTIVE = bp.Slab.uniform(bp.Fluid(1 - 1j, 1e5, active=True), 0.1)


@pytest.mark.parametrize(
    "slab",
    [
        SLAB,
        STACK,
        ACTIVE,
        bp.lmmd_emt_slab(SLAB),
        bp.lmmd_emt_slab(STACK.__class__(CELL, 2), False),
        bp.Slab.uniform(bp.standard_emt(CELL), 0.1),
    ],
    ids=["paper", "stack", "active", "emt", "bare", "standard"],
)
def test_provenance_rebuilds_the_slab(slab):
    """The record makes an equal slab, with the version and the question beside it."""
    record = bp.provenance(bp.scattering(slab, [F, 2600.0], kx=1.0))
    assert record["slab"] == slab
    assert record["beamprop"] == bp.__version__
    assert record["question"] == "scattering"


@pytest.mark.parametrize(
    "beam",
    [
        BEAM,
        bp.GaussianBeam(0.1, 30.0, 0.2, -0.3, "intensity", "rotated"),
        bp.Profile(
            np.linspace(-0.3, 0.3, 31),
            np.exp(-((np.linspace(-0.3, 0.3, 31) / 0.08) ** 2)) * (1 + 1j),
            z0=-0.1,
            angle=3.0,
        ),
    ],
    ids=["gaussian", "rotated", "profile"],
)
def test_provenance_rebuilds_the_beam(beam):
    """And the settings of the call."""
    record = bp.provenance(bp.field(SLAB, beam, F, X, 0.2, rtol=1e-6))
    assert record["beam"] == beam
    assert record["slab"] == SLAB
    assert (record["rtol"], record["boundary"], record["period"]) == (1e-6, "open", None)
    assert bp.provenance(bp.beam_width(SLAB, beam, F, rtol=1e-6))["beam"] == beam


def test_provenance_of_slits():
    """Slits are a record too."""
    slits = bp.Slits(0.02, 0.05, 3, -0.01, 5.0)
    assert datasets.rebuild(json.loads(json.dumps(datasets.describe(slits, np.array([F]))))) == slits


def test_provenance_of_bloch():
    """The cell and the background."""
    helium = bp.Fluid.from_speed(0.18, 972.0)
    record = bp.provenance(bp.bloch(CELL, F, kx=0, background=helium))
    assert (record["cell"], record["background"]) == (CELL, helium)


def test_a_users_dispersive_function_is_recorded_as_a_table():
    """The rebuilt slab gives the same response at the recorded frequencies and refuses others."""
    fluid = bp.Fluid(lambda f: 1.25 + 1e-4j * f, lambda f: 1.4e5 + 2 * f, density_x=2.0)
    slab = bp.Slab([bp.Layer(fluid, 0.02)], 5, after=fluid)
    f = np.array([2000.0, 2100.0, 2900.0])
    ds = bp.scattering(slab, f, kx=[1.0, 30.0])
    again = bp.provenance(ds)["slab"]
    np.testing.assert_allclose(bp.scattering(again, f, kx=[1.0, 30.0]).t, ds.t, rtol=1e-12)
    between = bp.scattering(again, 2050.0, kx=1.0).t.item()
    assert between == pytest.approx(bp.scattering(slab, 2050.0, kx=1.0).t.item(), rel=1e-9)  # the function is linear
    with pytest.raises(ValueError, match=r"^frequency:.*2000"):
        bp.scattering(again, 1999.0, kx=1.0)


def test_dispersive_media_are_evaluated_at_each_frequency():
    """A table of frequencies equals slabs of the numbers at each of them."""

    def density(f):
        return 1 + 1e-7 * f**2

    f = np.array([1000.0, 2000.0, 4000.0])
    ds = bp.scattering(bp.Slab.uniform(bp.Fluid(density, 1.4e5), 0.1), f, kx=3.0)
    for i, frequency in enumerate(f):
        alone = bp.scattering(bp.Slab.uniform(bp.Fluid(density(frequency), 1.4e5), 0.1), frequency, kx=3.0)
        assert ds.t.values[i] == pytest.approx(alone.t.item(), rel=1e-13)
