"""The contract of the public names: what is typed, what comes back, and what is said when the input is wrong."""

import numpy as np
import pytest
import xarray as xr
from worse_contours import with_larger_errors

import beamprop as bp
from beamprop import progress

F = 2500.0
CELL = bp.lmmd_cell()
SLAB = bp.Slab(CELL, 20)
BEAM = bp.GaussianBeam(0.096, z0=-0.05)
X = np.linspace(-0.6, 0.6, 61)

# --- as typed ---------------------------------------------------------------------------------------------


def test_the_calls_of_the_first_page():
    """The paper's slab from end to end, in the words that a user types."""
    slab = bp.Slab(bp.lmmd_cell(), periods=450)
    emt = bp.Slab.uniform(bp.lmmd_emt(slab.cell), slab.thickness)
    T = bp.scattering(slab, 2500.0, kx_over_k0=np.linspace(0, 5, 1001)).transmissivity
    efc = bp.bloch(slab.cell, 2500.0, kx_over_k0=np.linspace(-10, 10, 801))
    beam = bp.GaussianBeam(fwhm=0.096, angle=45, z0=-0.1)
    with pytest.warns(bp.HintWarning, match=r"^z: steps of 0.0014 m skip through cells of 0.00229 m"):
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


def test_progress_has_one_meaning(capsys, monkeypatch):
    """True shows a bar on stderr, for long work alone; False nothing; whatever the question."""
    monkeypatch.setattr(progress, "SHOWN_AFTER", 1e6)  # however slow the machine
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
    monkeypatch.setattr(progress, "SHOWN_AFTER", 0.0)
    assert list(progress.watched(True, range(3), "work")) == [0, 1, 2]
    assert "work" in capsys.readouterr().err


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
    with_larger_errors(monkeypatch)
    with pytest.warns(
        bp.AccuracyWarning, match=r"3\.0e-05 .* above the requested rtol 1\.0e-08, mostly: the difference"
    ):
        ds = bp.field(SLAB, BEAM, F, X, [0.0])
    assert ds.error_estimate == pytest.approx(3e-5, rel=1e-2)


# --- spectra ----------------------------------------------------------------------------------------------


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


def test_dispersive_media_are_evaluated_at_each_frequency():
    """A table of frequencies equals slabs of the numbers at each of them."""

    def density(f):
        return 1 + 1e-7 * f**2

    f = np.array([1000.0, 2000.0, 4000.0])
    ds = bp.scattering(bp.Slab.uniform(bp.Fluid(density, 1.4e5), 0.1), f, kx=3.0)
    for i, frequency in enumerate(f):
        alone = bp.scattering(bp.Slab.uniform(bp.Fluid(density(frequency), 1.4e5), 0.1), frequency, kx=3.0)
        assert ds.t.values[i] == pytest.approx(alone.t.item(), rel=1e-13)
