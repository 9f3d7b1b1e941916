"""What an answer records of its question rebuilds the slab, the beam and the settings."""

import json

import numpy as np
import pytest
import xarray as xr

import beamprop as bp
from beamprop.io import datasets

F = 2500.0
NAN, INF = float("nan"), float("inf")
CELL = bp.lmmd_cell()
SLAB = bp.Slab(CELL, 20)
BEAM = bp.GaussianBeam(0.096, z0=-0.05)
X = np.linspace(-0.6, 0.6, 61)
LAYER = bp.Layer(bp.AIR, 0.01)
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


def test_points_do_not_share_what_they_hold():
    """Datasets of points are copies of one that is kept, and records of a slab are kept: to change one changes no other."""
    slab, beam = bp.Slab(bp.lmmd_cell(), 20), bp.GaussianBeam(0.096)
    first = bp.beam_width(slab, beam, 2500.0)
    want = first.copy(deep=True)
    first.attrs.clear()
    first.fwhm_out.attrs["units"] = "furlong"
    first.fwhm_out.values[()] = 0.0
    first["frequency"] = 1.0
    again = bp.beam_width(slab, beam, 2500.0)
    xr.testing.assert_identical(again, want)


def test_a_record_does_not_depend_on_the_one_before():
    """That of a slab is kept for the next question: not of functions of frequency, nor for another slab."""
    beam = bp.GaussianBeam(0.096)
    slabs = [bp.Slab(bp.lmmd_cell(eta=eta), 20) for eta in (1 / 60, 1 / 50)]
    slabs.append(bp.Slab(bp.Layer(bp.Fluid(lambda f: 2.0 + 500j / f, 1.2e5), 0.01), 3))
    for f in (2400.0, 2500.0):
        for slab in slabs:
            made = bp.beam_width(slab, beam, f)
            record = json.loads(made.attrs["provenance"])
            assert record["slab"] == json.loads(json.dumps(datasets.describe(slab, np.array([f]))))
            assert made.attrs["provenance"] == json.dumps(record)
