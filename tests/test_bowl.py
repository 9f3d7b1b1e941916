"""Bowls: O'Neil's closed form on the axis, Rayleigh's integral over the bowl beside it, and through a plate by an independent quadrature."""

import numpy as np
import pytest
from accuracy_study.reference.medium import Medium
from scipy.special import jv
from space_oracles import straight_bend

import beamprop as bp

WATER = bp.Fluid.from_speed(1000.0, 1500.0)
NOTHING = bp.Slab.uniform(WATER, 0.001, background=WATER)
FREQUENCY, Z0 = 0.2e6, -0.05
K = 2 * np.pi * FREQUENCY / 1500.0
#: Shallow, deep and a hemisphere: radius of curvature and aperture.
SHAPES = {"shallow": (0.064, 0.03), "deep": (0.04, 0.05), "hemisphere": (0.03, 0.06)}


def depth(radius, aperture):
    return radius - np.sqrt(radius**2 - aperture**2 / 4)


@pytest.mark.parametrize("rtol", [1e-4, 1e-8])
@pytest.mark.parametrize("shape", SHAPES)
def test_on_the_axis(shape, rtol):
    """p = (exp(ikz) - exp(ikB)) R/(R - z), z from the apex and B from the rim (O'Neil, J. Acoust. Soc. Am. 21, 516 (1949))."""
    radius, aperture = SHAPES[shape]
    source = bp.Bowl(radius, aperture, 2j, z0=Z0)
    assert source.depth == pytest.approx(depth(radius, aperture), rel=1e-12)
    z = np.array([source.depth + 0.008, radius - 0.004, radius, 0.09, 0.2])
    z = z[z > source.depth + 0.004]
    with np.errstate(invalid="ignore", divide="ignore"):
        known = (np.exp(1j * K * z) - np.exp(1j * K * np.hypot(z - source.depth, aperture / 2))) * radius / (radius - z)
    known[z == radius] = -1j * K * source.depth * np.exp(1j * K * radius)
    ds = bp.field(NOTHING, source, FREQUENCY, 0.0, z + Z0, y=0.0, rtol=rtol)
    assert np.max(np.abs(ds.p.values - 2j * known) / np.abs(2 * known)) < rtol
    assert float(ds.error_estimate) < rtol


def surface(radius, aperture, count=120):
    """Points of the bowl (x, y, depth) and their areas: Gauss nodes along its meridian, the trapezoid rule around."""
    g, w = np.polynomial.legendre.leggauss(count)
    opening = np.arcsin(aperture / 2 / radius)
    t = opening * (g + 1) / 2
    turn = 2 * np.pi * np.arange(3 * count) / (3 * count)
    areas = np.repeat(opening * w / 2 * radius**2 * np.sin(t) * 2 * np.pi / turn.size, turn.size)
    x, y = (np.multiply.outer(radius * np.sin(t), v(turn)).ravel() for v in (np.cos, np.sin))
    return x, y, np.repeat(radius * (1 - np.cos(t)), turn.size), areas


@pytest.mark.parametrize("shape", SHAPES)
def test_beside_the_axis(shape):
    source = bp.Bowl(*SHAPES[shape], x0=0.003, z0=Z0)
    u, v, d, areas = surface(*SHAPES[shape])
    x, y, z = np.array([-0.03, 0.004, 0.012]), np.array([0.0, 0.02]), np.array([-0.005, 0.0, 0.05])
    known = np.empty((z.size, y.size, x.size), complex)
    for i in np.ndindex(known.shape):
        r = np.sqrt((x[i[2]] - 0.003 - u) ** 2 + (y[i[1]] - v) ** 2 + (z[i[0]] - Z0 - d) ** 2)
        known[i] = -1j * K / (2 * np.pi) * np.sum(areas * np.exp(1j * K * r) / r)
    p = bp.field(NOTHING, source, FREQUENCY, x, z, y=y, rtol=1e-8).p.values
    assert np.max(np.abs(p - known).max(axis=(1, 2)) / np.abs(known).max(axis=(1, 2))) < 1e-8


def test_through_a_plate():
    """Every ring of the bowl launched from a plane of its own, at complex wavenumbers."""
    plate = bp.Slab.uniform(bp.Fluid.from_speed(1900.0, 2800.0), 0.0065, background=WATER)
    radius, aperture = SHAPES["deep"]
    x, z = np.array([0.0, 0.005, 0.02]), np.array([0.003, 0.0065, 0.03])
    ds = bp.field(plate, bp.Bowl(radius, aperture, z0=Z0), FREQUENCY, x, z, y=0.004, rtol=1e-8)
    medium = Medium(plate, FREQUENCY)
    k, w = straight_bend(2500.0, 20.0, 0.5 * K, 120)
    g, v = np.polynomial.legendre.leggauss(60)
    opening = np.arcsin(aperture / 2 / radius)
    known = 0
    for t, area in zip(opening * (g + 1) / 2, opening * v / 2 * radius**2, strict=True):
        h = medium.response(k, z, Z0 + radius * (1 - np.cos(t))) * (K / np.sqrt(K - k) / np.sqrt(K + k))
        ring = area * np.sin(t) * jv(0, k * radius * np.sin(t)) * k * w
        known = known + h @ (ring[:, None] * jv(0, np.multiply.outer(k, np.hypot(x, 0.004))))
    assert np.max(np.abs(ds.p.values - known).max(axis=1) / np.abs(known).max(axis=1)) < 1e-8
    assert float(ds.error_estimate) < 1e-8


def test_a_flat_bowl_is_a_piston():
    flat = bp.field(NOTHING, bp.Bowl(1e4, 0.02, z0=Z0), FREQUENCY, 0.004, [0.0, 0.1], y=0.0).p.values
    piston = bp.field(NOTHING, bp.Piston(0.01, z0=Z0), FREQUENCY, 0.004, [0.0, 0.1], y=0.0).p.values
    assert flat == pytest.approx(piston, rel=1e-5)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"aperture": 0.0}, "aperture: expected"),
        ({"aperture": 0.13}, r"aperture: expected at most twice the radius_of_curvature, 0\.128, got 0\.13"),
        ({"radius_of_curvature": -1.0}, "radius_of_curvature: expected"),
        ({"pressure": np.inf}, "pressure: expected a finite number"),
        ({"z0": -0.001}, r"z0: expected a rim in front of the slab, z0 <= -0\.0085"),
    ],
)
def test_arguments_are_checked(given, message):
    with pytest.raises(ValueError, match=f"^{message}"):
        bp.Bowl(**({"radius_of_curvature": 0.064, "aperture": 0.064, "z0": Z0} | given))


def test_what_a_bowl_is_not_asked():
    source = bp.Bowl(0.064, 0.064, z0=Z0)
    for z in (Z0, Z0 + source.depth):
        with pytest.raises(
            ValueError, match=r"^z: expected positions behind the launch plane z0 = -0\.041.* sharp edge"
        ):
            bp.field(NOTHING, source, FREQUENCY, 0.0, z, y=0.0)
    with pytest.raises(ValueError, match=r"^angle: expected 0 with a Bowl"):
        bp.field(NOTHING, source, FREQUENCY, 0.0, 0.1, angle=10.0, y=0.0)
    with pytest.raises(ValueError, match=r"^beam: expected one on which nothing depends on y"):
        bp.field(NOTHING, source, FREQUENCY, 0.0, 0.1)


def test_files_bring_it_back(tmp_path):
    source = bp.Bowl(0.064, 0.064, 1 + 2j, z0=Z0)
    bp.save(bp.field(NOTHING, source, FREQUENCY, 0.0, [0.02, 0.1], y=0.0, rtol=1e-4), tmp_path / "p.nc")
    assert bp.provenance(bp.load(tmp_path / "p.nc"))["beam"] == source


def test_a_lattice_is_made_wider_where_the_spectrum_has_no_end():
    """In one fluid, where the first lattice does not keep a low rtol far beside the axis: O'Neil's closed form in the middle."""
    source, x = bp.Bowl(0.064, 0.064, z0=-0.03), np.linspace(-0.03, 0.03, 101)
    z, k = 0.06, 2 * np.pi * 0.5e6 / 1500.0
    p = bp.field(NOTHING, source, 0.5e6, x, z - 0.03, y=0.0, rtol=1e-9).p.values
    known = (np.exp(1j * k * z) - np.exp(1j * k * np.hypot(z - source.depth, 0.032))) * 0.064 / (0.064 - z)
    assert abs(p[50] - known) < 1e-9 * abs(known)
