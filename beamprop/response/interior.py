"""The field inside a slab, from the states that the march left at the faces."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ..arrays.matmul import BLOCK, small_product
from ..media.values import LayerValues, SegmentValues
from .cell import TINY, BlochPhase, Matrix, faded, matrix_back, power_back, times
from .layer import State, at_frequencies, entire, layer_back, one_layer, several_layers, terms_for
from .recursion import Places, Station, places_of, segment_of


def fill_interior(
    stations: list[Station],
    omega: np.ndarray,
    kx: np.ndarray,
    z: np.ndarray,
    near_log: np.ndarray,
    per_incident: np.ndarray,
) -> np.ndarray:
    """p at depths z inside the slab per unit incident pressure, (F, Z, n)."""
    out = np.empty((kx.shape[0], z.size, kx.shape[1]), complex)
    owner = segment_of(np.array([s.start for s in stations]), z)
    for index, station in enumerate(stations):
        rows = np.flatnonzero(owner == index)
        if not rows.size:
            continue
        places = places_of(station.values, z[rows] - station.start)
        for i in range(kx.shape[0]):
            one = _one_frequency(station, i)
            fill = _fill_single if station.matrix is None else _fill_periodic
            fill(one, omega[i : i + 1], kx[i : i + 1], places, rows, near_log[i], per_incident[i], out[i])
    return out


def _one_frequency(station: Station, i: int) -> Station:
    """A station at frequency i alone: leading axis 1."""

    def one(record: Any) -> Any:
        if record is None:
            return None
        return type(record)(*(v[i : i + 1] if isinstance(v, np.ndarray) else v for v in record))

    values = SegmentValues(at_frequencies(station.values.layers, slice(i, i + 1)), station.values.periods)
    faces = {j: one(state) for j, state in station.faces.items()}
    return Station(values, one(station.far), one(station.matrix), one(station.bloch), station.start, faces)


def _fill_single(
    station: Station,
    omega: np.ndarray,
    kx: np.ndarray,
    places: Places,
    rows: np.ndarray,
    near_log: np.ndarray,
    per_incident: np.ndarray,
    out: np.ndarray,
) -> None:
    """Fill rows of `out` that lie in a segment of one period: from the state behind each layer, the rest of that layer."""
    omega2, kx2 = omega * omega, kx * kx
    for j, here in _by_layer(places):
        face = station.faces[j]
        scale = np.exp(face.log[0] - near_log) * per_incident
        A, B, _ = one_layer(station.values.layers, j, omega2, kx2) if here.size >= MANY else (None, None, None)
        if A is not None and (w := _steady(A * B)) is not None:
            out[rows[here]] = _two_waves(w, A, face, scale, places.share[here])
            continue
        A, B, f = one_layer(station.values.layers, j, omega2, kx2, places.share[here][:, None])
        p, _, log = layer_back(State(face.p, face.q, np.zeros(1)), A, B, f)
        out[rows[here]] = p * scale if f.growth is None else p * np.exp(log + face.log - near_log) * per_incident


def _steady(u: np.ndarray) -> np.ndarray | None:
    """w = sqrt(u) (1, n) of a layer in which two waves can be told apart and neither overflows; or None."""
    w = np.sqrt(u)
    return w if float(np.min(np.abs(w))) > 0.05 and float(np.max(np.abs(w.imag))) < 300 else None


def _two_waves(w: np.ndarray, A: np.ndarray, face: State, scale: np.ndarray, share: np.ndarray) -> np.ndarray:
    """p in a layer of phase w, at shares (Z,) of it in front of its far face: (Z, n)."""
    # plain: p cos(w share) - A q share sin(w share)/(w share)
    along = (0.5j * scale) * (A * face.q) / w
    one, two = 0.5 * scale * face.p + along, 0.5 * scale * face.p - along
    wave = np.exp(np.multiply.outer(1j * share, w[0]))
    out = two[0] / wave
    wave *= one[0]
    out += wave
    return out


def _by_layer(places: Places) -> Iterator[tuple[int, np.ndarray]]:
    """Layers that hold depths, and which."""
    order = np.argsort(places.layer, kind="stable")
    layers, first = np.unique(places.layer[order], return_index=True)
    return zip(layers.tolist(), np.split(order, first[1:]), strict=True)


def _fill_periodic(
    station: Station,
    omega: np.ndarray,
    kx: np.ndarray,
    places: Places,
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
    # plain: p(z) = rest of layer j (layers behind j (power_back(far, periods behind)))
    layers, periods = station.values
    m, b, far = station.matrix, station.bloch, station.far
    assert m is not None
    assert b is not None
    if m.growth is not None:
        return _fill_opaque(station, omega, kx, places, rows, near_log, per_incident, out)
    behind, which = _counts(periods - 1 - places.period)
    states, factors = _in_two_terms(m, b, far, behind, near_log, per_incident)
    if rows.size * kx.shape[1] <= AT_ONCE:
        p = _few_pressures(layers, omega, kx, places, states)
        p *= factors[which]
        out[rows] = p[:, 0] + p[:, 1]
        return None
    size = max(ROWS, BLOCK // (4 * kx.shape[1]))
    gathered = np.empty((size, 2, kx.shape[1]), complex)
    for here, pressures in _back_through(layers, omega, kx, places, states):
        for start in range(0, here.size, size):  # blocks that stay in the cache
            block = here[start : start + size]
            p = pressures(places.share[block])  # (Z, 2, n)
            p *= np.take(factors, which[block], axis=0, out=gathered[: block.size], mode="clip")
            out[rows[block]] = np.add(p[:, 0], p[:, 1], out=p[:, 0])


#: The fewest depths that are worked on at a time.
ROWS = 32
#: Up to so many numbers the number of statements is what all depths cost: they are worked on at once, whatever their layers.
AT_ONCE = 2**14


def _in_two_terms(
    m: Matrix, b: BlochPhase, far: State, behind: np.ndarray, near_log: np.ndarray, scale: np.ndarray
) -> tuple[State, np.ndarray]:
    """`power_back` for sorted counts of periods as a sum of two states (2, n) times factors (len(behind), 2, n).

    ``Lambda^n M^-n far = g far + f (M^-1 - I) far`` with x = Lambda^2n - 1 in g = 1 + x/(1 + Lambda) and f = Lambda
    x/(Lambda^2 - 1): factor 1 goes with `far`, factor x (n at the band edge) with far/(1 + Lambda) + Lambda/(Lambda^2 - 1)
    (M^-1 - I) far; both times exp(log - i phase n) scale.
    """
    # plain: x = expm1(2i reduced count), g = (lam + 1 + x)/(1 + lam), f = lam x/expm1(2i reduced)
    reduced, phase = b.reduced[0], b.phase[0]
    lam, x2 = np.exp(1j * reduced), np.expm1(2j * reduced)
    edge = np.abs(x2) < TINY
    moved = _moved(m, b, far)
    own, other = np.where(edge, 0.0, 1 / (1 + lam)), lam / np.where(edge, 1.0, x2)
    p, q = (np.concatenate([one, own * one + other * two]) for one, two in zip(far[:2], moved[:2], strict=True))
    factors = np.empty((behind.size, 2, reduced.size), complex)
    factors[:, 0] = _exp_table(far.log[0] - near_log, -1j * phase, behind, scale)
    x = _expm1_table(2j * reduced, behind)
    if np.any(edge):
        x = np.where(edge, behind[:, None], x)
    np.multiply(x, factors[:, 0], out=factors[:, 1])
    return State(p, q, far.log), factors


def _moved(m: Matrix, b: BlochPhase, far: State) -> State:
    """(M^-1 - I) far, of +-M: what `power_back` multiplies by f."""
    sign, twice = np.where(b.flip, -1.0, 1.0), np.where(b.flip, 2.0, 0.0)
    p = sign * (m.e22 * far.p - m.e12 * far.q) - twice * far.p
    q = sign * (m.e11 * far.q - m.e21 * far.p) - twice * far.q
    return State(p, q, far.log)


#: From how many periods on their powers are products of two small tables, and the step between the entries of the coarse one.
TABLE, STEP = 48, 16


def _counts(behind: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of periods to make factors for, sorted, and where each of `behind` stands among them.

    Where they lie dense, all between the first and the last: tables need no look-up then.
    """
    counts, which = np.unique(behind, return_inverse=True)
    span = int(counts[-1] - counts[0]) + 1
    if counts.size < TABLE or span > 2 * counts.size:
        return counts, which
    return np.arange(counts[0], counts[0] + -(-span // STEP) * STEP), behind - counts[0]


def _dense(counts: np.ndarray) -> bool:
    return counts.size >= TABLE and int(counts[-1] - counts[0]) == counts.size - 1 and counts.size % STEP == 0


def _split(counts: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """Sorted counts as steps of the coarse table and of the fine one; None where tables do not pay."""
    steps, rest = np.divmod(counts - counts[0], STEP)
    return (steps, rest) if counts.size >= TABLE and 2 * (int(steps[-1]) + 1 + STEP) < counts.size else None


def _expm1_table(y: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """expm1(counts y) for Re y <= 0: (len(counts), n)."""
    # plain: expm1(counts y); expm1(a + b) = expm1(a) expm1(b) + expm1(a) + expm1(b)
    if (split := _split(counts)) is None:
        return np.expm1(faded(np.multiply.outer(counts, y)))
    one = np.expm1(faded(np.multiply.outer(counts[0] + STEP * np.arange(split[0][-1] + 1), y)))
    two = np.expm1(faded(np.multiply.outer(np.arange(STEP), y)))
    one, two = (one[:, None], two) if _dense(counts) else (one[split[0]], two[split[1]])
    out = one * two
    out += one
    out += two
    return out.reshape(counts.size, -1)


def _exp_table(log: np.ndarray, y: np.ndarray, counts: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """exp(log + counts y) scale: (len(counts), n), 0 where the exponential is below 1e-282."""
    split = _split(counts)
    if split is None or float(np.max(np.abs(y.real))) * STEP > 300:  # a factor could overflow on its own
        return np.exp(_faint(log + np.multiply.outer(counts, y))) * scale
    one = np.exp(_faint(log + np.multiply.outer(counts[0] + STEP * np.arange(split[0][-1] + 1), y))) * scale
    two = np.exp(np.multiply.outer(np.arange(STEP), y))
    if _dense(counts):
        return (one[:, None] * two).reshape(counts.size, -1)
    out = one[split[0]]
    out *= two[split[1]]
    return out


def _faint(exponent: np.ndarray) -> np.ndarray:
    """Exponents below -650 moved to -inf, in place: no denormal numbers."""
    exponent[exponent.real < -650] = -np.inf
    return exponent


#: Pressures (Z, 2, n) in a layer, of two states, at shares (Z,) of its thickness in front of its far face.
Pressures = Callable[[np.ndarray], np.ndarray]


def _back_through(
    layers: LayerValues, omega: np.ndarray, kx: np.ndarray, places: Places, states: State
) -> Iterator[tuple[np.ndarray, Pressures]]:
    """Carry states (2, n) back through a cell in which nothing grows: for each layer that holds depths, which, and how."""
    holding = dict(_by_layer(places))
    for j, A, B, face in _faces_back(layers, omega, kx, set(holding), states):
        yield holding[j], _rest_of_layer(A, B, face, holding[j].size)


def _faces_back(
    layers: LayerValues, omega: np.ndarray, kx: np.ndarray, wanted: set[int], states: State
) -> Iterator[tuple[int, np.ndarray, np.ndarray, State]]:
    """Carry states (2, n) back through a cell in which nothing grows: wanted layers, their A and B, states at their far faces."""
    omega2, kx2 = omega * omega, kx * kx
    p, q, _ = states
    first, size = min(wanted), max(1, 4 * BLOCK // kx.size)
    for stop in range(len(layers.thickness), first, -size):
        start = max(first, stop - size)
        A, B, f = several_layers(layers, slice(start, stop), omega2, kx2)
        As, Bs = A * f.s, B * f.s
        for i in reversed(range(stop - start)):
            if start + i in wanted:
                yield start + i, A[i], B[i], State(p, q, states.log)
            p, q = p + (f.c[i] * p - As[i] * q), q + (f.c[i] * q + Bs[i] * p)


def _few_pressures(layers: LayerValues, omega: np.ndarray, kx: np.ndarray, places: Places, states: State) -> np.ndarray:
    """Pressures of two states at all places of a cell, (Z, 2, n), in one step."""
    # plain: for each place the rest of its layer, from the states at that layer's far face
    found = list(_faces_back(layers, omega, kx, set(places.layer.tolist()), states))[::-1]
    at = np.searchsorted([j for j, *_ in found], places.layer)
    A, B, p, q = (np.stack(v)[at] for v in zip(*((A, B, s.p, s.q) for _, A, B, s in found), strict=True))
    part = places.share[:, None, None]
    f = entire(A * B * part**2)  # (Z, 1, n)
    return p + (f.c * p - A * part * f.s * q)


#: From how many depths in a layer on a series in the share is cheaper than the functions themselves.
MANY = 8


def _rest_of_layer(A: np.ndarray, B: np.ndarray, face: State, depths: int) -> Pressures:
    """Pressures in a layer of given A (1, 1) and B (1, n) in front of states (2, n) at its far face."""
    u = A * B
    size = float(np.max(np.abs(u)))
    if size >= 0.5 or depths < MANY:

        def exactly(share: np.ndarray) -> np.ndarray:
            part = share[:, None, None]
            f = entire(u * part**2)  # (Z, 1, n)
            return face.p + (f.c * face.p - A * part * f.s * face.q)

        return exactly
    # cos and sin as powers of share: p = p_far (1 - u s^2/2! + ...) - A q_far (s - u s^3/3! + ...)
    count = 2 * terms_for(size) + 2
    coefficients = np.empty((count, *face.p.shape), complex)
    coefficients[0], coefficients[1] = face.p, -A * face.q
    for i in range(2, count):
        np.multiply(coefficients[i - 2], u * (-1 / (i * (i - 1))), out=coefficients[i])
    flat = coefficients.reshape(count, -1).view(float)

    def by_powers(share: np.ndarray) -> np.ndarray:
        powers = np.vander(share, count, increasing=True)
        return small_product(powers, flat).view(complex).reshape(share.size, *face.p.shape)

    return by_powers


def _with_tails(
    layers: LayerValues, omega: np.ndarray, kx: np.ndarray, places: Places
) -> Iterator[tuple[int, np.ndarray, Matrix | None]]:
    """Layers that hold depths, which, and the matrix of the layers behind them in the cell."""
    omega2, kx2 = omega * omega, kx * kx
    holding = dict(_by_layer(places))
    tail: Matrix | None = None
    for j in reversed(range(min(holding), len(layers.thickness))):
        if j in holding:
            yield j, holding[j], tail
        if j > min(holding):
            A, B, f = one_layer(layers, j, omega2, kx2)
            layer = Matrix(f.a, f.c, A * f.s, -B * f.s, f.c, f.growth)
            tail = layer if tail is None else times(layer, tail)


def _fill_opaque(
    station: Station,
    omega: np.ndarray,
    kx: np.ndarray,
    places: Places,
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
        state = power_back(station.matrix, station.bloch, station.far, behind[:, None])
        if tail is not None:
            state = matrix_back(tail, state)
        p, _, log = layer_back(state, *one_layer(layers, j, omega * omega, kx * kx, places.share[here][:, None]))
        out[rows[here]] = p * np.exp(log - near_log) * per_incident
