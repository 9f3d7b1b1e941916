"""Fields at scattered points: against the independent bent contour, and against `field` on a grid."""

import tracemalloc

import numpy as np
import oracles
import pytest
from worse_contours import with_larger_errors

import beamprop as bp
from beamprop.api.field_at import field_at
from beamprop.fields import scattered

K0 = 2 * np.pi * 2500.0 / 343.0


def record(slab, beam, boundary="open", period=None, rtol=1e-10):
    return {"slab": slab, "beam": beam, "boundary": boundary, "period": period, "rtol": rtol}


def nodes(count, slab, z0=-0.1, seed=0):
    """Points in front of, inside and behind a slab, at random."""
    random = np.random.default_rng(seed)
    return random.uniform(-0.5, 0.7, count), random.uniform(z0, slab.thickness + 0.3, count)


def gaussian(width, angle):
    a = width / (2 * np.sqrt(np.log(2)))
    return lambda kx: a * np.sqrt(np.pi) * np.exp(-((a * (kx - K0 * np.sin(np.deg2rad(angle))) / 2) ** 2))


def on_grid(slab, beam, x, z, **question):
    """`field` at all pairs, of which the diagonal is asked for, and the largest |p| of each plane."""
    ds = bp.field(slab, beam, x=x, z=z, **question)
    return np.diagonal(ds.p.values, axis1=-2, axis2=-1), np.abs(ds.p.values).max(-1)


@pytest.mark.parametrize("angle", [0.0, 60.0])
@pytest.mark.parametrize("lossless", [True, False])
def test_points_against_a_bent_contour(lossless, angle):
    slab = bp.Slab(bp.lmmd_cell(0.05, 0.0) if lossless else bp.lmmd_cell(), 450)
    x, z = nodes(40, slab)
    got = field_at(record(slab, bp.GaussianBeam(0.096, angle, z0=-0.1)), np.array([2500.0]), np.array([angle]), x, z)
    want = oracles.open_field(slab, 2500.0, gaussian(0.096, angle), -0.1, x, z)
    assert got.shape == (1, 1, 40)
    assert np.max(np.abs(got[0, 0] - np.diagonal(want)) / np.abs(want).max(axis=1)) < 1e-8


def test_sweeps_and_beams_off_the_middle():
    """Frequencies, and so many angles that they are interpolated."""
    slab, beam = bp.Slab(bp.lmmd_cell(), 30), bp.GaussianBeam(0.096, x0=0.1, z0=-0.1)
    x, z = nodes(30, slab)
    frequency, angle = np.array([2000.0, 2500.0]), np.linspace(-50, 50, 41)
    got = field_at(record(slab, beam, rtol=1e-8), frequency, angle, x, z)
    want, largest = on_grid(slab, beam, x, z, frequency=frequency, angle=angle)
    assert got.shape == (2, 41, 30)
    assert np.max(np.abs(got - want) / largest) < 2e-8


def test_periodic_fields():
    slab, beam = bp.Slab(bp.lmmd_cell(), 30), bp.GaussianBeam(0.096, angle=20, z0=-0.1)
    x, z = nodes(30, slab)
    got = field_at(record(slab, beam, "periodic", 1.5), np.array([2500.0]), np.array([20.0]), x, z)
    want, largest = on_grid(slab, beam, x, z, frequency=2500.0, boundary="periodic", period=1.5)
    assert np.max(np.abs(got[0, 0] - want) / largest) < 1e-12


def test_rows_of_a_mapped_mesh():
    """Even positions on shared depths, for which a grid takes FFTs: the same values."""
    slab, beam = bp.Slab(bp.lmmd_cell(), 30), bp.GaussianBeam(0.096, z0=-0.1)
    x, z = np.linspace(-0.6, 0.6, 301), np.linspace(-0.1, 0.2, 7)
    want = bp.field(slab, beam, 2500.0, x, z, rtol=1e-8).p.values
    zz, xx = np.meshgrid(z, x, indexing="ij")
    order = np.random.default_rng(0).permutation(zz.size)
    got = field_at(record(slab, beam, rtol=1e-8), np.array([2500.0]), np.zeros(1), xx.ravel()[order], zz.ravel()[order])
    largest = np.repeat(np.abs(want).max(1), x.size)[order]
    assert np.max(np.abs(got[0, 0] - want.ravel()[order]) / largest) < 2e-8


def test_memory_is_that_of_a_block():
    """20 000 points at as many depths: a grid of them would be 6.4 GB."""
    slab = bp.Slab(bp.lmmd_cell(), 30)
    x, z = nodes(20_000, slab)
    question = record(slab, bp.GaussianBeam(0.096, z0=-0.1), rtol=1e-6)
    tracemalloc.start()
    try:
        assert np.all(np.isfinite(field_at(question, np.array([2500.0]), np.zeros(1), x, z)))
        assert tracemalloc.get_traced_memory()[1] < 2e8
    finally:
        tracemalloc.stop()


def test_an_accuracy_that_is_not_reached_is_said(monkeypatch):
    """As of a field on a grid."""
    with_larger_errors(monkeypatch)
    asked = record(bp.Slab(bp.lmmd_cell(), 5), bp.GaussianBeam(0.096), rtol=1e-8)
    with pytest.warns(bp.AccuracyWarning, match=r"3\.0e-05 .* rtol 1\.0e-08, mostly: the difference"):
        field_at(asked, np.array([2500.0]), np.zeros(1), np.zeros(2), np.array([0.0, 0.1]))


def test_what_is_not_finite_is_refused(monkeypatch):
    """A plane wave that meets a pole: no NaN leaves."""
    monkeypatch.setattr(
        scattered.transfer_function,
        "through",
        lambda s, z0, quantity="p": lambda k, z: np.full((z.size, k.size), np.inf + 0j),
    )
    asked = record(bp.Slab(bp.lmmd_cell(), 5), bp.GaussianBeam(0.096), "periodic", 1.0)
    with pytest.raises(ValueError, match="the field is not finite"):
        field_at(asked, np.array([2500.0]), np.zeros(1), np.zeros(2), np.array([0.0, 0.1]))
