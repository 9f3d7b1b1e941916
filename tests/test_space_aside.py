"""Windows far aside of a beam: sums over differences from the source, against plain ones, and against Rayleigh's integral."""

import tracemalloc

import numpy as np
import pytest
from scipy.special import jv
from space_oracles import rayleigh_field

import beamprop as bp
from beamprop.contour.space import differences, lattice, sheet
from beamprop.sources.angles import single
from beamprop.sources.in_space import EllipticalGaussian

FREQUENCY = 2500.0
K0 = 2 * np.pi * FREQUENCY / 343.0
LOSSY = bp.Slab(bp.lmmd_cell(), 450)


def sums_over_differences(monkeypatch):
    """How many grids of differences are formed from now on."""
    formed = []

    def counted(*args):
        formed.append(differences.differences(*args))
        return formed[-1]

    monkeypatch.setattr(sheet, "differences", counted)
    return formed


@pytest.mark.parametrize("y", [np.linspace(-0.4, 0.4, 3), np.array([0.2, 0.9])])
def test_planes_of_differences_are_a_convolution(y):
    """A beam, summed over its launch plane with G(r) from its nodes, without lattice, taper, table and transform."""
    k, x, band = np.linspace(1, 40, 60) - 0.05j, np.linspace(7, 8, 4), 40.0
    weight, h = np.cos(k) * k / 60, np.exp(0.3j * k)
    beam = EllipticalGaussian((0.2, 0.15), 20.0, 30.0, 0.0)
    ends = beam.box(K0, 1e-14)
    axes = [differences.axis(v.min() - 1.2, v.max() + 1.2, of, band, 6.0) for v, of in zip((x, y), ends, strict=True)]
    grid = differences.differences(k, weight, tuple(axes), band)
    p = np.empty((1, 1, y.size, x.size), complex)
    lattice.fields(grid, grid.spectra(K0, single(beam)), h[None], x, y, p)
    u = np.linspace(-1.2, 1.2, 81)
    tilt = K0 * np.sin(np.radians(20))
    along = tilt * (u * np.cos(np.radians(30)) + u[:, None] * np.sin(np.radians(30)))
    launched = np.exp(-((u / 0.2) ** 2) - (u[:, None] / 0.15) ** 2 + 1j * along) * (u[1] - u[0]) ** 2
    for j, b in enumerate(y):
        for i, a in enumerate(x):
            r = np.hypot(a - u, b - u[:, None])
            g = sum(w * v * jv(0, q * r) for w, v, q in zip(weight / (2 * np.pi), h, k, strict=True))
            assert abs(p[0, 0, j, i] - np.sum(launched * g)) < 1e-12 * np.abs(p).max()


@pytest.mark.parametrize(("angle", "side"), [(80.0, 1), (45.0, -1)])
def test_rayleighs_integral_far_aside(angle, side, monkeypatch):
    formed = sums_over_differences(monkeypatch)
    beam = bp.GaussianBeam(0.3, angle, z0=-0.1)
    x, y, z = side * np.linspace(30, 34, 5), np.array([-1.0, 0.0, 0.7]), 3.0
    p = bp.field(bp.Slab.uniform(bp.AIR, 0.5), beam, FREQUENCY, x, z, y=y, rtol=1e-9).p.values
    u, v = (a.ravel() for a in np.meshgrid(x, y))
    known = rayleigh_field(K0, beam, (u, v), np.array([z]), 0.05).reshape(p.shape)
    near = rayleigh_field(K0, beam, (np.array([3.1 * np.tan(np.radians(45.0))]), np.zeros(1)), np.array([z]), 0.05)
    assert len(formed) >= 2
    assert np.max(np.abs(p - known)) < 1e-9 * np.abs(near).max()


def test_it_is_what_a_lattice_gives(monkeypatch):
    """Behind a slab, on cut and plane: a lattice from the source on, where neither is worth a grid of differences."""
    beam, z = bp.GaussianBeam(0.3, 70, z0=-0.1), np.array([0.6, LOSSY.thickness])
    x, y = np.linspace(8, 9, 7), np.linspace(-0.5, 0.5, 5)
    formed = sums_over_differences(monkeypatch)
    monkeypatch.setattr(sheet, "WORTH_IT", 0.0)
    p = bp.field(LOSSY, beam, FREQUENCY, x, z, y=y, rtol=1e-9).p.values
    assert formed
    formed.clear()
    monkeypatch.setattr(sheet, "WORTH_IT", np.inf)
    q = bp.field(LOSSY, beam, FREQUENCY, np.append(x, 0.0), z, y=y, rtol=1e-11).p.values
    assert not formed
    apart = np.abs(p - q[..., :-1]).max(axis=(1, 2))
    assert np.all(apart < 1e-9 * np.abs(q).max(axis=(1, 2)))


def test_a_large_window_three_hundred_wavelengths_aside():
    """A plane of 4 m x 4 m, refused once: its grid, tables and contours take less than 100 MiB."""
    x, y = np.linspace(30, 34, 60), np.linspace(-2, 2, 60)
    tracemalloc.start()
    ds = bp.field(bp.Slab(bp.lmmd_cell(0.05, 0.0), 450), bp.GaussianBeam(0.27, 45, z0=-0.1), FREQUENCY, x, 1.2, y=y)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert float(ds.error_estimate) < 1e-8
    assert peak < 100 * 2**20
