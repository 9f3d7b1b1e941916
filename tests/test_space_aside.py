"""Windows far aside of a beam: sums over differences from the source, against plain ones, and against Rayleigh's integral."""

import tracemalloc

import numpy as np
import pytest
from scipy.special import jv
from space_oracles import rayleigh_field

import beamprop as bp
from beamprop.contour.space import bessel_sums, differences, lattice, radial, sheet
from beamprop.response import transfer_function
from beamprop.response.sampled_slab import sample
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


def test_sums_of_bessel_functions_by_series():
    """One node at a time and all together, near the origin and off the axis too, against J0 itself."""
    v = np.linspace(0.01, 60, 6000)
    k, weight = v - 0.15j * np.tanh(v / 20), np.cos(v) + 0.5j
    k[4000:4003] += [3j, -2.5j, 0.1j]
    k[:60] = 0.05 * np.exp(1j * np.pi * np.arange(60) / 30)  # a circle about the origin
    positions = 40 + 3 * np.cos((np.arange(240) + 0.5) * np.pi / 240)
    sums = bessel_sums.bessel_sums(k, weight, positions, (37.0, 43.0))
    assert sums.alone.size < 200
    assert sum(piece.series.size for piece in sums.pieces) < k.size * positions.size / 10
    chosen = np.r_[:6000:60, 3995:4008]
    kernel = weight[chosen, None] * jv(0, np.multiply.outer(k[chosen], positions))
    h = np.zeros((chosen.size, k.size), complex)
    h[np.arange(chosen.size), chosen] = 1
    size = np.abs(kernel).max(axis=1, keepdims=True)
    assert np.max(np.abs(sums.at(h) - kernel) / size) < 1e-12  # k r is rounded to 3e-13
    own = np.exp(2j * v)[chosen]
    assert np.max(np.abs(sums.at((own @ h)[None]) - own @ kernel)) < 1e-12 * size.sum()
    norms = np.linalg.norm(kernel, axis=1)
    assert sums.strengths[chosen] / sums.strengths[chosen[50]] == pytest.approx(norms / norms[50], rel=0.1)


def test_sums_of_lommels_integral_in_parts():
    """What a table gives that is held, where it takes three parts."""
    q, k, h = np.linspace(0.1, 40, 700) - 0.1j, np.linspace(0, 39, 400), np.add.outer([0j, 1j], np.ones(700))
    in_parts = radial.LommelSums(q, k, 3.0, np.cos(q), np.exp(-k)).at(h)
    assert in_parts == pytest.approx(h @ (radial.lommel(q, k, 3.0, np.cos(q)) * np.exp(-k)), rel=1e-12, abs=1e-12)


def test_planes_behind_a_slab_are_formed_in_parts():
    """Each as by itself, within one and a half times what they are."""
    s, k, z = sample(LOSSY, FREQUENCY), np.linspace(0.1, 60, 3000) - 0.1j, np.linspace(1.2, 3, 100)
    tracemalloc.start()
    h = transfer_function.total_pressure(s, k, z, -0.1)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1.5 * h.nbytes + 4 * 2**20
    for i in (0, 15, 16, 99):
        own = transfer_function.total_pressure(s, k, z[i : i + 1], -0.1)[0]
        assert np.array_equal(h[i], own)


LOSSLESS, THIN_AIR = bp.Slab(bp.lmmd_cell(0.05, 0.0), 450), bp.Slab.uniform(bp.AIR, 0.5)
LARGE = {
    "4 m x 4 m": (LOSSLESS, bp.GaussianBeam(0.27, 45, z0=-0.1), ((30, 34, 60), (-2, 2, 60), 1.2), 1e-8, 1e-8),
    "of most radii": (LOSSLESS, bp.GaussianBeam(0.1, 80, z0=-0.1), ((41, 51, 100), (-0.5, 0.5, 100), 1.2), 1e-8, 1e-8),
    "of most plane waves": (
        THIN_AIR,
        bp.GaussianBeam(0.3, 80, z0=-0.1),
        ((41, 45, 300), (-1, 1, 300), 3.0),
        1e-10,
        1e-9,
    ),
}


@pytest.mark.parametrize(("slab", "beam", "places", "rtol", "error"), LARGE.values(), ids=LARGE)
def test_a_large_window_three_hundred_wavelengths_aside(slab, beam, places, rtol, error):
    """A plane that was refused once: its grid, series and contours, beside the answer, take less than 64 MiB."""
    x, y = (np.linspace(*of) for of in places[:2])
    tracemalloc.start()
    ds = bp.field(slab, beam, FREQUENCY, x, places[2], y=y, rtol=rtol)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert float(ds.error_estimate) < error
    assert peak - ds.p.nbytes < 64 * 2**20
