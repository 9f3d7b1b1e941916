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

from typing import NamedTuple

import numpy as np

from .conventions import outgoing_kz
from .media import FluidValues, LayerValues, SegmentValues

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


def _series(u: np.ndarray, size: float) -> Entire:
    """Power series in u; enough terms for full precision at |u| <= size < 1."""
    terms, last = 1, size / 2
    while last > 1e-18 and terms < 12:
        terms += 1
        last *= size / ((2 * terms - 1) * (2 * terms))
    c = np.zeros_like(u)
    s = np.zeros_like(u)
    for k in range(terms, 0, -1):  # c = -u/2 (1 - u/12 (1 - ...)), s = 1 - u/6 (1 - u/20 (1 - ...))
        c = (c + 1) * (u * (-1 / ((2 * k - 1) * (2 * k))))
        s = (s + 1) * (u * (-1 / ((2 * k) * (2 * k + 1))))
    return Entire(1.0, c, s + 1, None)


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


def _times(m: Matrix | None, A: np.ndarray, B: np.ndarray, f: Entire) -> Matrix:
    """(this layer) x (what stands in front of it): layers are added from the near side on."""
    if m is None:
        return Matrix(f.a, f.c, A * f.s, -B * f.s, f.c, f.growth)
    l11, l12, l21 = f.c, A * f.s, -B * f.s
    e11 = f.a * m.e11 + (l11 * (m.a + m.e11) + l12 * m.e21)
    e12 = f.a * m.e12 + (l11 * m.e12 + l12 * (m.a + m.e22))
    e21 = f.a * m.e21 + (l21 * (m.a + m.e11) + l11 * m.e21)
    e22 = f.a * m.e22 + (l21 * m.e12 + l11 * (m.a + m.e22))
    growth = f.growth if m.growth is None else m.growth if f.growth is None else m.growth + f.growth
    out = Matrix(f.a * m.a, e11, e12, e21, e22, growth)
    return _renormalised(out)


def _renormalised(m: Matrix) -> Matrix:
    """Take size out of a matrix whose entries would overflow in the next products."""
    size = np.abs(m.e11) + np.abs(m.e12) + np.abs(m.e21) + np.abs(m.e22)
    large = size > 1e60
    if not np.any(large):
        return m
    size = np.where(large, size, 1.0)
    growth = np.log(size) + (0.0 if m.growth is None else m.growth)
    return Matrix(m.a / size, m.e11 / size, m.e12 / size, m.e21 / size, m.e22 / size, growth)


def cell_matrix(layers: LayerValues, omega: np.ndarray, kx: np.ndarray) -> Matrix:
    """Matrix of one period, near to far face."""
    omega2, kx2 = omega * omega, kx * kx
    m: Matrix | None = None
    for j in range(len(layers.thickness)):
        m = _times(m, *_layer(layers, j, omega2, kx2))
    assert m is not None
    return m


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
    """One segment during the march: its far-face state, its matrix (None for a single period) and where it begins."""

    values: SegmentValues
    far: State
    matrix: Matrix | None
    bloch: BlochPhase | None
    start: float


def _march(
    segments: list[SegmentValues], omega: np.ndarray, kx: np.ndarray, state: State
) -> tuple[State, list[_Station]]:
    """Carry the outgoing state back through all segments."""
    starts = np.cumsum([0.0, *(s.periods * s.layers.thickness.sum() for s in segments)])
    omega2, kx2 = omega * omega, kx * kx
    stations = []
    for segment, start in zip(reversed(segments), reversed(starts[:-1]), strict=True):
        far, m, b = state, None, None
        if segment.periods == 1:
            for j in reversed(range(len(segment.layers.thickness))):
                state = _layer_back(state, *_layer(segment.layers, j, omega2, kx2))
                if j % 16 == 0:
                    state = _normalised(state)
        else:
            m = cell_matrix(segment.layers, omega, kx)
            b = bloch_phase(m)
            state = _normalised(_power_back(m, b, state, segment.periods))
        stations.append(_Station(segment, far, m, b, float(start)))
    return state, stations[::-1]


def _near(
    segments: list[SegmentValues], front: FluidValues, behind: FluidValues, omega: np.ndarray, kx: np.ndarray
) -> tuple[np.ndarray, State, list[_Station]]:
    """kz in front, and the state at the near face that leaves a unit outgoing wave behind."""
    kz1 = outgoing_kz(kx, omega, *front)
    kz2 = outgoing_kz(kx, omega, *behind)
    exit_state = State(np.ones_like(kz2), 1j * kz2 / behind.rho_z, np.zeros_like(kz2))
    near, stations = _march(segments, omega, kx, exit_state)
    return kz1, near, stations


def dispersion(
    segments: list[SegmentValues], before: FluidValues, after: FluidValues, omega: np.ndarray, kx: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The function whose zeros in kx are the guided modes, as (value, logarithm): value exp(logarithm). (F, n) each.

    It is the incident amplitude that a unit outgoing wave behind the slab needs, times 2 i kz: the denominator of r and t.
    """
    front, behind = (FluidValues(*(v[:, None] for v in f)) for f in (before, after))
    kz1, near, _ = _near(segments, front, behind, omega, kx)
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
    kz1, near, stations = _near(segments, front, behind, omega, kx)
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
        if z is not None and len(z):
            inside = _inside(stations, omega, kx, np.asarray(z, float), near.log, per_incident)
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
    starts = np.array([s.start for s in stations])
    owner = np.clip(np.searchsorted(starts, z, side="right") - 1, 0, None)
    for index, station in enumerate(stations):
        rows = np.flatnonzero(owner == index)
        if rows.size:
            _inside_segment(station, omega, kx, z[rows] - station.start, rows, near_log, per_incident, out)
    return out


def _inside_segment(
    station: _Station,
    omega: np.ndarray,
    kx: np.ndarray,
    depth: np.ndarray,
    rows: np.ndarray,
    near_log: np.ndarray,
    per_incident: np.ndarray,
    out: np.ndarray,
) -> None:
    """Fill rows of `out` that lie `depth` behind the segment's near face.

    A depth lies in layer j of some period: whole periods behind it in closed form, then the layers behind j, then the rest
    of layer j.
    """
    layers, periods = station.values
    faces = np.concatenate([[0.0], np.cumsum(layers.thickness)])
    period = np.clip(np.floor(depth / faces[-1]).astype(int), 0, periods - 1)
    offset = np.clip(depth - period * faces[-1], 0.0, faces[-1])
    solid = np.flatnonzero(layers.thickness > 0)
    layer = solid[np.clip(np.searchsorted(faces[solid], offset, side="right") - 1, 0, len(solid) - 1)]
    share = np.clip((faces[layer + 1] - offset) / layers.thickness[layer], 0.0, 1.0)
    omega2, kx2 = omega * omega, kx * kx
    tail: Matrix | None = None
    for j in reversed(range(len(layers.thickness))):
        here = np.flatnonzero(layer == j)
        if here.size:
            state = _far_states(station, periods - 1 - period[here])
            if tail is not None:
                state = _matrix_back(tail, state)
            part = share[here][:, None]
            for i in range(kx.shape[0]):
                one = State(*(np.broadcast_to(s[:, i], (here.size, kx.shape[1])) for s in state))
                A, B, f = _layer(_one_frequency(layers, i), j, omega2[i : i + 1], kx2[i : i + 1], part)
                p, _, log = _layer_back(one, A, B, f)
                out[i, rows[here]] = p * np.exp(log - near_log[i]) * per_incident[i]
        A, B, f = _layer(layers, j, omega2, kx2)
        tail = _times_in_front(tail, A, B, f)


def _one_frequency(layers: LayerValues, i: int) -> LayerValues:
    mass, compliance, mobility, vanishing = (
        v[:, i : i + 1] for v in (layers.mass, layers.compliance, layers.mobility, layers.vanishing)
    )
    return LayerValues(mass, compliance, mobility, layers.thickness, vanishing)


def _far_states(station: _Station, behind: np.ndarray) -> State:
    """States at the far face of the periods that have `behind` whole periods behind them: (len(behind), F, n)."""
    if station.matrix is None or station.bloch is None:
        return State(*(np.broadcast_to(v, (behind.size, *np.shape(station.far.p))) for v in station.far))
    return _power_back(station.matrix, station.bloch, station.far, behind[:, None, None])


def _times_in_front(m: Matrix | None, A: np.ndarray, B: np.ndarray, f: Entire) -> Matrix:
    """(what stands behind) x (this layer): layers are added from the far side on."""
    layer = _times(None, A, B, f)
    if m is None:
        return layer
    e11 = m.a * layer.e11 + (m.e11 * (layer.a + layer.e11) + m.e12 * layer.e21)
    e12 = m.a * layer.e12 + (m.e11 * layer.e12 + m.e12 * (layer.a + layer.e22))
    e21 = m.a * layer.e21 + (m.e21 * (layer.a + layer.e11) + m.e22 * layer.e21)
    e22 = m.a * layer.e22 + (m.e21 * layer.e12 + m.e22 * (layer.a + layer.e22))
    growth = f.growth if m.growth is None else m.growth if f.growth is None else m.growth + f.growth
    return _renormalised(Matrix(m.a * layer.a, e11, e12, e21, e22, growth))


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
