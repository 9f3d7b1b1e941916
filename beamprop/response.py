"""The exact plane-wave response, on arrays: layer -> cell -> power of a cell -> slab.

Shapes: omega is (F, 1), kx is (F, n) or (n,); leading axes are batch, the last one is kx. Nothing is checked here.

One layer takes the state (p, q), q = (1/rho_z) dp/dz, from its near to its far face by

    [[ C, A s ], [ -B s, C ]],   A = rho_z d,   B = (w^2/K - kx^2/rho_x) d,   u = A B = (kz d)^2,
    C = cos(sqrt(u)),  s = sin(sqrt(u))/sqrt(u):  entire in u, so kz = 0 is no special case and no branch is chosen.

States are carried BACK from the outgoing wave at the far face, the direction in which the physical solution grows:
nothing cancels, however thick the slab. What grows is taken out and kept as a logarithm.

Matrices are kept as ``exp(growth) (a I + E)``: for a thin cell a = 1, growth = 0 and E is small, so that ``trace/2 - 1``, and
with it the Bloch phase, has full relative precision; for an opaque one a = exp(-growth) underflows harmlessly.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from .conventions import outgoing_kz
from .media import FluidValues, LayerValues, SegmentValues
from .products import BLOCK, small_product

#: Growth in nepers from which a layer's matrix is scaled. Below, exp(2 * 30) is far from overflow.
SCALE_FROM = 30.0
TINY = 1e-300


class Entire(NamedTuple):
    """exp(-growth) times (1, cos(sqrt u) - 1, sin(sqrt u)/sqrt u); growth is None where it is zero everywhere."""

    a: np.ndarray | float
    c: np.ndarray
    s: np.ndarray
    growth: np.ndarray | None


class Matrix(NamedTuple):
    """exp(growth) (a I + [[e11, e12], [e21, e22]]), determinant 1."""

    a: np.ndarray | float
    e11: np.ndarray
    e12: np.ndarray
    e21: np.ndarray
    e22: np.ndarray
    growth: np.ndarray | None


class State(NamedTuple):
    """exp(log) (p, q)."""

    p: np.ndarray
    q: np.ndarray
    log: np.ndarray


class BlochPhase(NamedTuple):
    """Eigenvalues exp(+-i phase) of a cell matrix, Im(phase) >= 0.

    `reduced` is the phase less pi where `flip`: the eigenvalue nearest to +1 of +-M, the one that full precision is for.
    """

    reduced: np.ndarray
    flip: np.ndarray

    @property
    def phase(self) -> np.ndarray:
        return self.reduced + np.pi * self.flip


# --- one layer --------------------------------------------------------------------------------------------


def _terms(size: float) -> int:
    """How many terms of the series in u full precision takes at |u| <= size < 1."""
    terms, last = 1, size / 2
    while last > 1e-17 and terms < 12:
        terms += 1
        last *= size / ((2 * terms - 1) * (2 * terms))
    return terms


def _series(u: np.ndarray, size: float) -> Entire:
    """Power series in u, in place; enough terms for full precision at |u| <= size < 1."""
    # c = -u/2! + u^2/4! - ...,  s = 1 - u/3! + u^2/5! - ...
    terms = _terms(size)
    c = u * ((-1) ** terms / math.factorial(2 * terms))
    s = u * ((-1) ** terms / math.factorial(2 * terms + 1))
    for k in range(terms - 1, 0, -1):
        c += (-1) ** k / math.factorial(2 * k)
        c *= u
        s += (-1) ** k / math.factorial(2 * k + 1)
        s *= u
    s += 1
    return Entire(1.0, c, s, None)


def entire(u: np.ndarray) -> Entire:
    """cos(sqrt u) - 1 and sin(sqrt u)/sqrt u, scaled where they would overflow."""
    size = float(np.max(np.abs(u), initial=0.0))
    if size < 1.0:
        return _series(u, size)
    w = np.sqrt(u)
    safe = np.where(np.abs(w) < 1e-4, 1.0, w)
    steep = np.abs(w.imag)
    if float(steep.max()) < SCALE_FROM:
        half = np.sin(w / 2)
        s = np.where(np.abs(w) < 1e-4, 1 - u / 6 + u * u / 120, 2 * half * np.cos(w / 2) / safe)
        return Entire(1.0, -2 * half * half, s, None)
    growth = np.where(steep < SCALE_FROM, 0.0, steep)
    calm = entire(np.where(growth > 0, 0.0, u))
    up, down = np.exp(1j * w - growth), np.exp(-1j * w - growth)
    a = np.exp(-growth)
    c = np.where(growth > 0, (up + down) / 2 - a, calm.c)
    s = np.where(growth > 0, (up - down) / (2j * safe), calm.s)
    return Entire(a, c, s, growth)


def _layer(layers: LayerValues, j: int, omega2: np.ndarray, kx2: np.ndarray, share: np.ndarray | float = 1.0) -> tuple:
    """(A, B, Entire) of `share` of layer j's thickness."""
    A = layers.mass[j][:, None] * share
    B = (omega2 * layers.compliance[j][:, None] - kx2 * layers.mobility[j][:, None]) * share
    return A, B, entire(A * B)


def _layers(layers: LayerValues, part: slice, omega2: np.ndarray, kx2: np.ndarray) -> tuple:
    """(A, B, Entire) of several layers at once: (J, F, 1), (J, F, n)."""
    A = layers.mass[part][..., None]
    b0 = omega2 * layers.compliance[part][..., None]
    b1 = -layers.mobility[part][..., None]
    B = b1 * kx2
    B += b0
    return A, B, entire(A * B)


def _layer_back(state: State, A: np.ndarray, B: np.ndarray, f: Entire) -> State:
    """Carry a state back through one layer."""
    p = f.a * state.p + (f.c * state.p - A * f.s * state.q)
    q = f.a * state.q + (f.c * state.q + B * f.s * state.p)
    if f.growth is None:
        return State(p, q, state.log)
    return _normalised(State(p, q, state.log + f.growth))


def _normalised(state: State) -> State:
    """Take the state's size out into its logarithm."""
    size = np.abs(state.p) + np.abs(state.q)
    size = np.where((size > 0) & np.isfinite(size), size, 1.0)
    return State(state.p / size, state.q / size, state.log + np.log(size))


# --- a cell and its powers --------------------------------------------------------------------------------


def _renormalised(m: Matrix) -> Matrix:
    """Take size out of a matrix whose entries would overflow in the next products."""
    size = np.abs(m.e11) + np.abs(m.e12) + np.abs(m.e21) + np.abs(m.e22)
    large = size > 1e60
    if not np.any(large):
        return m
    size = np.where(large, size, 1.0)
    growth = np.log(size) + (0.0 if m.growth is None else m.growth)
    return Matrix(m.a / size, m.e11 / size, m.e12 / size, m.e21 / size, m.e22 / size, growth)


def _product(near: Matrix, far: Matrix) -> Matrix:
    """(far) x (near)."""
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
        for e, one, two in zip((e11, e12, e21, e22), near[1:5], far[1:5], strict=True):
            e += one
            e += two
        return _renormalised(Matrix(1.0, e11, e12, e21, e22, None))
    for e, one, two in zip((e11, e12, e21, e22), near[1:5], far[1:5], strict=True):
        e += far.a * one
        e += near.a * two
    growth = (0.0 if near.growth is None else near.growth) + (0.0 if far.growth is None else far.growth)
    return _renormalised(Matrix(far.a * near.a, e11, e12, e21, e22, growth))


def _at(m: Matrix, index: slice) -> Matrix:
    return Matrix(*(v[index] if isinstance(v, np.ndarray) else v for v in m))


def _joined(m: Matrix, last: Matrix) -> Matrix:
    """Two stacks of matrices, one behind the other."""
    shape = m.e11.shape
    if m.growth is None and last.growth is not None:
        m = m._replace(a=np.ones(shape), growth=np.zeros(shape))
    if last.growth is None and m.growth is not None:
        last = last._replace(a=np.ones(last.e11.shape), growth=np.zeros(last.e11.shape))
    pairs = zip(m, last, strict=True)
    return Matrix(*(np.concatenate([one, two]) if isinstance(one, np.ndarray) else one for one, two in pairs))


def _layer_product(layers: LayerValues, omega: np.ndarray, kx2: np.ndarray) -> Matrix:
    """Matrix of one period, all layers at once and then pair by pair: (F, n)."""
    # plain: m = layer_N ... layer_2 layer_1, each [[C, A s], [-B s, C]]
    A, B, f = _layers(layers, slice(None), omega * omega, kx2)
    s = np.broadcast_to(f.s, f.c.shape)
    m = Matrix(f.a, f.c, A * s, -B * s, f.c, f.growth)
    while (count := m.e11.shape[0]) > 1:
        even = count - count % 2
        pairs = _product(_at(m, slice(0, even, 2)), _at(m, slice(1, even, 2)))
        m = _joined(pairs, _at(m, slice(even, None))) if count % 2 else pairs
    return Matrix(*(v[0] if isinstance(v, np.ndarray) else v for v in m))


def cell_matrix(layers: LayerValues, omega: np.ndarray, kx: np.ndarray) -> Matrix:
    """Matrix of one period, near to far face: a polynomial in kx^2 where that is as exact, else layer by layer."""
    kx2 = np.broadcast_to(kx * kx, np.broadcast_shapes(omega.shape, kx.shape)).astype(complex)
    if kx2.shape[1] >= 4 * CIRCLE and (fitted := _fitted(layers, omega, kx2)) is not None:
        return fitted
    block = max(1, BLOCK // len(layers.thickness))
    if kx2.size <= block:
        return _layer_product(layers, omega, kx2)
    out = np.empty((4, *kx2.shape), complex)
    a, growth = np.ones(kx2.shape), np.zeros(kx2.shape)
    columns = min(kx2.shape[1], max(64, block // kx2.shape[0]))
    rows = max(1, block // columns)
    for i, j in itertools.product(range(0, kx2.shape[0], rows), range(0, kx2.shape[1], columns)):
        part = slice(i, i + rows), slice(j, j + columns)
        m = _layer_product(_at_frequencies(layers, part[0]), omega[part[0]], kx2[part])
        out[:, *part] = m[1:5]
        if m.growth is not None:
            a[part], growth[part] = m.a, m.growth
    return Matrix(a, *out, growth) if np.any(growth) else Matrix(1.0, *out, None)


def _at_frequencies(layers: LayerValues, rows: slice) -> LayerValues:
    """Some frequencies of a cell's values."""
    mass, compliance, mobility, vanishing = (
        v[:, rows] for v in (layers.mass, layers.compliance, layers.mobility, layers.vanishing)
    )
    return LayerValues(mass, compliance, mobility, layers.thickness, vanishing)


#: Points on the circle from which the Taylor coefficients of a cell's matrix are taken; one more than the highest degree.
CIRCLE = 14


def _fitted(layers: LayerValues, omega: np.ndarray, kx2: np.ndarray) -> Matrix | None:
    """The cell's matrix from its Taylor series in v = kx^2, or None where it does not keep full precision.

    E(v) is entire, so with E on the circle |v| = R around all points asked for, Cauchy's integral by the trapezoid rule
    gives the coefficients: ``c_k = mean(E(v_m) v_m^-k)``. They fall to the rounding of E (4e-15 of the largest); two more
    are kept and what falls further is left out. Errors: rounding, EPS times the largest E on the circle, which is kept
    within a few times what the layers' own rounding leaves at v = 0 (`_circle_is_calm`); aliasing is smaller still.
    """
    radius = np.max(np.abs(kx2), axis=-1, keepdims=True)
    radius = np.where(radius > 0, radius, 1.0)
    if not np.all(_circle_is_calm(layers, omega * omega, radius)):
        return None
    turn = np.exp(2j * np.pi * np.arange(CIRCLE) / CIRCLE)
    m = _layer_product(layers, omega, radius * turn)
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
        _polynomials(coefficients[part, :, : degree + 1], kx2[part] / radius[part], out[:, part])
    return Matrix(1.0, *out, None)


def _circle_is_calm(layers: LayerValues, omega2: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Whether E on the circle is of order 1, and its rounding not much larger than it is at kx = 0: (F, 1)."""
    mass, compliance, mobility = (np.abs(v).sum(0)[:, None] for v in (layers.mass, layers.compliance, layers.mobility))
    still, moved = omega2 * compliance, radius * mobility
    return (mass * (still + moved) < 4) & (moved < 4 * still) & ~np.any(layers.vanishing, axis=0)[:, None]


def _polynomials(coefficients: np.ndarray, v: np.ndarray, out: np.ndarray) -> None:
    """Four polynomials (F, 4, degree + 1) at v (F, n) into out (4, F, n), powers times coefficients."""
    powers = np.ones((v.shape[0], coefficients.shape[-1], v.shape[1]), complex)
    for k in range(1, powers.shape[1]):
        np.multiply(powers[:, k - 1], v, out=powers[:, k])
    for i in range(v.shape[0]):
        out[:, i] = small_product(coefficients[i], powers[i])


def bloch_phase(m: Matrix) -> BlochPhase:
    """The Bloch phase kB P from cos(kB P) = trace/2.

    ``sin(phase/2)^2 = -(trace/2 - 1)/2`` keeps full precision for thin cells; a scaled (opaque) cell has
    ``exp(-i phase) = x + sqrt(x^2 - 1)``, the larger root, with x = trace/2 taken with its growth.
    """
    h = (m.e11 + m.e22) / 2
    thick = np.zeros(h.shape, bool) if m.growth is None else np.broadcast_to(m.growth > 0, h.shape)
    calm = np.where(thick, 0.0, h) if m.growth is not None else h
    flip = ~thick & (calm.real < -1)
    reduced = 2 * np.arcsin(np.sqrt(np.where(flip, 2 + calm, -calm) / 2))
    reduced = np.where(reduced.imag < 0, -reduced, reduced)
    if m.growth is not None:
        x = m.a + h
        root = np.sqrt(x * x - np.exp(-2 * m.growth))
        larger = np.where(np.abs(x + root) >= np.abs(x - root), x + root, x - root)
        logarithm = m.growth + np.log(np.where(thick & (larger != 0), larger, 1.0))
        reduced = np.where(thick, 1j * logarithm, reduced)
    return BlochPhase(reduced, flip)


def _power_back(m: Matrix, b: BlochPhase, far: State, count: np.ndarray | int) -> State:
    """Carry a state back through `count` periods, in closed form.

    With Lambda = exp(i phase), |Lambda| <= 1: ``Lambda^n M^-n = g I + f (M^-1 - I)``,
    ``g = (Lambda + Lambda^2n)/(1 + Lambda)``, ``f = Lambda (1 - Lambda^2n)/(1 - Lambda^2)`` (n at the band edge): the
    Chebyshev form with its growth taken out and its cancellations done by hand.
    """
    lam = np.exp(1j * b.reduced)
    x2n = np.expm1(2j * b.reduced * count)
    x2 = np.expm1(2j * b.reduced)
    edge = np.abs(x2) < TINY
    ratio = np.where(edge, count, x2n / np.where(edge, 1.0, x2))
    g = (lam + 1 + x2n) / (1 + lam)
    f = ratio * (lam if m.growth is None else np.exp(1j * b.reduced + m.growth))
    # f stands for f exp(growth) here, to meet E, which is kept divided by exp(growth)
    sign, twice = np.where(b.flip, -1.0, 1.0), np.where(b.flip, 2.0, 0.0)
    p = g * far.p + f * (sign * (m.e22 * far.p - m.e12 * far.q) - twice * far.p)
    q = g * far.q + f * (sign * (m.e11 * far.q - m.e21 * far.p) - twice * far.q)
    return State(p, q, far.log - 1j * b.phase * count)


# --- a slab -----------------------------------------------------------------------------------------------


class Response(NamedTuple):
    """r and t at the faces, and p(z) / (incident p at the near face) at the asked depths, (F, Z, n)."""

    r: np.ndarray
    t: np.ndarray
    inside: np.ndarray


class _Station(NamedTuple):
    """One segment during the march: its far-face state, its matrix (None for a single period) and where it begins.

    `faces` are the states behind those layers of a single period in which depths lie.
    """

    values: SegmentValues
    far: State
    matrix: Matrix | None
    bloch: BlochPhase | None
    start: float
    faces: dict[int, State]


def _march(
    segments: list[SegmentValues], omega: np.ndarray, kx: np.ndarray, state: State, z: np.ndarray
) -> tuple[State, list[_Station]]:
    """Carry the outgoing state back through all segments."""
    starts = np.cumsum([0.0, *(s.periods * s.layers.thickness.sum() for s in segments)])
    owner = _owner(starts[:-1], z)
    stations = []
    for index in reversed(range(len(segments))):
        segment, start = segments[index], float(starts[index])
        far, m, b, faces = state, None, None, {}
        if segment.periods == 1:
            wanted = set(_places(segment, z[owner == index] - start).layer.tolist())
            state, faces = _through_layers(segment.layers, omega, kx, state, wanted)
        else:
            m = cell_matrix(segment.layers, omega, kx)
            b = bloch_phase(m)
            state = _normalised(_power_back(m, b, state, segment.periods))
        stations.append(_Station(segment, far, m, b, start, faces))
    return state, stations[::-1]


def _owner(starts: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Which segment each depth lies in."""
    return np.clip(np.searchsorted(starts, z, side="right") - 1, 0, None)


def _through_layers(
    layers: LayerValues, omega: np.ndarray, kx: np.ndarray, state: State, wanted: set[int]
) -> tuple[State, dict[int, State]]:
    """Carry a state back through layers one by one, their functions made in blocks; keep those behind `wanted` layers."""
    # plain: for each layer from the last, state = _layer_back(state, *_layer(...)), normalised now and then
    omega2, kx2 = omega * omega, kx * kx
    count, faces = len(layers.thickness), {}
    size = min(16, max(1, BLOCK // max(1, kx2.size)))
    for stop in range(count, 0, -size):
        first = max(0, stop - size)
        A, B, f = _layers(layers, slice(first, stop), omega2, kx2)
        if f.growth is None:
            As, Bs = A * f.s, B * f.s
        for j in reversed(range(stop - first)):
            if first + j in wanted:
                faces[first + j] = state
            if f.growth is None:
                state = State(*_thin_back(state.p, state.q, f.c[j], As[j], Bs[j]), state.log)
            else:
                state = _layer_back(state, A[j], B[j], Entire(f.a[j], f.c[j], f.s[j], f.growth[j]))  # type: ignore[index]
        state = _normalised(state)
    return state, faces


def _thin_back(p: np.ndarray, q: np.ndarray, c: np.ndarray, As: np.ndarray, Bs: np.ndarray) -> tuple:
    """`_layer_back` where nothing grows, with A s and B s at hand."""
    new_p, new_q = c * p, c * q
    new_p -= As * q
    new_q += Bs * p
    new_p += p
    new_q += q
    return new_p, new_q


def _near(
    segments: list[SegmentValues],
    front: FluidValues,
    behind: FluidValues,
    omega: np.ndarray,
    kx: np.ndarray,
    z: np.ndarray,
) -> tuple[np.ndarray, State, list[_Station]]:
    """kz in front, and the state at the near face that leaves a unit outgoing wave behind."""
    kz1 = outgoing_kz(kx, omega, *front)
    kz2 = outgoing_kz(kx, omega, *behind)
    exit_state = State(np.ones_like(kz2), 1j * kz2 / behind.rho_z, np.zeros_like(kz2))
    near, stations = _march(segments, omega, kx, exit_state, z)
    return kz1, near, stations


def dispersion(
    segments: list[SegmentValues], before: FluidValues, after: FluidValues, omega: np.ndarray, kx: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The function whose zeros in kx are the guided modes, as (value, logarithm): value exp(logarithm). (F, n) each.

    It is the incident amplitude that a unit outgoing wave behind the slab needs, times 2 i kz: the denominator of r and t.
    """
    front, behind = (FluidValues(*(v[:, None] for v in f)) for f in (before, after))
    kz1, near, _ = _near(segments, front, behind, omega, kx, np.empty(0))
    return 1j * kz1 * near.p + front.rho_z * near.q, near.log


def solve(
    segments: list[SegmentValues],
    before: FluidValues,
    after: FluidValues,
    omega: np.ndarray,
    kx: np.ndarray,
    z: np.ndarray | None = None,
) -> Response:
    """Response of a slab to a plane wave of unit pressure at the near face.

    Parameters
    ----------
    segments : from `media.slab_values`, F frequencies
    before, after : properties of the half-spaces, arrays (F,)
    omega : (F, 1), rad/s
    kx : (F, n) complex, rad/m
    z : (Z,) depths inside the slab [m], or None

    Returns
    -------
    Response
    """
    kx = np.broadcast_to(kx, np.broadcast_shapes(omega.shape, np.shape(kx))).astype(complex)
    front, behind = (FluidValues(*(v[:, None] for v in f)) for f in (before, after))
    z = np.empty(0) if z is None else np.asarray(z, float)
    kz1, near, stations = _near(segments, front, behind, omega, kx, z)
    forward, backward = 1j * kz1 * near.p + front.rho_z * near.q, 1j * kz1 * near.p - front.rho_z * near.q
    size = 2j * kz1
    grazing = kz1 == 0
    if np.any(grazing):
        forward, backward, size = _grazing(near, grazing, forward, backward, size, front, behind, segments, omega)
    with np.errstate(under="ignore", over="ignore"):
        per_incident = size / forward
        t = per_incident * np.exp(-near.log)
        r = backward / forward
        opaque = _has_vanishing_layer(segments) & (kx != 0)
        t = np.where(opaque, 0.0, t)
        inside = np.empty((kx.shape[0], 0, kx.shape[1]), complex)
        if z.size:
            inside = _inside(stations, omega, kx, z, near.log, per_incident)
    return Response(r, t, inside)


def _has_vanishing_layer(segments: list[SegmentValues]) -> np.ndarray:
    """(F, 1): whether some layer has an isotropic density of exactly zero."""
    return np.any([np.any(s.layers.vanishing, axis=0) for s in segments], axis=0)[:, None]


def _grazing(
    near: State,
    grazing: np.ndarray,
    forward: np.ndarray,
    backward: np.ndarray,
    size: np.ndarray,
    front: FluidValues,
    behind: FluidValues,
    segments: list[SegmentValues],
    omega: np.ndarray,
) -> tuple:
    """r and t at kz_before = 0 exactly, where both may be 0/0.

    In general q at the near face is not zero and r = -1, t = 0 come out by themselves. Where q vanishes with kz (no
    slab, or one matched at grazing, with equal half-spaces) the matrix is [[P, .], [0, 1/P]] and
    ``t = 2/(P + 1/P)``, ``r = (P - 1/P)/(P + 1/P)``. q counts as zero when it is no more than rounding.
    """
    rounding = sum(s.periods * np.abs(s.layers.compliance).sum(axis=0) for s in segments)[:, None] * omega**2
    equal = np.all([np.equal(a, b) for a, b in zip(front, behind, strict=True)], axis=0)
    zero = grazing & equal & (np.abs(near.q) <= 1e-12 * rounding * np.abs(near.p))
    with np.errstate(over="ignore"):
        inverse = np.where(zero, np.exp(-2 * near.log) / np.where(near.p == 0, 1.0, near.p), 0)
    return (
        np.where(zero, near.p + inverse, forward),
        np.where(zero, near.p - inverse, backward),
        np.where(zero, 2.0, size),
    )


# --- the field inside --------------------------------------------------------------------------------------


class _Places(NamedTuple):
    """Where depths of one segment lie: period, layer, and the share of that layer behind them; (Z,) each."""

    period: np.ndarray
    layer: np.ndarray
    share: np.ndarray


def _places(values: SegmentValues, depth: np.ndarray) -> _Places:
    layers, periods = values
    faces = np.concatenate([[0.0], np.cumsum(layers.thickness)])
    period = np.clip(np.floor(depth / faces[-1]).astype(int), 0, periods - 1)
    offset = np.clip(depth - period * faces[-1], 0.0, faces[-1])
    solid = np.flatnonzero(layers.thickness > 0)
    layer = solid[np.clip(np.searchsorted(faces[solid], offset, side="right") - 1, 0, len(solid) - 1)]
    share = np.clip((faces[layer + 1] - offset) / layers.thickness[layer], 0.0, 1.0)
    return _Places(period, layer, share)


def _inside(
    stations: list[_Station],
    omega: np.ndarray,
    kx: np.ndarray,
    z: np.ndarray,
    near_log: np.ndarray,
    per_incident: np.ndarray,
) -> np.ndarray:
    """p at depths z inside the slab per unit incident pressure, (F, Z, n)."""
    out = np.empty((kx.shape[0], z.size, kx.shape[1]), complex)
    owner = _owner(np.array([s.start for s in stations]), z)
    for index, station in enumerate(stations):
        rows = np.flatnonzero(owner == index)
        if not rows.size:
            continue
        places = _places(station.values, z[rows] - station.start)
        for i in range(kx.shape[0]):
            one = _one_frequency(station, i)
            fill = _fill_single if station.matrix is None else _fill_periodic
            fill(one, omega[i : i + 1], kx[i : i + 1], places, rows, near_log[i], per_incident[i], out[i])
    return out


def _one_frequency(station: _Station, i: int) -> _Station:
    """A station at frequency i alone: leading axis 1."""

    def one(record: Any) -> Any:
        if record is None:
            return None
        return type(record)(*(v[i : i + 1] if isinstance(v, np.ndarray) else v for v in record))

    values = SegmentValues(_at_frequencies(station.values.layers, slice(i, i + 1)), station.values.periods)
    faces = {j: one(state) for j, state in station.faces.items()}
    return _Station(values, one(station.far), one(station.matrix), one(station.bloch), station.start, faces)


def _fill_single(
    station: _Station,
    omega: np.ndarray,
    kx: np.ndarray,
    places: _Places,
    rows: np.ndarray,
    near_log: np.ndarray,
    per_incident: np.ndarray,
    out: np.ndarray,
) -> None:
    """Fill rows of `out` that lie in a segment of one period: from the state behind each layer, the rest of that layer."""
    omega2, kx2 = omega * omega, kx * kx
    for j, here in _by_layer(places):
        face = station.faces[j]
        A, B, f = _layer(station.values.layers, j, omega2, kx2, places.share[here][:, None])
        scale = np.exp(face.log[0] - near_log) * per_incident
        p, _, log = _layer_back(State(face.p, face.q, np.zeros(1)), A, B, f)
        out[rows[here]] = p * scale if f.growth is None else p * np.exp(log + face.log - near_log) * per_incident


def _by_layer(places: _Places) -> Iterator[tuple[int, np.ndarray]]:
    """Layers that hold depths, and which."""
    order = np.argsort(places.layer, kind="stable")
    layers, first = np.unique(places.layer[order], return_index=True)
    return zip(layers.tolist(), np.split(order, first[1:]), strict=True)


def _fill_periodic(
    station: _Station,
    omega: np.ndarray,
    kx: np.ndarray,
    places: _Places,
    rows: np.ndarray,
    near_log: np.ndarray,
    per_incident: np.ndarray,
    out: np.ndarray,
) -> None:
    """Fill rows of `out` that lie in a segment of many periods.

    A depth lies in layer j of some period: whole periods behind it in closed form, then the layers behind j, then the rest
    of layer j. All of it is linear in the far face's state, so what depends on the period (two factors) and what depends
    on the place in the cell (two pressures) are made apart, once each, and only multiplied for each depth.
    """
    # plain: p(z) = rest of layer j (layers behind j (_power_back(far, periods behind)))
    layers, periods = station.values
    m, b, far = station.matrix, station.bloch, station.far
    assert m is not None
    assert b is not None
    if m.growth is not None:
        return _fill_opaque(station, omega, kx, places, rows, near_log, per_incident, out)
    behind, which = np.unique(periods - 1 - places.period, return_inverse=True)
    g, f = _factors(b, behind, far.log[0] - near_log, per_incident)
    moved = _moved(m, b, far)
    for j, here, tail in _with_tails(layers, omega, kx, places):
        both = [state if tail is None else _matrix_back(tail, state) for state in (far, moved)]
        one, two = _rest_of_layer(layers, j, omega, kx, both, places.share[here])
        row = which[here]
        one *= g[row]
        two *= f[row]
        one += two
        out[rows[here]] = one


def _moved(m: Matrix, b: BlochPhase, far: State) -> State:
    """(M^-1 - I) far, of +-M: what `_power_back` multiplies by f."""
    sign, twice = np.where(b.flip, -1.0, 1.0), np.where(b.flip, 2.0, 0.0)
    p = sign * (m.e22 * far.p - m.e12 * far.q) - twice * far.p
    q = sign * (m.e11 * far.q - m.e21 * far.p) - twice * far.q
    return State(p, q, far.log)


def _factors(b: BlochPhase, behind: np.ndarray, log: np.ndarray, scale: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """g and f of `_power_back` for sorted counts of periods, times exp(log - i phase count) scale: (len(behind), n)."""
    # plain: x2n = expm1(2i reduced count), g = (lam + 1 + x2n)/(1 + lam), f = lam x2n/expm1(2i reduced)
    reduced, phase = b.reduced[0], b.phase[0]
    lam, x2 = np.exp(1j * reduced), np.expm1(2j * reduced)
    edge = np.abs(x2) < TINY
    x2n = _expm1_table(2j * reduced, behind)
    outer = _exp_table(log, -1j * phase, behind)
    outer *= scale
    f = np.where(edge, behind[:, None], x2n) if np.any(edge) else x2n.copy()
    f *= lam / np.where(edge, 1.0, x2)
    f *= outer
    g = x2n
    g += 1 + lam
    g /= 1 + lam
    g *= outer
    return g, f


#: From how many periods on their powers are products of two small tables, and the step between the entries of the coarse one.
TABLE, STEP = 48, 16


def _split(counts: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Counts as coarse[i] + fine[j]: coarse, i, fine, j."""
    coarse, i = np.unique(counts // STEP, return_inverse=True)
    return coarse * STEP, i, np.arange(STEP), counts % STEP


def _expm1_table(y: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """expm1(counts y): (len(counts), n)."""
    if counts.size < TABLE:
        return np.expm1(np.multiply.outer(counts, y))
    coarse, i, fine, j = _split(counts)
    one, two = np.expm1(np.multiply.outer(coarse, y))[i], np.expm1(np.multiply.outer(fine, y))[j]
    out = one * two
    out += one
    out += two
    return out


def _exp_table(log: np.ndarray, y: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """exp(log + counts y): (len(counts), n)."""
    if counts.size < TABLE or float(np.max(np.abs(y.real))) * STEP > 300:  # a factor could overflow on its own
        return np.exp(log + np.multiply.outer(counts, y))
    coarse, i, fine, j = _split(counts)
    return np.exp(log + np.multiply.outer(coarse, y))[i] * np.exp(np.multiply.outer(fine, y))[j]


def _with_tails(
    layers: LayerValues, omega: np.ndarray, kx: np.ndarray, places: _Places
) -> Iterator[tuple[int, np.ndarray, Matrix | None]]:
    """Layers that hold depths, which, and the matrix of the layers behind them in the cell."""
    omega2, kx2 = omega * omega, kx * kx
    holding = dict(_by_layer(places))
    tail: Matrix | None = None
    for j in reversed(range(min(holding), len(layers.thickness))):
        if j in holding:
            yield j, holding[j], tail
        if j > min(holding):
            A, B, f = _layer(layers, j, omega2, kx2)
            layer = Matrix(f.a, f.c, A * f.s, -B * f.s, f.c, f.growth)
            tail = layer if tail is None else _product(layer, tail)


def _rest_of_layer(
    layers: LayerValues, j: int, omega: np.ndarray, kx: np.ndarray, faces: list[State], share: np.ndarray
) -> list[np.ndarray]:
    """Pressures in layer j in front of given states at its far face, `share` of its thickness away: (Z, n) each."""
    omega2, kx2 = omega * omega, kx * kx
    A, B, whole = _layer(layers, j, omega2, kx2)
    u = A * B
    size = float(np.max(np.abs(u)))
    if size >= 0.5 or whole.growth is not None or share.size < 8:
        A, B, f = _layer(layers, j, omega2, kx2, share[:, None])
        return [_layer_back(face, A, B, f).p * np.ones((share.size, 1)) for face in faces]
    # cos and sin as powers of share: p = p_far (1 - u s^2/2! + ...) - A q_far (s - u s^3/3! + ...)
    terms = _terms(size) + 1
    powers = share[:, None] ** np.arange(2 * terms)
    series = np.cumprod(np.concatenate([np.ones_like(u), np.repeat(-u, terms - 1, axis=0)]), axis=0)
    even = series / np.array([math.factorial(2 * k) for k in range(terms)])[:, None]
    odd = series * -A / np.array([math.factorial(2 * k + 1) for k in range(terms)])[:, None]
    out = []
    for face in faces:
        coefficients = np.stack([even * face.p, odd * face.q], axis=1).reshape(2 * terms, -1)
        out.append(small_product(powers, coefficients.view(float)).view(complex))
    return out


def _fill_opaque(
    station: _Station,
    omega: np.ndarray,
    kx: np.ndarray,
    places: _Places,
    rows: np.ndarray,
    near_log: np.ndarray,
    per_incident: np.ndarray,
    out: np.ndarray,
) -> None:
    """`_fill_periodic` where a cell's matrix grows: depth by depth, with logarithms."""
    layers, periods = station.values
    assert station.matrix is not None
    assert station.bloch is not None
    for j, here, tail in _with_tails(layers, omega, kx, places):
        behind = periods - 1 - places.period[here]
        state = _power_back(station.matrix, station.bloch, station.far, behind[:, None])
        if tail is not None:
            state = _matrix_back(tail, state)
        p, _, log = _layer_back(state, *_layer(layers, j, omega * omega, kx * kx, places.share[here][:, None]))
        out[rows[here]] = p * np.exp(log - near_log) * per_incident


def _matrix_back(m: Matrix, far: State) -> State:
    """Carry a state back through a matrix of determinant 1."""
    p = m.a * far.p + (m.e22 * far.p - m.e12 * far.q)
    q = m.a * far.q + (m.e11 * far.q - m.e21 * far.p)
    return State(p, q, far.log if m.growth is None else far.log + m.growth)


# --- Bloch waves ------------------------------------------------------------------------------------------


def bloch_wavenumber(layers: LayerValues, omega: np.ndarray, kx: np.ndarray) -> np.ndarray:
    """kz of the Bloch wave that decays, or where none does carries energy, along +z; continuous along kx. (F, n)."""
    m = cell_matrix(layers, omega, kx)
    phase = bloch_phase(m).phase
    ratio = (np.exp(1j * phase - (0.0 if m.growth is None else m.growth)) - m.a - m.e11) / np.where(
        m.e12 == 0, 1, m.e12
    )
    neither = np.abs(phase.imag) <= 1e-11 * (1 + np.abs(phase))
    phase = np.where(neither, phase.real + 0j, phase)  # rounding decides nothing
    phase = np.where(neither & ((ratio / 1j).real < 0), -phase, phase)
    return _unwrapped(phase, kx.real) / layers.thickness.sum()


def _unwrapped(phase: np.ndarray, kx: np.ndarray) -> np.ndarray:
    """Add whole turns so that the real part is continuous along kx, and within half a turn at the kx nearest to 0."""
    phase = (phase.real + np.pi) % (2 * np.pi) - np.pi + 1j * phase.imag
    order = np.argsort(kx, axis=-1, kind="stable")
    real = np.take_along_axis(phase.real, order, -1)
    turned = np.unwrap(real, axis=-1)
    anchor = np.argmin(np.abs(np.take_along_axis(kx, order, -1)), axis=-1)[:, None]
    turned += np.take_along_axis(real, anchor, -1) - np.take_along_axis(turned, anchor, -1)
    out = np.empty_like(phase)
    np.put_along_axis(out, order, turned + 1j * np.take_along_axis(phase.imag, order, -1), -1)
    return out
