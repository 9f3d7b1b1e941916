"""Layers to the matrix of a cell; `periods.py` has its powers in closed form.

Matrices are kept as ``exp(growth) (a I + E)``: for a thin cell a = 1, growth = 0 and E is small, so that ``trace/2 - 1``, and
with it the Bloch phase, has full relative precision; for an opaque one a = exp(-growth) underflows harmlessly.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ..arrays.matmul import BLOCK, small_product
from ..media.solids import SolidBlock
from ..media.values import LayerValues
from .layer import State, at_frequencies, one_layer, several_layers
from .solid_run import run_matrix

#: Entries of matrices are kept below this.
LARGE = 1e60


class Matrix(NamedTuple):
    """exp(growth) (a I + [[e11, e12], [e21, e22]]), determinant 1."""

    a: np.ndarray | float
    e11: np.ndarray
    e12: np.ndarray
    e21: np.ndarray
    e22: np.ndarray
    growth: np.ndarray | None


def _renormalised(m: Matrix) -> Matrix:
    """Take size out of a matrix whose entries would overflow in the next products."""
    size = np.abs(m.e11) + np.abs(m.e12) + np.abs(m.e21) + np.abs(m.e22)
    large = size > LARGE
    if not np.any(large):
        return m
    size = np.where(large, size, 1.0)
    growth = np.log(size) + (0.0 if m.growth is None else m.growth)
    return Matrix(m.a / size, m.e11 / size, m.e12 / size, m.e21 / size, m.e22 / size, growth)


def times(near: Matrix, far: Matrix) -> Matrix:
    """The product far x near."""
    # E = a_far E_near + a_near E_far + E_far E_near, where a = 1 unless something grows
    e11 = far.e11 * near.e11
    e11 += far.e12 * near.e21
    e12 = far.e11 * near.e12
    e12 += far.e12 * near.e22
    e21 = far.e21 * near.e11
    e21 += far.e22 * near.e21
    e22 = far.e21 * near.e12
    e22 += far.e22 * near.e22
    if near.growth is None and far.growth is None:
        for e, e_near, e_far in zip((e11, e12, e21, e22), near[1:5], far[1:5], strict=True):
            e += e_near
            e += e_far
        return _renormalised(Matrix(1.0, e11, e12, e21, e22, None))
    for e, e_near, e_far in zip((e11, e12, e21, e22), near[1:5], far[1:5], strict=True):
        e += far.a * e_near
        e += near.a * e_far
    growth = sum((m.growth for m in (near, far) if m.growth is not None), start=np.zeros(()))
    return _renormalised(Matrix(far.a * near.a, e11, e12, e21, e22, growth))


def _mapped(m: Matrix, function: Callable[[np.ndarray], np.ndarray]) -> Matrix:
    """A matrix with a function applied to each of its arrays."""
    mapped: list[Any] = [function(v) if isinstance(v, np.ndarray) else v for v in m]
    return Matrix(*mapped)


def _with_growth(m: Matrix) -> Matrix:
    """A matrix with its growth as an array."""
    return m if m.growth is not None else m._replace(a=np.ones(m.e11.shape), growth=np.zeros(m.e11.shape))


def _joined(m: Matrix, last: Matrix) -> Matrix:
    """Two stacks of matrices, concatenated along their first axis."""
    if m.growth is not None or last.growth is not None:
        m, last = _with_growth(m), _with_growth(last)
    pairs: Any = zip(m, last, strict=True)
    joined: list[Any] = [np.concatenate([a, b]) if isinstance(a, np.ndarray) else a for a, b in pairs]
    return Matrix(*joined)


def _layer_product(layers: LayerValues, omega: np.ndarray, kx2: np.ndarray, kx: np.ndarray) -> Matrix:
    """`reference.cell_matrix`, all layers at once and then pair by pair: (F, n)."""
    A, B, f = several_layers(layers, slice(None), omega * omega, kx2)
    m = Matrix(f.a, f.c, A * f.s, -B * f.s, f.c, f.growth)
    if layers.solids:
        m = m._replace(e22=m.e22.copy())  # it is e11 in a fluid
    for slot, run in layers.solids:
        m = _with_row(m, slot, solid_matrix(run, omega, kx))
    while (count := m.e11.shape[0]) > 1:
        even = count - count % 2
        pairs = times(_mapped(m, lambda v: v[0:even:2]), _mapped(m, lambda v: v[1:even:2]))  # noqa: B023
        m = _joined(pairs, _mapped(m, lambda v: v[even:])) if count % 2 else pairs  # noqa: B023
    return _mapped(m, lambda v: v[0])


def solid_matrix(run: tuple[SolidBlock, ...], omega: np.ndarray, kx: np.ndarray) -> Matrix:
    """The matrix of a run of solids."""
    f = run_matrix(run, omega, kx)
    inverse = 1 / np.where(f.divisor == 0, TINIEST, f.divisor)
    e11, e12, e21, e22 = (v * inverse for v in f[:4])
    if not np.any(f.growth):
        return Matrix(1.0, e11, e12, e21, e22, None)
    return Matrix(np.exp(-f.growth), e11, e12, e21, e22, f.growth)


#: Stands for a divisor of exactly 0.
TINIEST = 1e-150


def layer_matrix(layers: LayerValues, j: int, omega: np.ndarray, kx: np.ndarray) -> Matrix:
    """The matrix of layer j, or of the run of solids that stands there."""
    for slot, run in layers.solids:
        if slot == j:
            return solid_matrix(run, omega, kx)
    A, B, f = one_layer(layers, j, omega * omega, kx * kx)
    return Matrix(f.a, f.c, A * f.s, -B * f.s, f.c, f.growth)


def _with_row(m: Matrix, row: int, new: Matrix) -> Matrix:
    """A stack of matrices with one of them replaced."""
    if new.growth is not None or m.growth is not None:
        m, new = _with_growth(m), _with_growth(new)
    for old, value in zip(m, new, strict=True):
        if isinstance(old, np.ndarray):
            old[row] = value
    return m


def cell_matrix(layers: LayerValues, omega: np.ndarray, kx: np.ndarray) -> Matrix:
    """Matrix of one period, near to far face: a polynomial in kx^2 where that is as exact, else layer by layer.

    The polynomial makes 1.5 times as many widths a second (`beam_width`, 101 frequencies).
    """
    kx2 = np.broadcast_to(kx * kx, np.broadcast_shapes(omega.shape, kx.shape)).astype(complex, copy=False)
    count = len(layers.thickness)
    kx = np.broadcast_to(kx, kx2.shape)
    many = kx2.shape[1] >= 2 * CIRCLE and kx2.size * count >= POLYNOMIAL_FROM and not layers.solids
    if many and (fitted := _fitted(layers, omega, kx2)) is not None:
        return fitted
    block = max(1, BLOCK // count)
    if kx2.size <= block:
        return _layer_product(layers, omega, kx2, kx)
    out = np.empty((4, *kx2.shape), complex)
    a, growth = np.ones(kx2.shape), np.zeros(kx2.shape)
    columns = min(kx2.shape[1], max(64, block // kx2.shape[0]))
    rows = max(1, block // columns)
    for i, j in itertools.product(range(0, kx2.shape[0], rows), range(0, kx2.shape[1], columns)):
        part = slice(i, i + rows), slice(j, j + columns)
        m = _layer_product(at_frequencies(layers, part[0]), omega[part[0]], kx2[part], kx[part])
        out[:, *part] = m[1:5]
        if m.growth is not None:
            a[part], growth[part] = m.a, m.growth
    e11, e12, e21, e22 = out
    return Matrix(a, e11, e12, e21, e22, growth) if np.any(growth) else Matrix(1.0, e11, e12, e21, e22, None)


#: Layers times kx from which on the polynomial takes less time than the product of the layers.
POLYNOMIAL_FROM = 2**12
#: Points on the circle from which the Taylor coefficients of a cell's matrix are taken; one more than the highest degree.
CIRCLE = 14


def _fitted(layers: LayerValues, omega: np.ndarray, kx2: np.ndarray) -> Matrix | None:
    """The cell's matrix from its Taylor series in v = kx^2, or None where it does not keep full precision.

    E(v) is entire, so with E on the circle |v| = R around all requested points, Cauchy's integral by the trapezoid rule
    gives the coefficients: ``c_k = mean(E(v_m) v_m^-k)``. They decay to the rounding of E (4e-15 of the largest); two more
    are kept and smaller ones are left out. Errors: rounding, EPS times the largest E on the circle, which is kept
    within a few times the rounding error of the layers at v = 0 (`_circle_is_calm`); aliasing is smaller still.
    """
    radius = np.max(np.abs(kx2), axis=-1, keepdims=True)
    radius = np.where(radius > 0, radius, 1.0)
    if not np.all(_circle_is_calm(layers, omega * omega, radius)):
        return None
    turn = np.exp(2j * np.pi * np.arange(CIRCLE) / CIRCLE)
    m = _layer_product(layers, omega, radius * turn, np.sqrt(radius * turn))
    if m.growth is not None:
        return None
    coefficients = np.fft.fft(np.stack(m[1:5], axis=1), axis=-1) / CIRCLE  # (F, 4, CIRCLE), of v/R
    size = np.max(np.abs(coefficients), axis=0)
    noise = np.all(size <= 4e-15 * size.max(axis=-1, keepdims=True), axis=0)
    degree = 2 + int(np.argmax(noise[:-1] & noise[1:]))
    if degree > CIRCLE - 4 or not np.any(noise[:-1] & noise[1:]):
        return None
    out = np.empty((4, *kx2.shape), complex)
    rows = max(1, BLOCK // (kx2.shape[1] * (degree + 1)))
    for start in range(0, kx2.shape[0], rows):
        part = slice(start, start + rows)
        _polynomials(coefficients[part, :, : degree + 1], kx2[part] * (1 / radius[part]), out[:, part])
    e11, e12, e21, e22 = out
    return Matrix(1.0, e11, e12, e21, e22, None)


def _circle_is_calm(layers: LayerValues, omega2: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Whether E on the circle is of order 1, and its rounding error not much larger than at kx = 0: (F, 1)."""
    mass, compliance, mobility = (np.abs(v).sum(0)[:, None] for v in (layers.mass, layers.compliance, layers.mobility))
    inertial, lateral = np.abs(omega2) * compliance, radius * mobility
    return (mass * (inertial + lateral) < 4) & (lateral < 4 * inertial) & ~np.any(layers.vanishing, axis=0)[:, None]


def _polynomials(coefficients: np.ndarray, v: np.ndarray, out: np.ndarray) -> None:
    """Four polynomials (F, 4, degree + 1) at v (F, n) into out (4, F, n), powers times coefficients."""
    powers = np.ones((v.shape[0], coefficients.shape[-1], v.shape[1]), complex)
    for k in range(1, powers.shape[1]):
        np.multiply(powers[:, k - 1], v, out=powers[:, k])
    for i in range(v.shape[0]):
        out[:, i] = small_product(coefficients[i], powers[i])


def matrix_back(m: Matrix, far: State) -> State:
    """Carry a state back through a matrix of determinant 1."""
    p = m.a * far.p + (m.e22 * far.p - m.e12 * far.q)
    q = m.a * far.q + (m.e11 * far.q - m.e21 * far.p)
    return State(p, q, far.log if m.growth is None else far.log + m.growth)
