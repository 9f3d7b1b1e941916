"""Beams that repeat on a rectangular lattice: an explicit double sum, open fields of the images, limits and refusals."""

import numpy as np
import pytest
from accuracy_study.reference.medium import Medium
from space_oracles import Gaussian

import beamprop as bp

F = 2500.0
LOSSY = bp.Slab(bp.lmmd_cell(), 45)
BEAM = bp.GaussianBeam((0.2, 0.1), 20, 0.03, -0.05, azimuth=30.0, y0=-0.02)
X, Y, Z = np.array([-0.7, 0.0, 0.02, 0.9]), np.array([-0.4, 0.1, 1.3]), np.array([-0.05, 0.03, 0.2])
PERIOD = (1.7, 1.1)


def double_sum(slab, beam, x, y, z, period, count=90):
    """p (Z, Y, X): S h exp(i kx x + i ky y)/(Lx Ly) at every (2 pi m/Lx, 2 pi n/Ly)."""
    medium = Medium(slab, F)
    source = Gaussian(beam, medium.k0)
    m = np.arange(-count, count + 1)
    kx, ky = (2 * np.pi * m / length for length in period)
    u, v = np.meshgrid(kx, ky)
    h = medium.response(np.hypot(u, v).ravel() + 0j, z, beam.z0).reshape(len(z), *u.shape)
    along_x, along_y = np.exp(1j * np.outer(kx, x - beam.x0)), np.exp(1j * np.outer(y - beam.y0, ky))
    return np.stack([along_y @ (source.spectrum(u, v) * one) @ along_x for one in h]) / np.prod(period)


def worst(a, b):
    """The largest difference over the largest |b|."""
    return np.max(np.abs(a - b)) / np.max(np.abs(b))


@pytest.mark.parametrize("period", [PERIOD, (1.5, 1.5)])
def test_an_explicit_double_sum(period):
    p = bp.field(LOSSY, BEAM, F, X, Z, y=Y, boundary="periodic", period=period).p.values
    assert worst(p, double_sum(LOSSY, BEAM, X, Y, Z, period)) < 1e-12


@pytest.mark.parametrize("shape", ["cut", "volume"])
def test_by_rows_and_at_low_rank(shape):
    """Many planes: of one y each row is summed, and a volume is made of chosen planes."""
    z = bp.faces(LOSSY, 45, after=0.6)
    z = np.linspace(0.11, 0.6, 210) if shape == "volume" else z
    y = np.linspace(-0.5, 0.5, 9) if shape == "volume" else 0.1
    x = np.linspace(-0.8, 0.8, 9)
    ds = bp.field(LOSSY, BEAM, F, x, z, y=y, boundary="periodic", period=PERIOD)
    some = slice(3, None, 17 if shape == "cut" else 69)
    reference = double_sum(LOSSY, BEAM, x, np.atleast_1d(y), z[some], PERIOD, count=60)
    assert worst(ds.p.values[some].reshape(reference.shape), reference) < 1e-9
    assert "error_estimate" not in ds


FOG = bp.Fluid.from_speed(1.2, 343 * (1 - 0.06j))
FOGGY = bp.Slab.uniform(FOG, 0.1, background=FOG)  # in which few neighbours are heard


def images(beam, x, y, z, lengths, counts):
    """The sum of open fields at positions moved by up to so many periods along x and along y: (Z, Y, X)."""
    shifts = [np.arange(-n, n + 1) for n in counts]
    u, v = ((at[:, None] + length * m).ravel() for at, length, m in zip((x, y), lengths, shifts, strict=True))
    p = bp.field(FOGGY, beam, F, u, z, y=v, rtol=1e-10).p.values
    return p.reshape(z.size, y.size, shifts[1].size, x.size, shifts[0].size).sum(axis=(2, 4))


def test_images_of_open_fields():
    beam, z = bp.GaussianBeam((0.2, 0.15), 10, z0=-0.05, azimuth=60.0), np.array([0.0, 0.1])
    x, y = np.linspace(-0.4, 0.4, 5), np.linspace(-0.3, 0.3, 4)
    p = bp.field(FOGGY, beam, F, x, z, y=y, boundary="periodic", period=(1.0, 0.8)).p.values
    assert worst(p, images(beam, x, y, z, (1.0, 0.8), (5, 5))) < 1e-6


def test_a_long_period_along_y_is_a_row_of_beams_in_open_space():
    beam, z = bp.GaussianBeam((0.2, 0.1), z0=-0.05), np.array([0.0, 0.1])
    x, y = np.linspace(-0.1, 0.1, 3), np.array([0.0, 0.1])
    row = images(beam, x, y, z, (1.0, 1.0), (5, 0))
    near, far = (
        worst(bp.field(FOGGY, beam, F, x, z, y=y, boundary="periodic", period=(1.0, length)).p.values, row)
        for length in (1.0, 8.0)
    )
    assert far < 1e-6 < 1e-2 * near


def test_the_default_period_is_that_of_the_grid():
    x, y = np.linspace(-1, 1, 40, endpoint=False), np.linspace(-0.5, 0.5, 25, endpoint=False)
    ds = bp.field(LOSSY, BEAM, F, x, 0.1, y=y, boundary="periodic")
    assert ds.attrs["period"] == pytest.approx((2.0, 1.0))
    assert ds.p.equals(bp.field(LOSSY, BEAM, F, x, 0.1, y=y, boundary="periodic", period=ds.attrs["period"]).p)
    assert bp.provenance(ds)["period"] == ds.attrs["period"]


def test_a_piston_takes_the_waves_that_reach_a_plane():
    """Its spectrum does not end; nearer planes take more of it, and its own is refused."""
    piston, x = bp.Piston(0.1, z0=-0.05), np.array([0.0, 0.2])
    far = bp.field(LOSSY, piston, F, x, 0.1, y=[0.0, 0.1], boundary="periodic", period=(1.0, 1.0)).p
    both = bp.field(LOSSY, piston, F, x, [-0.02, 0.1], y=[0.0, 0.1], boundary="periodic", period=(1.0, 1.0)).p
    assert worst(both.values[1], far.values) < 1e-12
    with pytest.raises(ValueError, match=r"^period: expected at most 4e\+06 plane waves of a lattice, got inf"):
        bp.field(LOSSY, piston, F, x, piston.z0, y=0.0, boundary="periodic", period=(1.0, 1.0))


def test_an_order_next_to_a_guided_mode_has_no_limit():
    """The plain sum has a pole where an order meets a mode of a slab without loss: p goes as one over the distance."""
    plate = bp.Slab.uniform(bp.Fluid(1.2, 4e4), 0.02)
    modes = bp.guided_modes(plate, F)
    kx = float(modes.kx.values[0].real)
    beam = bp.GaussianBeam(0.1, z0=-0.05)

    def p(apart):
        period = 10 * 2 * np.pi / (kx * (1 + apart))
        return bp.field(plate, beam, F, 0.0, 0.1, y=0.0, boundary="periodic", period=(period, 1.0)).p.item()

    near, far = (p(apart) - p(-apart) for apart in (1e-6, 1e-5))
    assert near / far == pytest.approx(10, rel=1e-3)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"period": 2.0}, r"period: expected two lengths \(Lx, Ly\) \[m\] where y is given, got 2.0"),
        ({"period": (2.0, -1.0)}, "period: expected"),
        ({"period": (2.0, 1.0, 1.0)}, "period: expected two lengths"),
        ({"period": (2.0, 0.1)}, r"period: expected a grid wide enough for the beam, got 0.1 m along y"),
        ({"y": 0.0}, "period: expected two lengths .* and an uneven x or y, got None"),
        ({"period": (1e4, 1e4)}, r"period: expected at most 4e\+06 plane waves of a lattice"),
    ],
)
def test_refusals(changes, message):
    asked = {"slab": LOSSY, "beam": BEAM, "frequency": F, "x": X, "z": 0.1, "y": Y, "boundary": "periodic"} | changes
    with pytest.raises(ValueError, match=f"^{message}"):
        bp.field(**asked)
