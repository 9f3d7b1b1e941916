"""`tolerance`: random copies of a slab."""

import itertools
import math
import pickle
import re
import tracemalloc

import numpy as np
import oracles
import pytest
import tolerance as benchmark
from scipy.interpolate import CubicSpline
from scipy.stats import truncnorm

import beamprop as bp
from beamprop.api.widths_of import widths_of
from beamprop.media.tolerance import CUT, LAYER

SLAB = bp.Slab(bp.lmmd_cell(), periods=20)
BEAM = bp.GaussianBeam(0.096)


def layers_of(slab):
    """All layers from the near face on."""
    return [layer for cell, periods in slab.segments for _ in range(periods) for layer in cell.layers]


def ratios(copy, slab):
    """Thicknesses and densities over those of the slab."""
    pairs = list(zip(layers_of(copy), layers_of(slab), strict=True))
    thickness = np.array([new.thickness / old.thickness for new, old in pairs])
    return thickness, np.array([new.fluid.density / old.fluid.density for new, old in pairs if old.fluid.density])


def test_errors_are_gaussian():
    """Mean, standard deviation, quartiles and independence of 40 000 errors, within four standard errors."""
    copies = bp.tolerance(SLAB, thickness=0.02, density=0.1, count=200, seed=5)
    thickness, density = (np.concatenate(v) for v in zip(*(ratios(copy, SLAB) for copy in copies), strict=True))
    assert np.abs(density.imag).max() < 1e-15
    for sample, sigma in ((thickness, 0.02), (density.real, 0.1)):
        g = (sample - 1) / sigma
        n = math.sqrt(g.size)
        assert abs(g.mean()) < 4 / n
        assert abs(g.std() - 1) < 4 / (math.sqrt(2) * n)
        assert abs(np.mean(np.abs(g) < 0.67449) - 0.5) < 4 * 0.5 / n
        assert np.abs(g).max() <= CUT
        assert abs(np.mean(g[1:] * g[:-1])) < 4 / n


def test_every_layer_differs():
    copy = bp.tolerance(SLAB, thickness=0.02, density=0.02)[0]
    layers = layers_of(copy)
    assert len({layer.thickness for layer in layers}) == len(layers) == 200
    assert len({layer.fluid.density for layer in layers if layer.fluid.density}) == 200
    assert {layer.fluid.bulk_modulus for layer in layers} == {bp.AIR.bulk_modulus}
    assert copy.before is SLAB.before
    assert copy.periods == 1


def test_only_what_is_given_changes():
    thin, heavy = bp.tolerance(SLAB, thickness=0.1)[3], bp.tolerance(SLAB, density=0.1)[3]
    both = bp.tolerance(SLAB, thickness=0.1, density=0.1)[3]
    assert [layer.fluid for layer in layers_of(thin)] == [layer.fluid for layer in layers_of(SLAB)]
    assert np.array_equal(ratios(heavy, SLAB)[0], np.ones(200))
    assert np.array_equal(ratios(both, SLAB)[0], ratios(thin, SLAB)[0])
    assert np.array_equal(ratios(both, SLAB)[1], ratios(heavy, SLAB)[1])
    assert layers_of(bp.tolerance(SLAB)[0]) == layers_of(SLAB)


def test_a_copy_depends_on_seed_and_index_alone():
    few, many = (bp.tolerance(SLAB, 0.02, 0.02, count=n, seed=7) for n in (5, 50))
    assert many[4] == few[4] == few[-1] == list(few)[4]
    assert len({copy.segments for copy in itertools.islice(many, 10)}) == 10
    assert bp.tolerance(SLAB, 0.02, 0.02, seed=8)[4] != few[4]
    assert few[4].segments == bp.tolerance(SLAB, 0.02, 0.02, count=5, seed=np.int64(7))[np.int64(4)].segments


def test_the_draw_stays_the_same():
    """The numbers by their definition: a uniform number for each layer through the inverse of the cut-off normal distribution."""
    uniform = np.random.Generator(np.random.PCG64([7, 4])).random((2, 200))
    want = 1 + 0.02 * truncnorm.ppf(uniform, -CUT, CUT)
    assert np.allclose(ratios(bp.tolerance(SLAB, 0.02, 0.02, seed=7)[4], SLAB)[0], want[0], rtol=1e-13)


@pytest.mark.parametrize("sigma", [0.2499, 0.1])
def test_signs_and_passivity_are_kept(sigma):
    fluids = [
        bp.Fluid(-1 + 0.3j, 1e5 - 2e3j, density_x=2.0),
        bp.Fluid(0.0, 1e5),
        bp.Fluid(1.0, -1e5, density_x=np.inf),
        bp.Fluid(1 - 0.1j, 1e5, active=True),
        bp.Fluid(lambda f: 2 + 500j / f, 1e5),
    ]
    slab = bp.Slab([*(bp.Layer(fluid, 0.01) for fluid in fluids), bp.Membrane(-0.2), bp.Membrane.drude(0.1, 700.0)], 30)
    f = np.array([1000.0])
    for new, old in zip(layers_of(bp.tolerance(slab, sigma, sigma, seed=1)[0]), layers_of(slab), strict=True):
        assert new.thickness > 0 or old.thickness == 0
        if isinstance(old, bp.Membrane):
            assert (new.at(f) / old.at(f)).real > 0
            continue
        new, old = new.fluid.at(f), old.fluid.at(f)
        assert new.bulk_modulus == old.bulk_modulus
        if old.rho_z:
            factor = (new.rho_z / old.rho_z).item()
            assert factor.real > 0
            assert abs(factor.imag) < 1e-15
            assert np.isinf(old.rho_x) or np.isclose(new.rho_x / old.rho_x, factor, rtol=1e-14)
        else:
            assert new.rho_z == 0


def test_it_is_a_few_numbers_to_send_and_to_record():
    copy = bp.tolerance(bp.Slab(bp.lmmd_cell(), 450), 0.02, 0.02, count=1000, seed=3)[999]
    sent = pickle.dumps(copy)
    assert len(sent) < 4000
    assert pickle.loads(sent) == copy != SLAB
    assert hash(pickle.loads(sent)) == hash(copy)
    assert pickle.loads(sent).segments == copy.segments
    with pytest.raises(AttributeError, match="'Copy' object has no attribute 'layers'"):
        _ = copy.layers
    ds = bp.scattering(copy, 2500.0, angle=0)
    assert len(ds.attrs["provenance"]) < 5000
    assert bp.provenance(ds)["slab"] == copy


def test_memory_of_a_copy():
    """What is checked beforehand is what a copy takes, within a factor of two; copies are not kept."""
    copies = bp.tolerance(bp.Slab(bp.lmmd_cell(), 100), 0.02, 0.02)
    assert copies[0].periods == 1
    tracemalloc.start()
    assert {copy.periods for copy in itertools.islice(copies, 5)} == {1}
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert LAYER / 2 < peak / 1000 < 2 * LAYER


def test_widths_of_an_aperiodic_slab():
    """Of a copy with 120 different layers, against a plain integral with scattering matrices."""
    copy = bp.tolerance(bp.Slab(bp.lmmd_cell(), 12), 0.05, 0.05, seed=2)[0]
    x = np.linspace(-0.15, 0.15, 601)
    radius = 0.096 / (2 * math.sqrt(math.log(2)))
    p = oracles.open_field(
        copy, 2500.0, lambda k: radius * math.sqrt(math.pi) * np.exp(-((k * radius / 2) ** 2)), 0.0, x, [copy.thickness]
    )[0]
    size = CubicSpline(x, np.abs(p))
    peak = max(size(at) for at in size.derivative().roots(extrapolate=False))
    edges = CubicSpline(x, np.abs(p) - peak / 2).roots(extrapolate=False)
    assert abs(bp.beam_width(copy, BEAM, 2500.0).fwhm_out.item() - np.ptp(edges)) < 1e-8


def test_widths_of_4500_layers():
    copies = bp.tolerance(bp.Slab(bp.lmmd_cell(), 450), 0.01, 0.01, count=3, seed=1)
    alone = [bp.beam_width(copy, BEAM, 2500.0).fwhm_out.item() for copy in copies]
    assert np.allclose(widths_of(copies, [BEAM] * 3, [2500.0] * 3).row.fwhm_out, alone, rtol=1e-9)
    perfect = bp.beam_width(bp.Slab(bp.lmmd_cell(), 450), BEAM, 2500.0).fwhm_out.item()
    assert 1e-6 < np.std(alone) < 0.1 * perfect


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"slab": SLAB.cell}, "slab: expected a Slab, got Cell"),
        ({"thickness": 0.25}, "thickness: expected a relative standard deviation from 0 to below 0.25, got 0.25"),
        ({"density": -0.1}, "density: expected a relative standard deviation from 0 to below 0.25, got -0.1"),
        ({"density": "1 %"}, "density: expected a real number, got '1 %'"),
        ({"count": 0}, "count: expected a whole number of at least 1, got 0"),
        ({"seed": -1}, "seed: expected a whole number of at least 0, got -1"),
        ({"slab": bp.Slab(bp.lmmd_cell(), 10**9)}, "slab: expected a question that fits into"),
    ],
)
def test_refusals(arguments, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        bp.tolerance(**{"slab": SLAB, **arguments})


def test_an_index_beyond_the_count():
    with pytest.raises(IndexError, match="index: expected one of 3 copies, got 3"):
        bp.tolerance(SLAB, count=3)[3]


def test_the_benchmark_prints_percentiles_of_the_copies(monkeypatch):
    monkeypatch.setattr(benchmark, "SLAB", SLAB)
    header, _, fwhm, peak, *_, answered = benchmark.report(7).splitlines()
    copies = bp.tolerance(SLAB, benchmark.SIGMA, benchmark.SIGMA, count=7)
    answers = [bp.beam_width(copy, BEAM, 2500.0) for copy in [SLAB, *copies]]
    for line, name, scale in ((fwhm, "fwhm_out", 100.0), (peak, "peak_out", 1.0)):
        designed, *values = (scale * answer[name].item() for answer in answers)
        want = [designed, *np.percentile(values, benchmark.SHARES)]
        assert np.allclose([float(v) for v in line.split("|")[2:-1]], want, rtol=0, atol=6e-4)
    assert header.count("%") == len(benchmark.SHARES)
    assert answered.startswith("7 answered; ")
