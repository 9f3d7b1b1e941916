"""Contours that pass above parts of the axis: half-spaces of backward waves, and lossless slabs of very many periods."""

import numpy as np
import pytest

import beamprop as bp
from beamprop.contour import stretches
from beamprop.response import sampled_slab

F = 4500.0
LAMBDA = 2 * np.pi / float(bp.AIR.wavenumber(F).real)
K0 = 2 * np.pi / LAMBDA
RHO, BULK = float(np.real(bp.AIR.density)), float(np.real(bp.AIR.bulk_modulus))
GAUSS = np.polynomial.legendre.leggauss(20)


def layer(rho, bulk, d, omega, k):
    """(n, 2, 2): the state (p, p'/rho) behind a layer from the one in front."""
    kz = np.sqrt(rho * (omega**2 / bulk - k**2 / rho) + 0j)
    c, s = np.cos(kz * d), np.sin(kz * d)
    return np.moveaxis(np.array([[c, rho * s / kz], [-kz * s / rho, c]]), -1, 0)


def real_axis_field(layers, periods, after, beam, x, z, edges):
    """p(x) behind a slab by Gauss panels on the real axis: right where no pole lies on it and S vanishes at its ends."""
    omega, half = 2 * np.pi * F, np.diff(edges) / 2
    k = ((edges[:-1] + half)[:, None] + half[:, None] * GAUSS[0]).ravel()
    weight = (half[:, None] * GAUSS[1]).ravel() / (2 * np.pi)

    def outgoing(rho, bulk):
        kz = np.sqrt(omega**2 * rho / bulk - k**2 + 0j)
        return np.where(kz.imag < 0, -kz, kz)

    kz1, kz2 = outgoing(RHO, BULK), outgoing(*after)
    cell = np.eye(2)
    for rho, bulk, d in layers:
        cell = layer(rho, bulk, d, omega, k) @ cell
    m = np.linalg.matrix_power(cell, periods)
    y1, y2 = 1j * kz1 / RHO, 1j * kz2 / after[0]
    t = 2 * y1 / (y2 * m[:, 0, 0] - m[:, 1, 0] + y1 * (m[:, 1, 1] - y2 * m[:, 0, 1]))
    thickness = periods * sum(d for _, _, d in layers)
    h = t * np.exp(-1j * kz1 * beam.z0 + 1j * kz2 * (z - thickness))
    a = beam.fwhm / (2 * np.sqrt(np.log(2)))
    S = a * np.sqrt(np.pi) * np.exp(-(((k - K0 * np.sin(np.radians(beam.angle))) * a / 2) ** 2))
    return np.exp(1j * np.outer(x, k)) @ (S * h * weight)


def panels(end, points):
    """Panels over -end < kx < end that shorten towards some |kx|."""
    near = np.geomspace(1e-12, 1, 60) * end
    graded = np.concatenate([p + side * near for p in points for side in (-1, 0, 1)])
    right = np.unique(np.clip(np.concatenate([graded, np.linspace(0, end, 1500)]), 0, end))
    return np.unique(np.concatenate([-right, right]))


LAYERS = [(1.7 * RHO, 0.6 * BULK, 0.13 * LAMBDA)]
SLIT = bp.GaussianBeam(0.4 * LAMBDA, 25.0, 0.0, -0.05 * LAMBDA)
X = np.linspace(-4, 4, 61) * LAMBDA


def behind_layers(after, x, z, rtol=1e-7):
    layers = [bp.Layer(bp.Fluid(rho, bulk), d) for rho, bulk, d in LAYERS]
    return bp.field(bp.Slab(layers, 1, after=bp.Fluid(*after)), SLIT, F, x, z, rtol=rtol)


#: Density and modulus over those of air, negative, and kx of the branch point over k0.
BACKWARD = {"slower": (1.5, 0.8), "faster": (0.7, 1.9), "matched": (2.0, 2.0)}


@pytest.mark.parametrize("name", BACKWARD)
@pytest.mark.parametrize("loss", [0.2, 1e-2])
def test_a_half_space_of_backward_waves_with_loss(name, loss):
    """The branch point lies below the axis, its cut leads downward; against a quadrature on the axis."""
    density, bulk = BACKWARD[name]
    after = -density * RHO * (1 - 1j * loss), -bulk * BULK * (1 + 1j * loss)
    z = LAYERS[0][2] + 0.2 * LAMBDA
    ds = behind_layers(after, X, [z])
    edges = panels(14 * K0, (K0, K0 * np.sqrt(density / bulk)))
    p = real_axis_field(LAYERS, 1, after, SLIT, X, z, edges)
    error = np.abs(ds.p.values.ravel() - p).max() / np.abs(p).max()
    assert error < 1e-7
    assert float(ds.error_estimate) < 1e-7


@pytest.mark.parametrize("name", BACKWARD)
def test_a_lossless_half_space_of_backward_waves_is_the_limit_of_small_loss(name):
    """p of no loss, 1e-7 and 2e-7 lie on a straight line; in front, inside and behind."""
    density, bulk = BACKWARD[name]
    z = np.array([-0.02, 0.06, 0.13, 0.5]) * LAMBDA
    none, one, two = (
        behind_layers((-density * RHO * (1 - 1j * loss), -bulk * BULK * (1 + 1j * loss)), X, z).p.values
        for loss in (0.0, 1e-7, 2e-7)
    )
    size = np.abs(none).max()
    assert 1e-10 < np.abs(one - none).max() / size < 1e-4
    assert np.abs(two - 2 * one + none).max() < 0.05 * np.abs(one - none).max()


def test_a_half_space_whose_waves_decay_backward():
    """Density negative and less lossy than the modulus: kx of the branch point is nearly imaginary, its real part negative."""
    after = -1.5 * RHO * (1 - 1e-5j), 0.8 * BULK * (1 - 1e-2j)
    if bp.Fluid(*after).wavenumber(F).real > 0:
        after = -1.5 * RHO * (1 - 1e-2j), 0.8 * BULK * (1 - 1e-5j)
    assert bp.Fluid(*after).wavenumber(F).real < 0
    z = LAYERS[0][2] + 0.1 * LAMBDA
    ds = behind_layers(after, X, [z])
    p = real_axis_field(LAYERS, 1, after, SLIT, X, z, panels(14 * K0, (K0,)))
    assert np.abs(ds.p.values.ravel() - p).max() < 1e-7 * np.abs(p).max()


def test_backward_waves_are_taken_behind_only():
    """In front no beam is launched into them; widths of many frequencies know contours below the axis alone."""
    fluid = bp.Fluid(-1.5 * RHO, -0.8 * BULK)
    layer = [bp.Layer(bp.AIR, 0.1 * LAMBDA)]
    assert np.all(np.isfinite(bp.field(bp.Slab(layer, 1, after=fluid), SLIT, F, X, [0.0]).p))
    with pytest.raises(ValueError, match="before: expected a half-space that carries forward waves"):
        bp.field(bp.Slab(layer, 1, before=fluid), SLIT, F, X, [0.0])
    with pytest.raises(ValueError, match="after: expected a half-space that carries forward waves"):
        bp.beam_width(bp.Slab(layer, 1, after=fluid), SLIT, F)


# --- very many periods ------------------------------------------------------------------------------------

PERIODS = 100_000


def test_narrow_beams_in_a_hundred_thousand_lossless_periods():
    """Evanescent waves meet the guided modes; p of no loss is the limit of small loss."""
    beam = bp.GaussianBeam(0.5 * LAMBDA, 20.0, 0.0, -0.05 * LAMBDA)
    z = np.array([-0.02, 0.0]) * LAMBDA
    none, little = (
        bp.field(bp.Slab(bp.lmmd_cell(0.05 + 1j * loss, loss, 10, 1 / 20), PERIODS), beam, F, X, z, rtol=1e-7)
        for loss in (0.0, 1e-11)
    )
    assert max(float(none.error_estimate), float(little.error_estimate)) < 1e-7
    assert np.abs(none.p.values - little.p.values).max() < 1e-6 * np.abs(none.p.values).max()


def test_bands_say_where_the_contour_passes():
    """Of layers of ordinary fluids all modes are forward ones: below everywhere. Of their negatives: above."""
    fluids = [bp.Fluid(RHO, BULK), bp.Fluid(3 * RHO, 0.4 * BULK)]
    for sign in (1, -1):
        layers = [bp.Layer(bp.Fluid(sign * v.density, sign * v.bulk_modulus), 0.1 * LAMBDA) for v in fluids]
        s = sampled_slab.sample(bp.Slab(layers, 50), F)
        bands = stretches.bands_of(s, 4 * K0)
        assert [part.side for part in bands.parts] == [-sign]
        assert bands.gaps[-1][1] == pytest.approx(4 * K0)


def test_a_contour_meets_the_axis_at_the_branch_points_on_its_other_side():
    """Above the axis k0 is met, below it that of backward waves; nodes stay on the side of their stretch."""
    slab = bp.Slab([bp.Layer(bp.AIR, 0.1 * LAMBDA)], 1, after=bp.Fluid(-2 * RHO, -BULK))
    s = sampled_slab.sample(slab, F, backward=True)
    back = K0 * np.sqrt(2)
    both = [stretches.met_at_branches(s, [stretches.Stretch(0.0, 3 * K0, side)]) for side in (-1, 1)]
    assert [p.lo for p in both[0]] == pytest.approx([0.0, back])
    assert [p.lo for p in both[1]] == pytest.approx([0.0, K0])
    plan = stretches.Plan(0.1 * K0, 0.05 * K0, 0.6, 2.5 * K0)
    for side, parts in zip((-1, 1), both, strict=True):
        line = stretches.stretched_contour(s, parts, plan, 1.0, 1.0)
        assert np.all(side * line.k.imag > 0)
        assert line.weight.sum() == pytest.approx((2.5 * K0 + 1j * line.k.imag[-1]) / (2 * np.pi), rel=1e-6)
        assert np.abs(line.k - parts[1].lo).min() < 1e-9 * K0
