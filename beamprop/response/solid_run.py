"""A run of solid layers between two fluids: to a fluid it is a matrix of determinant 1, as a layer of fluid is.

With T = 0 on both faces X is eliminated from the 4 x 4 matrix Y of the run (near to far face): M = minors of Y over its entry Y_TX. M has
poles in kx, where the run would shear freely between clamped faces; the minors have none. So states are carried back by the
minors, and the divisor goes into the logarithm, from which `response.slab.dispersion` takes it out again.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ..media.solids import SolidBlock, SolidLayers
from .layer import State
from .solid_layer import TOGETHER, Along, Basis, basis, layers_back, media
from .solid_power import block_back
from .solids import Minors, Vector, minors_back, of_fluid, to_fluid, vector_back

#: Logarithm of a divisor of exactly 0: nothing passes.
NOTHING = -1e5


class RunMatrix(NamedTuple):
    """M = (exp(-growth) D I + F)/D times exp(growth), F being F11, F12, F21, F22; the divisor is D exp(log)."""

    f11: np.ndarray
    f12: np.ndarray
    f21: np.ndarray
    f22: np.ndarray
    divisor: np.ndarray
    log: np.ndarray
    growth: np.ndarray


def run_matrix(run: tuple[SolidBlock, ...], omega: np.ndarray, kx: np.ndarray) -> RunMatrix:
    """The matrix of a run at omega (F, 1) and kx (F, n)."""
    if _single(run):
        return _plate(_share(run[0].layers, 0, omega, Along(kx)))
    one, zero = np.ones(np.broadcast_shapes(omega.shape, kx.shape), complex), 0.0
    ends = of_fluid(one, zero * one, zero * one.real), of_fluid(zero * one, one, zero * one.real)
    (by_p, by_q), (v,) = through(run, omega, kx, ends, (_clamped(omega, kx),))
    size = np.maximum(by_p.log, by_q.log)
    (n11, n21), (n12, n22) = (
        tuple(c * np.exp(m.log - size) for c in to_fluid(m)) for m in (by_p, by_q)
    )  # fmt: skip
    growth = size - v.log
    with np.errstate(over="ignore"):
        whole = v.T * np.exp(-growth)
    return RunMatrix(n22 - whole, -n12, -n21, n11 - whole, v.T, v.log, growth)


def run_back(run: tuple[SolidBlock, ...], omega: np.ndarray, kx: np.ndarray, far: State) -> State:
    """Carry the state of the fluid behind a run back to the fluid in front."""
    if _single(run):
        m = run_matrix(run, omega, kx)
        whole = m.divisor * np.exp(-m.growth)
        p = whole * far.p + (m.f22 * far.p - m.f12 * far.q)
        q = whole * far.q + (m.f11 * far.q - m.f21 * far.p)
        return _in_size(p, q, far.log + m.growth, m.divisor)
    (near,), (v,) = through(run, omega, kx, (of_fluid(far.p, far.q, far.log),), (_clamped(omega, kx),))
    p, q = to_fluid(near)
    return _in_size(p, q, near.log - v.log, v.T)


def run_divisor(run: tuple[SolidBlock, ...], omega: np.ndarray, kx: np.ndarray) -> np.ndarray:
    """The logarithm of Y_TX."""
    if _single(run):
        m = run_matrix(run, omega, kx)
        return logarithm(m.divisor) + m.log
    _, (v,) = through(run, omega, kx, (), (_clamped(omega, kx),))
    return logarithm(v.T) + v.log


def logarithm(value: np.ndarray) -> np.ndarray:
    """log of a divisor that may vanish."""
    return np.log(np.where(value == 0, 1.0, value)) + np.where(value == 0, NOTHING, 0.0)


def inside_run(
    run: tuple[SolidBlock, ...], omega: np.ndarray, kx: np.ndarray, far: State, behind: np.ndarray
) -> Vector:
    """The state at depths `behind` (Z,) [m] in front of the far face, for the state of the fluid there: (Z, n) each.

    `far` is (1, n), or (Z, n) with a state for each depth.
    """
    out = interior(run, omega, kx, of_fluid(far.p, far.q, far.log), behind)
    return out._replace(log=out.log - run_divisor(run, omega, kx))


def interior(run: tuple[SolidBlock, ...], omega: np.ndarray, kx: np.ndarray, far: Minors, behind: np.ndarray) -> Vector:
    """The state in front of the far face as in `inside_run`, for the minors there, (1, n) or (Z, n); not over the run's divisor."""
    layers = [(b.layers, j) for b in run for _ in range(b.periods) for j in range(b.layers.thickness.size)]
    far_faces = np.cumsum([0.0, *(float(v.thickness[j]) for v, j in reversed(layers))])[::-1]
    owner = np.clip(np.searchsorted(-far_faces[1:], -behind, side="left"), 0, len(layers) - 1)
    out = Vector._make(np.empty((5, behind.size, kx.shape[-1]), complex))
    rows = [np.arange(behind.size)] if far.a.shape[0] == 1 else [np.array([i]) for i in range(behind.size)]
    for group in rows:
        minors = Minors(*(v if v.shape[0] == 1 else v[group] for v in far))
        for here, v in _through(layers, omega, kx, minors, behind[group], owner[group], far_faces):
            for whole, part in zip(out, v, strict=True):
                whole[group[here]] = part
    return out


#: kx [s/m, times w] that stands for 0: its square is below the rounding of any layer's kx^2.
SLIGHT = 1e-15


def without_zero(kx: np.ndarray, omega: np.ndarray) -> np.ndarray:
    """kx with a slight value for 0: X and T, odd in kx, are told over kx."""
    return np.where(kx == 0, SLIGHT * np.abs(omega), kx)


def quantity_of(v: Vector, quantity: str, omega: np.ndarray, kx: np.ndarray) -> np.ndarray:
    """p, v_z, or v_x or s_xz over kx (not 0) of a state, without its logarithm."""
    if quantity == "p":
        return v.p
    if quantity == "v_z":
        return -1j * v.q / omega
    return v.X / (kx * omega) if quantity == "v_x" else 1j * v.T / kx


def _through(
    layers: list,
    omega: np.ndarray,
    kx: np.ndarray,
    far: Minors,
    behind: np.ndarray,
    owner: np.ndarray,
    faces: np.ndarray,
) -> Iterator[tuple[np.ndarray, Vector]]:
    """Indices of the depths in each layer, and the state there, before the run's divisor."""
    minors, along = [far], Along(kx)
    for v, j in reversed(layers):
        minors.append(minors_back(minors[-1], _share(v, j, omega, along)))
    minors = minors[::-1]
    near = minors[0]
    state = Vector(near.q12, -near.q11, near.b, 0 * near.b, near.log)
    for i in range(int(owner.max()) + 1):
        v, j = layers[i]
        here = np.flatnonzero(owner == i)
        if here.size:
            rest = (np.clip((behind[here] - faces[i + 1]) / v.thickness[j], 0.0, 1.0))[:, None]
            at = minors_back(minors[i + 1], _share(v, j, omega, along, rest))
            yield here, _ahead(state, minors[i], at, _share(v, j, omega, along, 1 - rest))
        state = _ahead(state, minors[i], minors[i + 1], _share(v, j, omega, along))


def _share(layers: SolidLayers, j: int, omega: np.ndarray, along: Along, share: np.ndarray | float = 1.0) -> Basis:
    """`share` of layer j."""
    return basis(media(layers, slice(j, j + 1), omega, along, share)[0], along)


#: The components of a state, and the pairs whose minors tell two of them from the others.
PAIRS = ((0, 1), (2, 3), (0, 2), (0, 3), (1, 2), (1, 3))


def _ahead(y: Vector, near: Minors, at: Minors, between: Basis) -> Vector:
    """A solution's state where the allowed solutions have the minors `at`, from its state y where they have the minors `near`.

    Two components of y, as functionals of the state ahead, fix it among the allowed solutions; of all pairs the one with the largest
    minor is taken. No growing solution enters.
    """
    unit = np.eye(4)
    shape = np.broadcast_shapes(between.a2.shape, y.p.shape)
    functionals = []
    for i in range(4):
        # rows of the matrix back: its transpose is itself with the blocks (p, X) and (q, T) exchanged
        p, X, q, T = (np.full(shape, c, complex) for c in np.roll(unit[i], 2))
        v = vector_back(Vector(p, X, q, T, np.zeros(shape)), between)
        functionals.append(((v.q, v.T, v.p, v.X), v.log))
    sizes = np.stack([np.abs(_minor(near, i, j)) + np.zeros(shape) for i, j in PAIRS])
    best = np.argmax(sizes, axis=0)
    out, log = [np.zeros(shape, complex) for _ in range(4)], np.zeros(shape, complex)
    for pair, (i, j) in enumerate(PAIRS):
        chosen = best == pair
        if not chosen.any():
            continue
        (f, f_log), (g, g_log) = functionals[i], functionals[j]
        size = np.maximum(f_log, g_log)
        with np.errstate(under="ignore", divide="ignore", invalid="ignore"):
            by_g, by_f = y[i] * np.exp(g_log - size), y[j] * np.exp(f_log - size)
            scale = 1 / _minor(near, i, j)
            for c in range(4):
                value = by_g * _contracted(at, g, c) - by_f * _contracted(at, f, c)
                out[c] = np.where(chosen, value * scale, out[c])
            log = np.where(chosen, y.log + size + at.log - near.log, log)
    return Vector._make([*out, log])


def _minor(m: Minors, i: int, j: int) -> np.ndarray:
    """P_ij of minors; 0 p, 1 X, 2 q, 3 T."""
    known = {(0, 1): m.a, (2, 3): m.b, (0, 2): m.q11, (0, 3): m.q12, (1, 2): m.q21}
    return -m.q11 if (i, j) == (1, 3) else known[i, j]


def _contracted(m: Minors, g: tuple[np.ndarray, ...], i: int) -> np.ndarray:
    """sum_j P_ij g_j."""
    terms = [_minor(m, i, j) * g[j] if i < j else -_minor(m, j, i) * g[j] for j in range(4) if j != i]
    return terms[0] + terms[1] + terms[2]


def _single(run: tuple[SolidBlock, ...]) -> bool:
    return len(run) == 1 and run[0].periods == 1 and run[0].layers.thickness.size == 1


def through(
    run: tuple[SolidBlock, ...],
    omega: np.ndarray,
    kx: np.ndarray,
    minors: tuple[Minors, ...],
    vectors: tuple[Vector, ...],
) -> tuple[tuple[Minors, ...], tuple[Vector, ...]]:
    """Carry minors, and solutions, back through a run: its layers are taken once for all of them."""
    along = Along(kx)
    for block in reversed(run):
        if block.periods > 1:
            minors = tuple(block_back(block, omega, kx, m) for m in minors)
            vectors = tuple(block_back(block, omega, kx, v) for v in vectors)
            continue
        for j, y in layers_back(block.layers, omega, along):
            # the size is taken out now and then, and wherever a layer may change it by much
            sized = j % TOGETHER == 0 or not y.thin
            minors = tuple(minors_back(m, y, sized) for m in minors)
            vectors = tuple(vector_back(v, y, sized) for v in vectors)
    return minors, vectors


def _clamped(omega: np.ndarray, kx: np.ndarray) -> Vector:
    """The solution (0, 1 | 0, 0) of the far face: carried back, its T is Y_TX."""
    zero = np.zeros(np.broadcast_shapes(omega.shape, kx.shape), complex)
    return Vector(zero, zero + 1, zero, zero, zero.real)


def _in_size(p: np.ndarray, q: np.ndarray, log: np.ndarray, divisor: np.ndarray) -> State:
    """A state over a divisor, with its size taken out; in real logarithms, which take a tenth of the time of complex ones."""
    size = np.abs(p) + np.abs(q)
    usual = (size > 0) & np.isfinite(size)
    size = size if usual.all() else np.where(usual, size, 1.0)
    length, nothing = np.abs(divisor), divisor == 0
    if nothing.any():
        length, divisor = np.where(nothing, 1.0, length), np.where(nothing, 1.0, divisor)
        log = log - np.where(nothing, NOTHING, 0.0)
    scale = np.conj(divisor) / length * (1 / size)
    return State(p * scale, q * scale, log + np.log(size / length))


def _plate(y: Basis) -> RunMatrix:
    """One layer in closed form: its matrix is made of what the symmetric and the antisymmetric waves do over half of it."""
    m, w, f, k2 = y.medium, y.waves, y.products, y.k2
    e = k2 * (2 / (m.rho * m.compliance))
    odd = 2 * m.rho * (f.sin_cos + 2 * k2 * (2 - e) * f.sigma)
    even = 2 * m.rho * (f.cos_sin - 2 * e * (f.cos_sin - m.eta * f.sin_cos - k2 * f.sigma))
    sines = 2 * y.a2 * f.sin_sin
    shear = w.cos_s * w.sin_s
    rest = shear - m.eta * w.cos_p * w.sin_p - k2 * (w.sin_ps * w.cos_p + w.cos_ps * w.sin_s)
    divisor = 2 * m.rho * (shear - 2 * e * rest)
    diagonal = -sines * odd
    zero = np.zeros(divisor.shape)
    log, growth = (zero if g is None else 2 * g for g in (w.growth, f.growth))
    return RunMatrix(diagonal, odd * even, -2 * sines * f.cos_cos, diagonal, divisor, log, growth - log)
