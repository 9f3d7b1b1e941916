"""References for plates of solids against other calculations: counts of zeros, plates that do not shear."""

import cmath
import math

import pytest
from conformance.formulas import layers, plates, solids
from conformance.sections import plates as section

STEEL, SILICA, WATER = (7900.0, 5900.0, 3200.0), (2200.0, 5968.0, 3764.0), (1000.0, 1480.0)


@pytest.mark.parametrize("solid", [*section.SOLIDS.values(), SILICA])
def test_s1_begins_where_its_group_velocity_is_zero(solid):
    """A little above there are two more zeros of Lamb's equation than a little below, on either side of kx."""
    fd, kd = plates.zero_group_velocity(solid)
    above, below = (
        [2 * math.pi * fd * near * s for s in solids.lamb(fd * near, solid)] for near in (1 + 1e-4, 1 - 1e-4)
    )
    assert len(above) == len(below) + 2
    one, other = sorted(above, key=lambda value: abs(value - kd))[:2]
    assert (one - kd) * (other - kd) < 0
    assert (one + other) / 2 == pytest.approx(kd, rel=1e-3)


@pytest.mark.parametrize("solid", [STEEL, SILICA])
def test_cut_offs_are_where_a_zero_leaves_the_axis(solid):
    """On the side to which fd grows there is one more zero, at the kx d of the closed form."""
    cut_offs = plates.cut_offs(solid, 2, 3)
    assert [c.name for c in cut_offs] == ["1 cL/2", "2 cL/2", "1 cT/2", "2 cT/2", "3 cT/2"]
    for cut_off in cut_offs:
        there, beyond = (cut_off.fd + side * 4e-4 * cut_off.curvature for side in (1, -1))
        zeros = solids.lamb(there, solid)
        assert len(zeros) == len(solids.lamb(beyond, solid)) + 1
        assert 2 * math.pi * there * zeros[-1] == pytest.approx(0.02, rel=6e-3)


def test_two_waves_of_a_cone_have_one_speed_on_either_side():
    brass = (8400.0, 4400.0, 2200.0)
    for near in (1 + 1e-3, 1 - 1e-3):
        slow = solids.lamb(2200.0 * near, brass)[-1]
        speed = abs(near - 1) / near / slow
        assert speed == pytest.approx(plates.cone(brass), rel=0.02)


@pytest.mark.parametrize("angle", [0.0, 10.0, 25.0, 60.0])
@pytest.mark.parametrize("fd", [100.0, 3000.0, 9000.0])
def test_plates_in_water_keep_the_energy(fd, angle):
    r, t = plates.in_fluid(STEEL, WATER, fd, angle)
    assert abs(r) ** 2 + abs(t) ** 2 == pytest.approx(1, abs=1e-12)


def test_gas_crosses_plates_where_free_waves_run():
    """Whole at the angles of the zeros of Lamb's equation, and hardly a thousandth of a radian beside them."""
    gas = (0.1, 343.0)
    zeros = solids.lamb(3000.0, STEEL)
    assert len(zeros) == 4
    for slow in zeros:
        angle = math.degrees(math.asin(slow * gas[1]))
        assert abs(plates.in_fluid(STEEL, gas, 3000.0, angle)[1]) == pytest.approx(1, abs=1e-6)
        for beside in (angle - 0.06, angle + 0.06):
            assert abs(plates.in_fluid(STEEL, gas, 3000.0, beside)[1]) < 0.05


def test_plates_of_slow_shear_waves_are_layers_of_a_fluid():
    """In the limit, and exactly at normal incidence: r and t of a layer between two faces, each crossed ever again."""
    for solid, angle, difference in ((STEEL, 0.0, 1e-12), ((7900.0, 5900.0, 1 - 0.05j), 12.0, 1e-6)):
        w = 2 * math.pi * 2000.0
        kx = w / WATER[1] * math.sin(math.radians(angle))
        face, turn = layers.face(WATER, solid[:2], w, kx), cmath.exp(1j * layers.along_z(solid[:2], w, kx))
        r, t = plates.in_fluid(solid, WATER, 2000.0, angle)
        whole = 1 - face**2 * turn**2
        assert r == pytest.approx(face * (1 - turn**2) / whole, abs=difference)
        assert t == pytest.approx((1 - face**2) * turn / whole, abs=difference)


def test_rayleigh_waves_of_closed_form():
    """Of ratios 3 and 2 of cL^2 to cT^2, and the wave that a fluid of no density leaves."""
    assert solids.rayleigh((1.0, math.sqrt(3), 1.0)) == pytest.approx(solids.rayleigh_of_poisson_solid(), rel=1e-14)
    assert solids.rayleigh((1.0, math.sqrt(2), 1.0)) == pytest.approx(math.sqrt(3 - math.sqrt(5)), rel=1e-14)
    free = solids.leaky_rayleigh(STEEL, (0.0, 1480.0))
    assert 1 / free == pytest.approx(solids.rayleigh(STEEL), rel=1e-12)


def test_backward_and_forward_wave_of_the_package_are_told_apart():
    """Between its point of no group velocity and its cut-off S1 runs both ways: pairs move apart from the point on."""
    fd, kd = plates.zero_group_velocity(STEEL)
    (near, middle), (far, beside) = (section.pair(STEEL, fd * share) for share in (1.001, 1.002))
    assert 2 * middle - beside == pytest.approx(kd, rel=1e-4)
    assert far / near == pytest.approx(2, rel=0.05)
    below, _ = section.pair(STEEL, fd * 0.999)
    assert below == pytest.approx(-near, rel=0.05)
