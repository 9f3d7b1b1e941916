"""Circular pistons: closed forms on the axis, Rayleigh's integrals beside it, and through a plate by an independent quadrature."""

import numpy as np
import pytest
from accuracy_study.reference.medium import Medium
from scipy.special import jv
from space_oracles import straight_bend

import beamprop as bp

WATER = bp.Fluid.from_speed(1000.0, 1500.0)
FREQUENCY, RADIUS, Z0 = 0.5e6, 0.01, -0.01
K = 2 * np.pi * FREQUENCY / 1500.0
NOTHING = bp.Slab.uniform(WATER, 0.001, background=WATER)
Z = np.array([-0.002, 0.012, 0.03, 0.1])


def piston(baffle, **more):
    return bp.Piston(RADIUS, baffle, z0=Z0, **more)


@pytest.mark.parametrize("baffle", ["rigid", "soft"])
@pytest.mark.parametrize("rtol", [1e-4, 1e-8])
def test_on_the_axis(baffle, rtol):
    """p is exp(ikz) less exp(ikR), in a soft baffle times z/R (Pierce, Acoustics, 1989, section 5.7)."""
    ds = bp.field(NOTHING, piston(baffle), FREQUENCY, 0.0, Z, y=0.0, rtol=rtol)
    d = Z - Z0
    r = np.hypot(d, RADIUS)
    known = np.exp(1j * K * d) - (d / r if baffle == "soft" else 1) * np.exp(1j * K * r)
    assert np.max(np.abs(ds.p.values - known) / np.abs(known)) < rtol
    assert float(ds.error_estimate) < rtol


def rayleigh(baffle, x, y, z, count=160):
    """Rayleigh's integrals over the disc: Gauss nodes along the radius, the trapezoid rule around."""
    g, w = np.polynomial.legendre.leggauss(count)
    s, ds = RADIUS * (g + 1) / 2, RADIUS * w / 2
    turn = 2 * np.pi * np.arange(3 * count) / (3 * count)
    u, v = np.multiply.outer(s, np.cos(turn)), np.multiply.outer(s, np.sin(turn))
    r = np.sqrt((x - u) ** 2 + (y - v) ** 2 + (z - Z0) ** 2)
    each = -1j * K if baffle == "rigid" else (z - Z0) / r * (1 / r - 1j * K)
    return np.sum(each * np.exp(1j * K * r) / r * (s * ds)[:, None]) / (3 * count)


@pytest.mark.parametrize("baffle", ["rigid", "soft"])
def test_beside_the_axis(baffle):
    x, y, z = np.array([-0.03, 0.004, 0.01]), np.array([0.0, 0.02]), np.array([0.012, 0.1])
    p = bp.field(NOTHING, piston(baffle, pressure=2j), FREQUENCY, x, z, y=y, rtol=1e-9).p.values
    known = np.array([[[2j * rayleigh(baffle, a, b, c) for a in x] for b in y] for c in z])
    assert np.max(np.abs(p - known)) < 1e-9 * np.abs(known).max()


@pytest.mark.parametrize("baffle", ["rigid", "soft"])
def test_through_a_plate(baffle):
    plate = bp.Slab.uniform(bp.Fluid.from_speed(1900.0, 2800.0), 0.0065, background=WATER)
    x, z = np.array([0.0, 0.005, -0.03]), np.array([0.003, 0.02, 0.1])
    source = piston(baffle, x0=0.002, y0=-0.001)
    ds = bp.field(plate, source, FREQUENCY, x, z, y=0.004, rtol=1e-8)
    medium = Medium(plate, FREQUENCY)
    k, w = straight_bend(9000.0, 60.0, 0.5 * K, 120)
    h = medium.response(k, z, Z0) * (K / np.sqrt(K - k) / np.sqrt(K + k) if baffle == "rigid" else 1)
    r = np.hypot(x - 0.002, 0.005)
    known = h @ ((RADIUS * jv(1, k * RADIUS) * w)[:, None] * jv(0, np.multiply.outer(k, r)))
    assert np.max(np.abs(ds.p.values - known).max(axis=1) / np.abs(known).max(axis=1)) < 1e-8
    assert float(ds.error_estimate) < 1e-8


def test_a_sharp_edge_on_its_own_plane_is_refused():
    for z in (Z0, [Z0, 0.0]):
        with pytest.raises(
            ValueError, match=r"^z: expected positions behind the launch plane z0 = -0\.01 .* sharp edge"
        ):
            bp.field(NOTHING, piston("soft"), FREQUENCY, 0.0, z, y=0.0)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"radius": 0.0}, "radius: expected"),
        ({"radius": 0.1, "baffle": "hard"}, "baffle: expected 'rigid' or 'soft'"),
        ({"radius": 0.1, "pressure": np.nan}, "pressure: expected a finite number"),
        ({"radius": 0.1, "pressure": 0.0}, "pressure: expected a finite number"),
        ({"radius": 0.1, "z0": 0.1}, "z0: expected a plane in front"),
        ({"radius": 0.1, "y0": "left"}, "y0: expected"),
    ],
)
def test_arguments_are_checked(given, message):
    with pytest.raises(ValueError, match=f"^{message}"):
        bp.Piston(**given)


def test_what_a_piston_is_not_asked():
    with pytest.raises(ValueError, match=r"^beam: expected one on which nothing depends on y.*Piston"):
        bp.field(NOTHING, piston("soft"), FREQUENCY, 0.0, 0.1)
    with pytest.raises(ValueError, match=r"^angle: expected 0 with a Piston"):
        bp.field(NOTHING, piston("soft"), FREQUENCY, 0.0, 0.1, angle=10.0, y=0.0)


def test_files_bring_it_back(tmp_path):
    ds = bp.field(NOTHING, piston("soft", pressure=1 + 2j), FREQUENCY, 0.0, [0.02, 0.1], y=0.0, rtol=1e-4)
    bp.save(ds, tmp_path / "p.nc")
    assert bp.provenance(bp.load(tmp_path / "p.nc"))["beam"] == piston("soft", pressure=1 + 2j)
