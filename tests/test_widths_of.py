"""`widths_of`: many points at once are the same points one by one."""

import re
import warnings

import numpy as np
import pytest

import beamprop as bp
from beamprop.api.widths_of import widths_of

BEAM, WIDE = bp.GaussianBeam(0.096), bp.GaussianBeam(0.2, 30.0, x0=0.05, z0=-0.1)
WATER = bp.Fluid.from_speed(1000.0, 1480.0)


def resonant(strength):
    """A fluid whose density is a function of the frequency."""
    return bp.Fluid(lambda f: 2.0 + strength * 500j / f, 1.2e5)


#: Slabs of several layouts: lossy, lossless, dispersive, with membranes, with a layer of density 0, stacked, other half-spaces.
SLABS = [
    *(bp.Slab(bp.lmmd_cell(eta=1 / n), periods=90) for n in (60, 50, 40)),
    *(bp.Slab(bp.lmmd_cell(eta=1 / n, lossless=True), periods=90) for n in (60, 50)),
    *(bp.Slab([bp.Layer(resonant(s), 0.01), bp.Layer(bp.AIR, 0.02)], 3) for s in (1.0, 2.0)),
    *(bp.Slab([bp.Membrane(m), bp.Layer(bp.AIR, 0.01)], 2) for m in (0.1, 0.3)),
    *(bp.Slab([bp.Membrane.drude(m, 700.0), bp.Layer(bp.AIR, 0.01)], 2) for m in (0.1, 0.3)),
    *(bp.Slab([bp.Layer(bp.Fluid(rho, 1.4e5), 0.01), bp.Layer(bp.AIR, 0.02)]) for rho in (0.0, 1.0)),
    *(
        bp.Slab.uniform(WATER, d, after=after) + bp.Slab.uniform(bp.AIR, 0.1)
        for d, after in ((0.001, WATER), (0.002, bp.AIR))
    ),
    *(bp.Slab.uniform(bp.AIR, 0.1, after=bp.Fluid(rho, 1.5e5)) for rho in (1.0, 2.0)),
]


def alone(slab, beam, f):
    """`beam_width` of a point, without its warnings."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        ds = bp.beam_width(slab, beam, f)
    return np.array([ds[name].item() for name in ds])


@pytest.mark.parametrize("beam", [BEAM, WIDE, bp.Slits(0.03, 0.1), bp.GaussianBeam(0.3, 20.0, form="rotated")])
def test_together_is_one_by_one(beam):
    f = np.linspace(2000.0, 3000.0, len(SLABS))
    many = widths_of(SLABS, [beam] * len(SLABS), f)
    want = np.array([alone(slab, beam, float(at)) for slab, at in zip(SLABS, f, strict=True)]).T
    got = np.array(many.row)
    assert np.array_equal(np.isnan(got), np.isnan(want))
    assert np.nanmax(np.abs(got[:4] - want[:4])) < 1e-8
    assert np.allclose(got[4], want[4], rtol=1e-8, equal_nan=True)
    assert np.nanmax(np.abs(got[5] - want[5])) < 1e-5  # the samples are those of all points
    assert list(many.row._fields) == list(bp.beam_width(SLABS[0], BEAM, 2000.0).data_vars)


def test_any_order_and_several_beams():
    rng = np.random.default_rng(3)
    slabs = [SLABS[i] for i in rng.integers(len(SLABS), size=12)]
    beams = [(BEAM, WIDE)[i] for i in rng.integers(2, size=12)]
    f = rng.uniform(2000, 3000, 12)
    order = rng.permutation(12)
    straight = widths_of(slabs, beams, f)
    mixed = widths_of([slabs[i] for i in order], [beams[i] for i in order], f[order])
    for name, values in straight.row._asdict().items():
        same = 1e-5 if name == "centroid_out" else 1e-8
        assert np.allclose(getattr(mixed.row, name), values[order], rtol=0, atol=same, equal_nan=True), name
    assert np.array_equal(mixed.crossings, straight.crossings[:, order])


def test_beams_that_differ_in_their_angle_share_rows(monkeypatch):
    """They are computed in one go, and each is that of its angle; beams of other kinds are not mixed with them."""
    from beamprop.profiles import sections

    counts, rows = [], sections.rows
    monkeypatch.setattr(sections, "rows", lambda s, *rest: counts.append(s.k0.size) or rows(s, *rest))
    slab, angles = bp.Slab(bp.lmmd_cell(), 45), (0.0, -10.0, 35.0, 60.0)
    kinds = BEAM, bp.GaussianBeam(0.1, x0=0.3, z0=-0.05), bp.Slits(0.03, 0.1), bp.GaussianBeam(0.3, form="rotated")
    beams = [beam.at_angle(angle) for angle in angles for beam in kinds]
    f = np.linspace(2300.0, 2600.0, len(beams))
    many = widths_of([slab] * len(beams), beams, f)
    assert sorted(counts) == [1, 1, 1, 1, 4, 4, 4]  # the spectrum of a rotated beam is no shifted one
    want = np.array([alone(slab, beam, float(at)) for beam, at in zip(beams, f, strict=True)]).T
    assert np.allclose(np.array(many.row)[:5], want[:5], rtol=1e-8, atol=1e-9)
    assert np.allclose(many.row.centroid_out, want[5], atol=1e-5)


def test_rows_of_a_tilted_source_are_the_source_at_their_angles():
    from beamprop.sources.rows import at_row, repeated, rows_of, taken

    x = np.linspace(-0.2, 0.2, 41)
    for source in (BEAM, bp.Slits(0.03, 0.1), bp.Profile(x, np.exp(-((x / 0.05) ** 2)))):
        beams = [source.at_angle(angle) for angle in (20.0, 0.0, -40.0)]
        rows = taken(repeated(rows_of(beams), 2), np.array([0, 4, 5]))
        k0 = np.array([30.0, 40.0, 50.0])
        k = k0[:, None] * np.linspace(-2, 2, 9) - 0.5j
        want = np.stack([beam.spectrum(row, at) for beam, row, at in zip(beams, k, k0, strict=True)])
        assert np.allclose(rows.spectrum(k, k0[:, None]), want, rtol=1e-12, atol=1e-12 * np.abs(want).max())
        bands = np.array([beam.band(at, 1e-3) for beam, at in zip(beams, k0, strict=True)])
        assert np.allclose(np.transpose(rows.band(k0, 1e-3)), bands, rtol=1e-12)
        assert [at_row(rows, i) for i in range(3)] == beams


def test_errors_are_those_of_each_point():
    # the second point's error is no better for a first one that is easy, and the first one's no worse
    hard = bp.Slab(bp.lmmd_cell(lossless=True), periods=450)
    easy = bp.Slab(bp.lmmd_cell(), periods=450)
    both = widths_of([easy, hard], [BEAM, BEAM], [2500.0, 2500.0])
    single = [widths_of([slab], [BEAM], [2500.0]).budget.total[0] for slab in (easy, hard)]
    assert np.all(both.budget.total > 0)
    assert np.allclose(np.log10(both.budget.total), np.log10(single), atol=1.0)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([SLABS[0]], [BEAM], [2500.0, 2600.0]), "slabs: expected 2, as many as frequencies, got 1"),
        ((2 * [SLABS[0]], [BEAM], [2500.0, 2600.0]), "beams: expected 2, as many as frequencies, got 1"),
        (([bp.AIR], [BEAM], [2500.0]), "slabs: expected a Slab, got Fluid"),
        (([SLABS[0]], [3], [2500.0]), "beams: expected a Beam (GaussianBeam, Profile, Slits), got 3"),
        (([SLABS[0]], [BEAM], [-1.0]), "frequency: expected values above zero, got -1.0"),
        (([SLABS[0]], [BEAM], [2500.0], 1.0), "rtol: expected a value from 1e-12 to 0.1, got 1.0"),
        (([SLABS[0]], [BEAM], [2500.0], 1e-8, 0.0), "air_distance: expected a finite number above zero, got 0.0"),
    ],
)
def test_refusals(arguments, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        widths_of(*arguments)


def test_refuses_the_slab_that_is_at_fault():
    backward = bp.Fluid(-1.0, -1e5)
    slabs = [bp.Slab.uniform(bp.AIR, 0.1), bp.Slab.uniform(bp.AIR, 0.1, before=backward)]
    with pytest.raises(
        ValueError,
        match=r"before: expected a half-space that carries forward waves at 2600.0 Hz, got Fluid\(density=-1",
    ):
        widths_of(slabs, [BEAM, BEAM], [2500.0, 2600.0])
