"""Where depths lie in a slab: against exact fractions."""

from fractions import Fraction

import numpy as np
import pytest

import beamprop as bp
from beamprop.media.values import slab_values
from beamprop.response.layer import State
from beamprop.response.recursion import carry_back, places_of

FREQUENCY = 1800.0
CELL = bp.lmmd_cell()


def exact_place(layers, depth):
    """Period, layer and the share behind a depth, as fractions."""
    thickness = [Fraction(float(v)) for v in layers.thickness]
    total = sum(thickness)
    period = depth // total
    left = depth - period * total
    for i, d in enumerate(thickness):
        if left < d:
            return int(period), i, 1 - left / d
        left -= d
    raise AssertionError


@pytest.mark.parametrize("periods", [7, 100_000])
def test_depths_in_periods(periods):
    """Behind 100 000 of them the rounding of their number times their thickness was 1e-10 of a layer, and p in heavy ones off by 4e-10."""
    slab = bp.Slab(CELL, periods)
    (values,) = slab_values(slab, np.array([FREQUENCY]))
    z = slab.thickness * np.random.default_rng(3).random(200)
    places = places_of(values, z)
    for depth, period, layer, share in zip(z, *places, strict=True):
        known = exact_place(values.layers, Fraction(float(depth)))
        assert (period, layer) == known[:2]
        assert share == pytest.approx(float(known[2]), abs=1e-13)


def test_segments_begin_where_the_sum_of_all_before_them_is():
    slab = bp.Slab(bp.Layer(bp.AIR, 0.1)) + bp.Slab(CELL, 33_333) + bp.Slab(CELL, 7)
    segments = slab_values(slab, np.array([FREQUENCY]))
    one = np.ones((1, 1), complex)
    _, stations = carry_back(
        segments, np.array([[2 * np.pi * FREQUENCY]]), 10 * one, State(one, one, 0 * one), np.array([0.05])
    )
    begin = Fraction(0)
    for station, segment in zip(stations, segments, strict=True):
        assert station.start == float(begin)
        begin += segment.periods * sum(Fraction(float(v)) for v in segment.layers.thickness)


@pytest.mark.parametrize("side", [-1, 0, 1])
@pytest.mark.filterwarnings("error::beamprop.AccuracyWarning")
def test_rounding_of_a_depth_does_not_decide_on_which_side_of_a_membrane_it_lies(side):
    """p jumps over one; on it and a last place in front it is that behind, between periods and at the slab's end, without a warning."""
    slab = bp.Slab([bp.Layer(bp.Fluid(2.0, 3e5), 2.5e-3), bp.Layer(bp.AIR, 1e-3), bp.Membrane(0.3)], 5)
    beam, z = bp.GaussianBeam(0.1, z0=-0.1), np.array([3.5e-3, 1.05e-2, 1.75e-2])
    moved = z if side == 0 else np.nextafter(z, side * np.inf)
    p, behind = (bp.field(slab, beam, FREQUENCY, [0.0, 0.01], at).p.values for at in (moved, z * (1 + 1e-9)))
    np.testing.assert_allclose(p, behind, rtol=1e-5)
