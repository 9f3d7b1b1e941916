"""Turns of functions along outlines of boxes: zeros less poles inside, and outlines that go around once."""

import numpy as np
import pytest

from beamprop.modes import argument_principle

F = 2500.0
K0 = 2 * np.pi * F / 343


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("near", [None, 3.0])
def test_turns_about_zeros_that_are_known(seed, near):
    """Rational functions with up to 12 zeros and poles, in boxes of all shapes: zeros less poles inside."""
    rng = np.random.default_rng(seed)
    box = argument_principle.Box(-rng.random(), 4 + 40 * rng.random(), -rng.random(), 20 * rng.random() ** 3)
    zeros, poles = (
        rng.uniform(box.left - 1, box.right + 1, n) + 1j * rng.uniform(box.low - 1, box.high + 1, n)
        for n in rng.integers(0, 12, 2)
    )

    def f(k):
        value = np.prod(k[..., None] - zeros, axis=-1) / np.prod(k[..., None] - poles, axis=-1)
        return value, np.zeros(k.shape)

    wanted = sum(box.holds(k, 0.0) for k in zeros) - sum(box.holds(k, 0.0) for k in poles)
    path = box.outline(48, near)
    assert argument_principle.winding(f, path, 1e-9) == wanted
    several = np.stack([path, path + 1.0, path - 100.0])
    assert argument_principle.windings(
        lambda k, owner: f(k - np.array([0.0, 1.0, 0.0])[owner][:, None]), several, 1e-9
    )[:2].tolist() == [wanted, wanted]


def test_turns_about_pairs_of_zeros_beside_the_outline():
    """Zeros at distances of 1e-4 to 10 rad/m from the long sides of a box of the search, two of them close together."""
    for seed in range(200):
        rng = np.random.default_rng(seed)
        width, depth, m = rng.uniform(80, 250), rng.uniform(3, 12), int(rng.integers(2, 12))
        box = argument_principle.Box(0.05, width, -depth, 0.0)
        beside = 10 ** rng.uniform(-4, 1, m) * rng.choice([-1, 1], m)
        zeros = rng.uniform(0, width, m) + 1j * (rng.choice([0, -depth], m) + beside)
        zeros[1] = zeros[0] + 10 ** rng.uniform(-4, 0.5) * np.exp(2j * np.pi * rng.random())

        def f(k, zeros=zeros):
            return np.prod(k[..., None] - zeros, axis=-1), np.zeros(k.shape)

        wanted = sum(box.holds(k, 0.0) for k in zeros)
        assert argument_principle.winding(f, box.outline(48, K0), 1e-9 * width) == wanted, seed


@pytest.mark.parametrize("nodes", [1, 5, 24])
def test_outlines_go_around_once(nodes):
    """Corners in turn, counter-clockwise, each side from corner to corner; more nodes beside a branch point."""
    left, right, low, high = np.array([1.0, 2.0]), np.array([9.0, 4.0]), np.array([-1.0, -3.0]), np.array([0.0, 0.5])
    for near in (None, np.array([3.0, 30.0])):
        paths = argument_principle.outlines(left, right, low, high, nodes, near)
        for path, a, b, c, d in zip(paths, left, right, low, high, strict=True):
            corners = [a + 1j * c, b + 1j * c, b + 1j * d, a + 1j * d]
            assert [int(np.argmax(path == k)) for k in corners] == sorted(int(np.argmax(path == k)) for k in corners)
            assert all(np.any(path == k) for k in corners)
            step = np.diff(np.append(path, path[0]))
            assert np.all((step.real == 0) | (step.imag == 0))
            assert np.sum(np.conj(path - corners[0]) * step).imag / 2 == pytest.approx((b - a) * (d - c))
            assert np.abs(step).sum() == pytest.approx(2 * (b - a + d - c))
