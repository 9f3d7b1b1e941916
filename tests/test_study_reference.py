"""The accuracy study's own truth, held to what is more independent still: 40 digits, closed forms, real-axis integrals."""

import itertools

import numpy as np
import pytest
from accuracy_study.case import Case
from accuracy_study.cases import hard
from accuracy_study.cases.numbering import CASES, make_case, numbers_of
from accuracy_study.cases.slabs import SLABS
from accuracy_study.reference import bands, many_digits, quadrature
from accuracy_study.reference.contour import panels
from accuracy_study.reference.medium import Medium
from accuracy_study.reference.near_axis import NearAxis
from accuracy_study.reference.source import Source
from scipy.special import hankel1

import beamprop as bp

F = 2500.0
LAM = 343.0 / F
K0 = 2 * np.pi / LAM


def case_of(slab, beam, x, z, kind="uniform fluid", rtol=1e-9):
    return Case(kind, "Gaussian, launch", slab, beam, F, np.asarray(x, float), np.asarray(z, float), rtol)


def truth(case):
    with np.errstate(all="ignore"):
        found = quadrature.truth(case, np.zeros(0) + case.beam.centre)
    assert not isinstance(found, str), found
    return found


# --- the response, by 2x2 matrices with 40 digits ----------------------------------------------------------


#: Classes with too many layers for 40 digits, and one whose response is looked at below.
OTHERWISE = ("100 000 lossless periods", "slits before the lossless slab", "sharp resonances")


@pytest.mark.parametrize("kind", [k for k in hard.HARD if k not in OTHERWISE])
def test_responses_to_40_digits(kind):
    """On the real axis, where the outgoing root is the one that a trace of loss makes decay."""
    done = 0
    for number in itertools.islice(numbers_of(kind), 12):
        case = make_case(number)
        m = Medium(case.slab, case.frequency)
        if sum(n * len(part) for part, n in m.segments) > 80:
            continue
        z = case.z[:3]
        k = np.array([0.0123, 0.31, 0.97, 1.07, 1.9]) * m.k0
        got = m.response(k + 0j, z, case.beam.z0)
        want = np.array([many_digits.response(m, v, z, case.beam.z0) for v in k]).T
        size = np.maximum(np.abs(want), 1e-3 * np.abs(np.exp(1j * m.kz(m.before, k + 0j) * -case.beam.z0))) + 1e-300
        assert np.max(np.abs(got - want) / size) < 1e-9, number
        done += 1
        if done == 3:
            return
    assert done


def test_series_beside_a_sharp_resonance():
    """Where double precision gives anything, the series are right to 11 digits: a cavity between steel mirrors at resonance."""
    done = 0
    for number in itertools.islice(numbers_of("sharp resonances"), 10):
        case = make_case(number)
        m = Medium(case.slab, case.frequency)
        near = NearAxis(m, case.z, case.beam.z0)
        k = (0.6 - 0.7j) * near.radius * np.array([1.0, 1e-2, 1e-4, 1e-6, 1e-9])
        want = np.array([many_digits.response(m, v, case.z, case.beam.z0) for v in k]).T
        size = np.abs(want).max(axis=1, keepdims=True)
        np.testing.assert_allclose(near.response(k) / size, want / size, atol=1e-11)
        rough = m.response(k, case.z, case.beam.z0)
        done += np.max(np.abs(rough - want) / np.abs(want)) > 1e-9
    assert done  # there are some that need them


# --- fields, by closed forms and other integrals ------------------------------------------------------------


def free(beam, x, distance):
    """A launched profile after a distance in air, by the two-dimensional Rayleigh integral over real x."""
    reach = beam.reach(1e-17)
    u, w = panels(beam.x0 + np.linspace(-reach, reach, 600))
    r = np.hypot(x[:, None] - u, distance)
    return (0.5j * K0 * distance / r * hankel1(1, K0 * r)) @ (beam.profile(u, K0) * w)


@pytest.mark.parametrize("wall", ["soft", "hard"])
def test_walls_have_image_sources(wall):
    """In front of density 0, or 1e12 times air's: the beam, and its mirror image with the opposite or the same sign."""
    gap = 1.37 * LAM
    fluid = bp.Fluid(0.0, 1e5) if wall == "soft" else bp.Fluid.from_speed(1.25e12, 5000.0)
    slab = bp.Slab([bp.Layer(bp.AIR, gap), bp.Layer(fluid, 0.3 * LAM)], 1)
    beam = bp.GaussianBeam(1.3 * LAM, 25.0, 0.2 * LAM, -0.8 * LAM)
    x, z = np.linspace(-2, 2, 9) * LAM, np.array([0.1, 0.5, 0.9]) * gap
    found = truth(case_of(slab, beam, x, z, "nearly dark planes"))
    sign = -1 if wall == "soft" else 1
    want = np.array([free(beam, x, d - beam.z0) + sign * free(beam, x, 2 * gap - d - beam.z0) for d in z])
    assert np.abs(found.p - want).max() < 2e-11 * np.abs(want).max()


def on_the_axis(case, loss, count=1500):
    """The field of a lossy question by Gauss panels on the real axis, graded to the branch points."""
    m = Medium(case.slab, case.frequency, loss)
    source = Source(case.beam, m.k0)
    end = source.band(1e-17)
    points = [abs(b.real) for b in m.branch_points() if 0 < b.real < end]
    steps = end * np.geomspace(1e-12, 1, 120)
    edges = np.concatenate([np.linspace(0, end, count), *(p + side * steps for p in points for side in (-1, 1)), steps])
    k, w = panels(np.unique(edges[(edges >= 0) & (edges <= end)]))
    return quadrature.field_sum(
        source, lambda kk: m.response(kk, case.z, case.beam.z0), k + 0j, w + 0j, None, case.x - case.beam.centre
    )


HALF_SPACES = {
    "density": bp.Fluid(-1.25 * 2.5, bp.AIR.bulk_modulus),
    "density, lossy": bp.Fluid(-1.25 * (2.5 - 1e-4j), bp.AIR.bulk_modulus),
    "modulus, lossy": bp.Fluid(1.25 * 0.6, bp.AIR.bulk_modulus * (-0.7 - 1e-3j)),
}


@pytest.mark.parametrize("name", HALF_SPACES)
def test_negative_half_spaces_are_the_limit_of_losses_on_the_real_axis(name):
    """A heavy layer before a half-space that guides backward waves: losses e, e/2, e/4, ... extrapolated to none."""
    layer = bp.Layer(bp.Fluid(1.25 * 3.75, 1e5), 0.01 * LAM)
    slab = bp.Slab([layer], 1, after=HALF_SPACES[name])
    case = case_of(slab, bp.GaussianBeam(0.3 * LAM, 20.0), np.linspace(-1, 1, 5) * LAM, [0.0, 0.005 * LAM, 0.1 * LAM])
    found = truth(case)
    losses = 0.02 / 2 ** np.arange(7)
    table = [on_the_axis(case, loss) for loss in losses]
    for power in range(1, len(table)):
        table = [(2**power * b - a) / (2**power - 1) for a, b in itertools.pairwise(table)]
    assert np.abs(found.p - table[0]).max() < 1e-7 * np.abs(found.p).max()
    assert found.wrong > 0 or name == "modulus, lossy"


def test_a_soft_wall_behind_a_negative_layer_is_the_limit_of_losses():
    """The same for a layer that guides a backward wave before density 0."""
    negative = bp.Layer(bp.Fluid(-1.25 * 0.5, bp.AIR.bulk_modulus), 0.05 * LAM)
    slab = bp.Slab([negative, bp.Layer(bp.Fluid(0.0, 1e5), 0.1 * LAM)], 1)
    case = case_of(slab, bp.GaussianBeam(0.3 * LAM, 20.0), np.linspace(-1, 1, 5) * LAM, [0.0, 0.03 * LAM, 0.1 * LAM])
    found = truth(case)
    table = [on_the_axis(case, loss) for loss in 0.02 / 2 ** np.arange(7)]
    for power in range(1, len(table)):
        table = [(2**power * b - a) / (2**power - 1) for a, b in itertools.pairwise(table)]
    assert np.abs(found.p - table[0]).max() < 1e-7 * np.abs(found.p).max()
    assert np.all(found.p[2] == 0)


@pytest.mark.parametrize("angle", [0.0, 45.0])
def test_wide_beams_on_their_launch_plane_are_their_profile(angle):
    width = 20_000 * LAM
    beam = bp.GaussianBeam(width, angle, 3.0, 0.0)
    x = 3.0 + width * np.linspace(-1, 1, 9)
    found = truth(case_of(bp.Slab.uniform(bp.AIR, 0.1), beam, x, [0.0], rtol=1e-7))
    np.testing.assert_allclose(np.abs(found.p[0] - beam.profile(x, K0)).max(), 0, atol=1e-9)


@pytest.mark.parametrize("speed", [1e4, 1e6, 1e9])
def test_branch_points_beside_normal_incidence(speed):
    """A half-space of huge speed: against losses on the real axis, which is graded to its branch point."""
    after = bp.Fluid.from_speed(1.25 * 3, speed)
    slab = bp.Slab.uniform(bp.Fluid(2.0, 2e5), 0.3 * LAM, after=after)
    case = case_of(slab, bp.GaussianBeam(0.7 * LAM, 10.0), np.linspace(-1, 1, 5) * LAM, [0.0, 0.3 * LAM, LAM])
    found = truth(case)
    p = on_the_axis(case, 0.0, 3000)  # nothing is guided: no pole lies on the axis
    assert np.abs(found.p - p).max() < 1e-10 * np.abs(p).max()


def test_a_resonance_in_what_a_nearly_soft_layer_lets_through():
    # |h| goes from 0.2 to 1 and back below kx = 1e-4 k0: panels twice as long as their neighbours do not resolve it.
    cell = bp.Cell([bp.Layer(bp.AIR, 0.4388), bp.Layer(bp.Fluid(3.6e-9, 65668), 0.1291)])
    slab, beam = bp.Slab(cell), bp.GaussianBeam(0.0944, z0=-0.0442, form="rotated")
    case = case_of(slab, beam, np.linspace(-0.05, 0.05, 11), [0.2, 0.4388], "nearly dark planes", 1e-5)
    case = case._replace(frequency=1683.0)
    m = Medium(slab, 1683.0)
    angle, w = panels(np.unique(np.concatenate([[0], np.pi / 2 * 1.05 ** -np.arange(0.0, 500)])))
    k, kz = m.k0 * np.sin(angle) + 0j, m.k0 * np.cos(angle)
    source = Source(beam, m.k0)
    expected = quadrature.field_sum(source, lambda kk: m.response(kk, case.z, beam.z0), k, kz * w, kz, case.x)
    found = truth(case)
    assert np.all(np.abs(found.p - expected).max(axis=1) < 1e-10 * np.abs(expected).max(axis=1))


def test_an_origin_far_away_changes_nothing():
    slab, away = bp.Slab.uniform(bp.Fluid(2.0, 2e5), 0.3 * LAM), 2.0**16
    x, z = np.linspace(-1, 1, 9) / 8, [0.0, 0.2]
    near, far = (truth(case_of(slab, bp.GaussianBeam(0.25, 20.0, x0), x + x0, z)) for x0 in (0.0, away))
    np.testing.assert_allclose(far.p, near.p, atol=1e-13)


def test_sides_of_the_axis_by_bloch_waves():
    """20 000 periods with sign-changing density: above the axis where loss moves modes down; the limit of small losses."""
    cell = [bp.Layer(bp.Fluid(-1.25 * 0.7, bp.AIR.bulk_modulus), 0.01 * LAM), bp.Layer(bp.AIR, 0.02 * LAM)]
    m = Medium(bp.Slab(cell, 20_000), F)
    k = np.linspace(0.05, 3, 40) * m.k0
    lossy = Medium(bp.Slab(cell, 20_000), F, 1e-6)
    for stretch in bands.stretches(m, 3 * m.k0, 3 * m.k0):
        some = k[(k > 1.01 * stretch.lo) & (k < 0.99 * stretch.hi) & (np.abs(bands.half_trace(m, k)) < 0.99)]
        for k1 in some:  # a mode: Newton's method on cos(kB P) = its value at k1, with loss
            target, at = bands.half_trace(m, np.array([k1]))[0], complex(k1)
            for _ in range(20):
                t, up = (complex_trace(lossy, at + h) for h in (0, 1e-6 * k1))
                at -= (t - target) / ((up - t) / (1e-6 * k1))
            assert np.sign(at.imag) == -stretch.side


def complex_trace(m, k):
    """Half the trace of one period's matrix."""
    whole = np.eye(2)
    for rho, rho_x, K, d in m.segments[0][0]:
        kz = np.sqrt(rho * (m.omega**2 / K - k**2 / rho_x) + 0j)
        c, s = np.cos(kz * d), np.sin(kz * d)
        whole = np.array([[c, rho * s / kz], [-kz * s / rho, c]]) @ whole
    return np.trace(whole) / 2


# --- the questions ------------------------------------------------------------------------------------------


def test_classes_and_numbers():
    """3000 cases; each class has its numbers, and a number is the same question every time."""
    assert CASES == 3000
    for kind in [*SLABS, *hard.HARD]:
        some = list(itertools.islice(numbers_of(kind), 3))
        assert {make_case(n).kind for n in some} == {kind}
    one, other = make_case(2205), make_case(2205)
    assert one.beam == other.beam
    assert one.slab == other.slab
    np.testing.assert_array_equal(one.x, other.x)


def test_the_first_cases_are_what_they_were():
    """Numbers below 2200 were drawn before there were hard classes: what some of them asked."""
    for number, kind, frequency, rtol in FIRST_CASES:
        case = make_case(number)
        assert (case.kind, case.frequency, case.rtol) == (kind, frequency, rtol)


FIRST_CASES = [
    (0, "air alone", 2341.8573859415224, 1.9029888266328568e-05),
    (33, "LMMD, 1 or 100 000 periods", 2696.835759850593, 9.570607476223119e-11),
    (507, "stack", 3128.4550956537064, 0.00045758936965997955),
    (1214, "backward modes", 696.4237755278701, 1.0885536302058843e-05),
    (2199, "water in front", 3675.937070110926, 2.719369293941861e-05),
]
