"""Sums of sources: Rayleigh's integrals added, single fields added, and errors where sources cancel."""

import numpy as np
import pytest
from test_piston import FREQUENCY, NOTHING, RADIUS, WATER, Z0, rayleigh

import beamprop as bp

PLATE = bp.Slab.uniform(bp.Fluid.from_speed(1900.0, 2800.0), 0.0065, background=WATER)
UNLIKE = (
    (1.0, bp.Piston(0.01, z0=-0.03)),
    (0.5j, bp.Piston(0.006, "soft", x0=0.02, z0=-0.03)),
    (-1 + 1j, bp.Bowl(0.064, 0.03, y0=-0.01, z0=-0.03)),
    (2.0, bp.GaussianBeam((0.02, 0.01), 20, azimuth=30, x0=-0.03, z0=-0.03)),
)
X, Y, Z = np.linspace(-0.05, 0.05, 11), np.linspace(-0.04, 0.04, 5), [0.0, 0.02, 0.05]
SLAB = bp.Slab(bp.lmmd_cell(), 20)
SAMPLES = np.linspace(-0.3, 0.3, 121)
PROFILE = bp.Profile(SAMPLES + 0.4, np.exp(-((SAMPLES / 0.06) ** 2)), z0=-0.1)
BEAM, SLITS = bp.GaussianBeam(0.1, 30, x0=-0.2, z0=-0.1), bp.Slits(0.05, 0.1, z0=-0.1)


def summed(terms):
    return sum((weight * source for weight, source in terms[1:]), terms[0][0] * terms[0][1])


def errors(p, known):
    axes = tuple(range(1, p.ndim))
    return np.max(np.abs(p - known), axis=axes) / np.max(np.abs(known), axis=axes)


def test_by_rayleighs_integrals():
    """A rigid piston and a soft one beside it: two factors to the response in one field."""
    both = bp.Piston(RADIUS, z0=Z0) + 0.5j * bp.Piston(RADIUS, "soft", x0=0.03, z0=Z0)
    x, y, z = np.array([-0.01, 0.004, 0.02]), np.array([0.0, 0.02]), np.array([0.012, 0.1])
    p = bp.field(NOTHING, both, FREQUENCY, x, z, y=y, rtol=1e-9).p.values
    known = [[[rayleigh("rigid", a, b, c) + 0.5j * rayleigh("soft", a - 0.03, b, c) for a in x] for b in y] for c in z]
    assert np.max(errors(p, np.array(known))) < 1e-9


def test_unlike_sources_through_a_plate():
    """The sum of fields that are asked one by one with a lower rtol."""
    ds = bp.field(PLATE, summed(UNLIKE), 0.2e6, X, Z, y=Y, rtol=1e-7)
    known = sum(w * bp.field(PLATE, s, 0.2e6, X, Z, y=Y, rtol=1e-10).p.values for w, s in UNLIKE)
    assert np.max(errors(ds.p.values, known)) < 1e-7
    assert float(ds.error_estimate) < 1e-7
    assert bp.provenance(ds)["beam"] == summed(UNLIKE)


def test_errors_are_added_over_the_largest_of_the_sum():
    """Of two beams beside each other, whose planes hold their peaks: each error over its own largest |p|, weighted."""
    x, y = np.linspace(-0.03, 0.08, 111), np.linspace(-0.02, 0.02, 41)
    a, b = bp.GaussianBeam((0.02, 0.02), z0=-0.03), bp.GaussianBeam((0.015, 0.02), x0=0.05, z0=-0.03)
    each = [bp.field(PLATE, source, 0.2e6, x, 0.02, y=y, rtol=1e-6) for source in (a, b, a + 2j * b)]
    errors_of, largest = zip(*((float(ds.error_estimate), float(abs(ds.p).max())) for ds in each), strict=True)
    added = (errors_of[0] * largest[0] + 2 * errors_of[1] * largest[1]) / largest[2]
    assert errors_of[2] == pytest.approx(added, rel=1e-3)


def test_sources_that_nearly_cancel_are_asked_more_closely():
    """Of two discs that differ by a ring of 2 um little is left, to the rtol of that: the ring's own integral, thin as it is."""
    thin = 2e-6
    ring = bp.Piston(RADIUS + thin, z0=Z0) - bp.Piston(RADIUS, z0=Z0)
    ds = bp.field(NOTHING, ring, FREQUENCY, 0.0, [0.05], y=0.0, rtol=1e-6)
    k, d = 2 * np.pi * FREQUENCY / 1500.0, 0.05 - Z0
    inner, outer = np.hypot(d, RADIUS), np.hypot(d, RADIUS + thin)
    known = np.exp(1j * k * inner) - np.exp(1j * k * outer)
    assert abs(ds.p.item() / known - 1) < 1e-6
    assert float(ds.error_estimate) < 1e-6


def test_what_cancels_too_far_is_warned_of():
    ring = bp.Piston(RADIUS * (1 + 1e-9), z0=Z0) - bp.Piston(RADIUS, z0=Z0)
    with pytest.warns(bp.AccuracyWarning, match="sources of the sum that cancel"):
        ds = bp.field(NOTHING, ring, FREQUENCY, 0.0, [0.05], y=0.0, rtol=1e-8)
    assert float(ds.error_estimate) > 1e-8


@pytest.mark.parametrize(
    "terms",
    [((1, BEAM), (1j, PROFILE)), ((1, BEAM), (0.5, SLITS), (-1, PROFILE))],
    ids=["beam, profile", "beam, slits, profile"],
)
def test_in_two_dimensions(terms):
    ds = bp.field(SLAB, summed(terms), 2500.0, np.linspace(-1, 1, 101), [0.0, 0.1], rtol=1e-7)
    singly = (bp.field(SLAB, s, 2500.0, np.linspace(-1, 1, 101), [0.0, 0.1], rtol=1e-11) for _, s in terms)
    known = sum(w * ds_of.p.values for (w, _), ds_of in zip(terms, singly, strict=True))
    assert np.max(errors(ds.p.values, known)) < 1e-7
    assert float(ds.error_estimate) < 1e-7


def test_two_beams_side_by_side_have_a_width():
    """Of two beams that overlap: the launched profile, measured by hand."""
    twins = bp.GaussianBeam(0.2, x0=-0.05) + bp.GaussianBeam(0.2, x0=0.05)
    x = np.linspace(-0.5, 0.5, 200001)
    p = np.exp(-4 * np.log(2) * ((x - 0.05) / 0.2) ** 2) + np.exp(-4 * np.log(2) * ((x + 0.05) / 0.2) ** 2)
    known = np.ptp(x[p >= p.max() / 2])
    assert float(bp.beam_width(SLAB, twins, 2500.0).fwhm_launch) == pytest.approx(known, abs=1e-5)


def test_angle_of_a_sum_is_its_sources():
    sources = bp.GaussianBeam(0.1, 20, z0=-0.1), bp.GaussianBeam(0.2, 20, z0=-0.1)
    x = np.linspace(-0.5, 0.5, 11)
    several = bp.field(SLAB, sources[0] + sources[1], 2500.0, x, 0.1, angle=[0, 20])
    single = bp.field(SLAB, sources[0] + sources[1], 2500.0, x, 0.1)
    assert float(single.angle) == 20
    np.testing.assert_allclose(several.p.values[1], single.p.values, atol=1e-8)
    turned = summed(UNLIKE[:1] + UNLIKE[3:])
    assert float(bp.field(PLATE, turned, 0.2e6, 0.0, 0.02, y=0.0, rtol=1e-3).angle) == 0
    with pytest.raises(ValueError, match="angle: expected none with a sum of sources at angles of their own, got 10"):
        bp.field(PLATE, turned, 0.2e6, 0.0, 0.02, angle=10, y=0.0)


def test_products_and_sums_are_one_record():
    first, second = UNLIKE[0][1], UNLIKE[1][1]
    assert 2 * (first + 0.5 * second) - second == bp.SourceSum((first,), (2.0,))
    assert -first == np.complex128(-1) * first == first * -1
    assert first + second + first == bp.SourceSum((first, second), (2, 1))


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: BEAM + bp.GaussianBeam(0.1), r"z0: expected sources on the same launch plane, got z0 = -0.1 and 0"),
        (lambda: BEAM - BEAM, "sources: expected a sum that is not zero everywhere"),
        (lambda: float("nan") * BEAM, "weights: expected finite numbers, got"),
        (
            lambda: BEAM + bp.GaussianBeam(0.1, z0=-0.1, form="rotated"),
            "form: expected no beam of the form 'rotated' beside",
        ),
        (lambda: bp.field(SLAB, UNLIKE[0][1] + UNLIKE[1][1], 2500.0, 0.0, 0.1), "beam: expected one on which nothing"),
        (lambda: bp.field(SLAB, BEAM + SLITS, 2500.0, 0.0, 0.1, y=0.0), "beam: expected a GaussianBeam, Piston"),
        (lambda: bp.SourceSum((BEAM, 3.0), (1, 1)), "sources: expected a tuple of sources"),
        (lambda: bp.SourceSum((BEAM,), (1, 1)), "weights: expected a weight of each of 1 sources"),
    ],
)
def test_refusals(make, said):
    with pytest.raises(ValueError, match=said):
        make()


def test_what_is_no_source_is_no_sum():
    with pytest.raises(TypeError):
        BEAM + 3
    with pytest.raises(TypeError):
        BEAM * "2"
    with pytest.raises(TypeError):
        1 + BEAM


def test_pythons_sum_is_a_sum():
    assert sum([BEAM, 2j * PROFILE, SLITS]) == BEAM + 2j * PROFILE + SLITS
    assert sum([BEAM]) is BEAM
    array = bp.Array([[0.0, 0.0], [0.02, 0.0]], UNLIKE[0][1])
    assert sum([array, UNLIKE[3][1]]) == array + UNLIKE[3][1]
