"""The package against the independent implementations of oracles.py."""

import warnings

import mpmath as mp
import numpy as np
import oracles
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import beamprop as bp

K0 = 2 * np.pi * 2500 / 343
AIR = (bp.AIR.density, bp.AIR.bulk_modulus)
FLUIDS = [
    bp.AIR,
    bp.Fluid.from_speed(1000.0, 1480.0),
    bp.Fluid.from_speed(0.18, 972.0),
    bp.Fluid(1.9 + 0.2j, 9e4 - 2e3j),
]


def layers_of(cell):
    return [(layer.fluid.density, layer.fluid.bulk_modulus, layer.thickness) for layer in cell.layers]


def nudged(layers):
    """The same cell after a change of the last bit of every number, up and down in turn."""

    def bump(value, way):
        return complex(np.nextafter(value.real, way * np.inf), value.imag)

    return [
        (bump(rho, 1 - 2 * (j % 2)), bump(K, -1 + 2 * (j % 2)), float(np.nextafter(d, 0)))
        for j, (rho, K, d) in enumerate(layers)
    ]


slabs = st.fixed_dictionaries(
    {
        "n_layers": st.integers(1, 16),
        "eta": st.floats(1 / 100, 1 / 20),
        "loss": st.one_of(st.just(0.0), st.floats(0, 0.5)),
        "rho_m": st.floats(-0.5, 2.0).map(lambda v: 0.0 if abs(v) < 1e-40 else v),  # the range that is computed with
        "periods": st.integers(1, 5000),
        "ratio": st.one_of(st.floats(0, 1), st.floats(1, 10)),
        "frequency": st.floats(1500, 4000),
        "before": st.integers(0, 2),
        "after": st.integers(0, 3),
    }
)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(slabs)
def test_r_and_t_against_fifty_digits(case):
    cell = bp.lmmd_cell(case["rho_m"] + 1j * case["loss"], case["loss"] / 2, case["n_layers"], case["eta"])
    assume(all(rho != 0 for rho, _, _ in layers_of(cell)))  # density 0 has tests of its own
    before, after = FLUIDS[case["before"]], FLUIDS[case["after"]]
    slab = bp.Slab(cell, case["periods"], before, after)
    kx = case["ratio"] * 2 * np.pi * case["frequency"] / 343
    f = case["frequency"]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", bp.AccuracyWarning)  # what is ill-conditioned is allowed for below
        ds = bp.scattering(slab, f, kx=kx)
    ends = [(v.density, v.bulk_modulus) for v in (before, after)]
    r, t = oracles.slab_response(layers_of(cell), case["periods"], *ends, f, kx)
    others = [oracles.slab_response(nudged(layers_of(cell)), case["periods"], *ends, f, kx)]
    others += [
        oracles.slab_response(layers_of(cell), case["periods"], *ends, f, np.nextafter(kx, way)) for way in (0, np.inf)
    ]
    for i, (got, want) in enumerate(((ds.r.item(), r), (ds.t.item(), t))):
        if abs(want) > 1e-250:
            allowed = max(1e-9, *(100 * float(abs((other[i] - want) / want)) for other in others))
            error = float(abs((mp.mpmathify(got) - want) / want))
            assert error < allowed
            if i and case["ratio"] != 1:  # there grazing incidence itself is meant, not kx to its last bit
                assert error < 3 * ds.t_error_estimate
        else:
            assert abs(got) < 1e-249


@pytest.mark.parametrize("periods", [20, 40, 80, 100])
@pytest.mark.parametrize("loss", [0.005, 0.05, 0.5])
def test_effective_slab_is_equation_11(periods, loss):
    cell = bp.lmmd_cell(0.05 + 1j * loss, loss / 2)
    slab = bp.Slab(cell, periods)
    fluid = bp.lmmd_emt(cell)
    rho_eff = complex(fluid.at(2500.0).rho_z) / 1.25
    ratio = np.concatenate([np.linspace(0, 0.999, 50), np.linspace(1.01, 8, 50)])
    ds = bp.scattering(bp.lmmd_emt_slab(slab, interface=False), 2500.0, kx_over_k0=ratio)
    want = oracles.emt_transmissivity(rho_eff, slab.thickness, K0, ratio * K0)
    np.testing.assert_allclose(ds.transmissivity, want, rtol=1e-10)


def test_effective_density_of_the_staircase_is_equation_9():
    """S = 2 sum |b_n|^2/n^2 over the Fourier coefficients of the staircase, summed one by one."""
    n = np.arange(1, 20001)
    for layers in (6, 10, 14):
        steps = np.cos(2 * np.pi * np.arange(layers) / layers)
        b = sum(
            c * (np.exp(-2j * np.pi * n * (j + 1) / layers) - np.exp(-2j * np.pi * n * j / layers))
            for j, c in enumerate(steps)
        ) / (-2j * np.pi * n)
        S = 2 * np.sum(np.abs(b) ** 2 / n**2)
        rho = complex(bp.lmmd_emt(bp.lmmd_cell(0.05, 0.0, layers)).at(2500.0).rho_z) / 1.25
        assert rho == pytest.approx(0.05 + S, abs=1e-9)


def gaussian(width, angle, k0):
    a = width / (2 * np.sqrt(np.log(2)))
    return lambda kx: a * np.sqrt(np.pi) * np.exp(-((a * (kx - k0 * np.sin(np.deg2rad(angle))) / 2) ** 2))


X = np.concatenate([np.linspace(-0.5, 0.6, 41), [-0.9, 1.3]])


@pytest.mark.parametrize("angle", [0.0, 45.0, 85.0])
@pytest.mark.parametrize("lossless", [True, False])
def test_open_fields_against_a_bent_contour(lossless, angle):
    cell = bp.lmmd_cell(0.05, 0.0) if lossless else bp.lmmd_cell()
    slab = bp.Slab(cell, 450)
    z = np.array([-0.1, -0.03, 0.0, 0.00031, 0.2571, 0.9, slab.thickness, 1.2])
    got = bp.field(slab, bp.GaussianBeam(0.096, angle, z0=-0.1), 2500.0, X, z, rtol=1e-10)
    beam = gaussian(0.096, angle, K0)
    want = oracles.open_field(slab, 2500.0, beam, -0.1, X, z)
    again = oracles.open_field(slab, 2500.0, beam, -0.1, X, z, bend=4.0, count=3501)
    assert np.abs(again - want).max() < 1e-10  # the witness agrees with itself on another contour
    largest = np.abs(want).max(axis=1, keepdims=True)
    assert np.max(np.abs(got.p.values - want) / largest) < 1e-8


def test_water_behind_and_another_medium():
    """Off the paper's parameters: N = 6, eta = 1/35, lossless, two different half-spaces, an offset narrow beam."""
    cell = bp.lmmd_cell(0.2, 0.0, 6, 1 / 35)
    water = bp.Fluid.from_speed(1000.0, 1480.0)
    slab = bp.Slab(cell, 60, after=water)
    z = np.array([-0.05, 0.0, 0.1, slab.thickness, slab.thickness + 0.3])
    x = np.linspace(-0.4, 0.6, 31)
    f = 2200.0
    k0 = 2 * np.pi * f / 343
    shifted = gaussian(0.05, 20.0, k0)
    want = oracles.open_field(
        slab,
        f,
        lambda k: shifted(k) * np.exp(-1j * k * 0.1),
        -0.05,
        x,
        z,
        bend=2.0,
        band=420.0,
        count=6001,
    )
    got = bp.field(slab, bp.GaussianBeam(0.05, 20.0, x0=0.1, z0=-0.05), f, x, z, rtol=1e-9)
    assert np.max(np.abs(got.p.values - want) / np.abs(want).max(axis=1, keepdims=True)) < 1e-8


def test_air_diffraction_is_the_same_function():
    """A slab of air against the plane waves of air alone."""
    two = 2 * 343 / 2000
    air = bp.Slab.uniform(bp.AIR, two)
    x = np.linspace(-0.8, 0.8, 33)
    got = bp.field(air, bp.GaussianBeam(0.096), 2000.0, x, np.array([two / 3, two]))
    k0 = 2 * np.pi * 2000 / 343
    want = oracles.air_beam(gaussian(0.096, 0, k0), k0, x, [two / 3, two])
    np.testing.assert_allclose(got.p.values, want, atol=2e-8 * np.abs(want).max())


def half_width(evaluate, hi=0.3):
    """Full width by bisection on a symmetric |p|."""
    peak = abs(evaluate(0.0))
    lo, hi = 0.0, hi
    for _ in range(60):
        mid = (lo + hi) / 2
        lo, hi = (mid, hi) if abs(evaluate(mid)) > peak / 2 else (lo, mid)
    return lo + hi


@pytest.mark.parametrize(("lossless", "frequency"), [(True, 2400.0), (True, 2000.0), (False, 2500.0)])
def test_widths_against_bisection_on_the_oracle(lossless, frequency):
    cell = bp.lmmd_cell(0.05, 0.0) if lossless else bp.lmmd_cell()
    slab = bp.Slab(cell, 450)
    k0 = 2 * np.pi * frequency / 343

    def on_axis(x):
        return oracles.open_field(slab, frequency, gaussian(0.096, 0, k0), 0.0, [x], [slab.thickness], count=1501)[0, 0]

    ds = bp.beam_width(slab, bp.GaussianBeam(0.096), frequency, rtol=1e-9)
    air = half_width(lambda x: oracles.air_beam(gaussian(0.096, 0, k0), k0, [x], [2 * 343 / frequency])[0, 0], 0.5)
    assert ds.fwhm_air.item() == pytest.approx(air, abs=2e-9)
    assert ds.fwhm_out.item() == pytest.approx(half_width(on_axis), abs=2e-9)
