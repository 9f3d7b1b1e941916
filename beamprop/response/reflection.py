"""r and t from the two waves of each medium: the form that keeps full precision where the recursion of (p, q) cancels.

In a medium with the waves u = q/p = +-i kz/rho_z =: +-i Y the state is (a + b, i Y (a - b)). Across a face, from the medium
behind (Y') to the one in front (Y), ::

    a = (S a' + D b') / 2 Y,   b = (D a' + S b') / 2 Y,   S = Y + Y',   D = Y - Y',

and back through a layer a gains exp(-i kz d), b exp(+i kz d). The recursion of (p, q) rounds p and q to EPS of their sizes, that
is, it adds EPS of every wave to every other: an error that grows by exp(2 |kz| d) in a layer behind which the physical
wave is the one that decays on the way back, as it does where S is nearly 0 (surfaces of negative density or modulus). Here waves do not
mix but by S and D, so it is enough to have those to a relative EPS. The smaller one is a quotient of differences of
material data, S D = Y^2 - Y'^2, formed without cancellation between equal or opposite materials (`_squares_differ`). What
cancels then in S a' + D b' is a resonance, which the last bits of thickness and material move as well.

Errors: EPS (relative) of each S, D and exp(i kz d), and EPS of the terms of Y^2 - Y'^2. `reflect` takes a `shift` that
perturbs just these, so that a second evaluation shows what they do. Where kz d -> 0 in a layer, the two waves are one and the
form itself loses precision; the recursion of (p, q) is used there.

Segments of many periods enter as one medium with their Bloch waves, q/p to EPS.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ..conventions import outgoing_kz
from ..media.fluids import FluidValues
from ..media.values import Materials, SegmentValues
from .cell import Matrix, cell_matrix
from .layer import perturbed
from .periods import BlochPhase, bloch_phase

#: Periods times layers up to which a segment is taken layer by layer; beyond, by its Bloch waves.
EXPANDED = 2048


class Medium(NamedTuple):
    """Two waves, one each way: q/p of each, and i times the phase of the forward one from near to far face (Re <= 0).

    `fluid` is given where the medium is uniform; `mass` is that of the membranes on its far face.
    """

    forward: np.ndarray
    backward: np.ndarray
    exponent: np.ndarray
    fluid: FluidValues | None
    mass: complex = 0.0


class Stack(NamedTuple):
    """A slab at one frequency: its segments as layers (1 frequency) and as materials, and the half-spaces, arrays (1,)."""

    segments: list[SegmentValues]
    materials: list[Materials]
    before: FluidValues
    after: FluidValues
    omega: float


#: What a wave from behind (forward, backward) adds in front to the forward one (first pair) and to the backward one.
Face = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def reflect(stack: Stack, kx: np.ndarray, shift: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """r and t of plane waves kx (n,); with `shift` each term perturbed by that share of it, to see what rounding does.

    Terms that come again (periods) are perturbed alike, as their rounding is the same. Not finite where a medium's two waves
    coincide.
    """
    turns = _turns(shift)
    faces: dict[tuple[int, int], Face] = {}
    with np.errstate(all="ignore"):
        *media, far = _media(stack, kx, shift, turns)
        a, b, log = np.ones(kx.shape, complex), np.zeros(kx.shape, complex), np.zeros(kx.shape, complex)
        for near in reversed(media):
            pair = id(near), id(far)
            if pair not in faces:
                faces[pair] = _face(near, far, stack.omega, kx, turns)
            a_to_a, b_to_a, a_to_b, b_to_b = faces[pair]
            a, b = a_to_a * a + b_to_a * b, a_to_b * a + b_to_b * b
            b *= np.exp(2 * near.exponent)
            size = np.abs(a) + np.abs(b)
            size = np.where((size > 0) & np.isfinite(size), size, 1.0)
            a, b, log = a / size, b / size, log - near.exponent + np.log(size)
            far = near
        return b / a, np.exp(-log) / a


def _turns(shift: float) -> Iterator[complex]:
    """1 + shift times numbers of size 1 in all directions, without end."""
    rng = np.random.default_rng(1)
    while True:
        yield 1 + shift * complex(np.exp(2j * np.pi * rng.random()))


def _media(stack: Stack, kx: np.ndarray, shift: float, turns: Iterator[complex]) -> list[Medium]:
    """All media, the half-spaces among them."""
    media = [_half_space(stack.before, stack.omega, kx)]
    for segment, materials in zip(stack.segments, stack.materials, strict=True):
        (rho_z, _, _), thickness, membrane = materials
        periods = segment.periods
        if not membrane.any() and all(np.all(v == v[0]) for v in materials.fluid):
            media.append(_uniform(_row(materials, 0), periods * float(thickness.sum()), stack.omega, kx, turns))
        elif periods > 1 and periods * thickness.size > EXPANDED:
            media.append(_bloch(perturbed(segment, shift), stack.omega, kx))
        else:
            rows = list(zip(*(v[:, 0].tolist() for v in materials.fluid), thickness.tolist(), strict=True))
            made = {
                row: _uniform(_row(materials, j), float(thickness[j]), stack.omega, kx, turns)
                for row, j in {row: j for j, row in enumerate(rows)}.items()
            }
            for j in periods * list(range(thickness.size)):
                if membrane[j]:
                    media[-1] = media[-1]._replace(mass=media[-1].mass + complex(rho_z[j, 0]))
                else:
                    media.append(made[rows[j]])
    return [*media, _half_space(stack.after, stack.omega, kx)]


def _row(materials: Materials, j: int) -> FluidValues:
    return FluidValues(*(v[j] for v in materials.fluid))


def _half_space(fluid: FluidValues, omega: float, kx: np.ndarray) -> Medium:
    wave = 1j * outgoing_kz(kx, omega, *fluid) / fluid.rho_z
    return Medium(wave, -wave, np.zeros(kx.shape, complex), fluid)


def _uniform(fluid: FluidValues, thickness: float, omega: float, kx: np.ndarray, turns: Iterator[complex]) -> Medium:
    rho_z, rho_x, K = fluid
    kz = np.sqrt(rho_z * (omega * omega / K - kx * kx * _inverse(rho_x)))
    kz = np.where(kz.imag < 0, -kz, kz)
    return Medium(1j * kz / rho_z, -1j * kz / rho_z, 1j * kz * thickness * next(turns), fluid)


def _inverse(rho: np.ndarray) -> np.ndarray:
    """1/rho, 0 for infinite rho."""
    return np.divide(1, rho, out=np.zeros(rho.shape, complex), where=np.isfinite(rho))


def _bloch(segment: SegmentValues, omega: float, kx: np.ndarray) -> Medium:
    """A segment of many periods by its Bloch waves, eigenvectors (1, q/p) of the cell's matrix."""
    m = cell_matrix(segment.layers, np.array([[omega]]), kx[None])
    b = bloch_phase(m)
    phase = b.phase[0]
    return Medium(_ratio(m, b, 1), _ratio(m, b, -1), 1j * phase * segment.periods, None)


def _ratio(m: Matrix, b: BlochPhase, way: int) -> np.ndarray:
    """q/p of the Bloch wave whose p and q gain exp(+-i phase) over a period."""
    # with x = exp(+-i phase) - a:  (x - e11) p = e12 q  and  (x - e22) q = e21 p; the one whose bracket does not cancel
    exponent = way * 1j * b.reduced[0]
    less = np.where(b.flip[0], -np.expm1(exponent) - 2, np.expm1(exponent))
    x = less if m.growth is None else np.where(m.growth > 0, np.exp(exponent - m.growth) - m.a, less)[0]
    x = np.reshape(x, b.reduced[0].shape)
    by_p, by_q = x - m.e11[0], x - m.e22[0]
    return np.where(np.abs(by_p) > np.abs(by_q), by_p / m.e12[0], m.e21[0] / by_q)


def _face(near: Medium, far: Medium, omega: float, kx: np.ndarray, turns: Iterator[complex]) -> Face:
    """What becomes of waves from behind in front of a face."""
    if near.fluid is not None and far.fluid is not None:
        plus, minus = _sum_and_difference(near, far, omega, kx, turns)
        a_to_a, b_to_b, b_to_a, a_to_b = plus, plus, minus, minus
    else:
        a_to_a, b_to_a = far.forward - near.backward, far.backward - near.backward
        a_to_b, b_to_b = near.forward - far.forward, near.forward - far.backward
    if near.mass:  # p in front is p - mass q
        a_to_a = a_to_a + near.mass * near.backward * far.forward
        b_to_a = b_to_a + near.mass * near.backward * far.backward
        a_to_b = a_to_b - near.mass * near.forward * far.forward
        b_to_b = b_to_b - near.mass * near.forward * far.backward
    apart = near.forward - near.backward
    first, second, third, fourth = (v * (next(turns) / apart) for v in (a_to_a, b_to_a, a_to_b, b_to_b))
    return first, second, third, fourth


def _sum_and_difference(
    near: Medium, far: Medium, omega: float, kx: np.ndarray, turns: Iterator[complex]
) -> tuple[np.ndarray, np.ndarray]:
    """i S and i D of two uniform media, the smaller one without cancellation."""
    assert near.fluid is not None
    assert far.fluid is not None
    plus, minus = near.forward + far.forward, near.forward - far.forward
    product, terms = _squares_differ(near.fluid, far.fluid, omega, kx)
    product = product + terms * (next(turns) - 1)
    # a turn takes i Y to its square: (i S)(i D) = -(Y^2 - Y'^2)
    larger = np.where(np.abs(plus) < np.abs(minus), minus, plus)
    smaller = np.where(product == 0, 0.0, -product / np.where(larger == 0, 1.0, larger))
    return np.where(np.abs(plus) < np.abs(minus), smaller, plus), np.where(np.abs(plus) < np.abs(minus), minus, smaller)


def _squares_differ(near: FluidValues, far: FluidValues, omega: float, kx: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Y^2 - Y'^2 with Y^2 = w^2/(rho_z K) - kx^2/(rho_z rho_x), and the size of its terms."""
    still, still_size = _inverses_differ(near.rho_z, near.bulk_modulus, far.rho_z, far.bulk_modulus)
    moved, moved_size = _inverses_differ(near.rho_z, near.rho_x, far.rho_z, far.rho_x)
    w2, k2 = omega * omega, kx * kx
    return w2 * still - k2 * moved, w2 * still_size + np.abs(k2) * moved_size


def _inverses_differ(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """1/(a b) - 1/(c d), without cancellation where a and b are near to +-c and +-d, and the size of its terms."""
    if not (np.all(np.isfinite(b)) and np.all(np.isfinite(d))):
        one, two = _inverse(b) / a, _inverse(d) / c
        return one - two, np.where(one == two, 0.0, np.abs(one) + np.abs(two))
    sign = np.where(np.abs(c - a) <= np.abs(c + a), 1.0, -1.0)
    # c d - a b = (c - s a) d + s a (d - s b)
    first, second = (c - sign * a) / (a * b * c), (d - sign * b) * sign / (b * c * d)
    return first + second, np.abs(first) + np.abs(second)
