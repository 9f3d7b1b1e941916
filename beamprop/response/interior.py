"""The field inside a slab, from the states that the recursion left at the faces."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ..arrays.exponentials import expm1_of_parts
from ..arrays.matmul import BLOCK
from ..media.values import LayerValues, SegmentValues
from .cell import Matrix, layer_matrix, matrix_back, times
from .layer import State, at_frequencies, entire, layer_back, one_layer, several_layers
from .periods import FADED, TINY, BlochPhase, power_back
from .recursion import Places, Station, places_of, segment_of
from .solid_run import inside_run


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
            fill = _fill_single if station.matrix is None else _fill_periodic
            fill(
                station_at(station, i),
                omega[i : i + 1],
                kx[i : i + 1],
                places,
                rows,
                near_log[i],
                per_incident[i],
                out[i],
            )
    return out


def station_at(station: Station, i: int) -> Station:
    """A station at frequency i alone: leading axis 1."""

    def taken(record: Any) -> Any:
        if record is None:
            return None
        return type(record)(*(v[i : i + 1] if isinstance(v, np.ndarray) else v for v in record))

    values = SegmentValues(at_frequencies(station.values.layers, slice(i, i + 1)), station.values.periods)
    faces = {j: taken(state) for j, state in station.faces.items()}
    return Station(values, taken(station.far), taken(station.matrix), taken(station.bloch), station.start, faces)


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
    omega2, kx2, solids = omega * omega, kx * kx, dict(station.values.layers.solids)
    for j, here in by_layer(places):
        face = station.faces[j]
        if j in solids:
            state = in_layer(station.values.layers, j, omega, kx, face, places.share[here])
            out[rows[here]] = state.p * np.exp(state.log - near_log) * per_incident
            continue
        scale = np.exp(face.log[0] - near_log) * per_incident
        A, B, _ = one_layer(station.values.layers, j, omega2, kx2) if here.size >= TWO_WAVES else (None, None, None)
        if A is not None and (w := _steady(A * B)) is not None:
            out[rows[here]] = _two_waves(w, A, face, scale, places.share[here])
            continue
        A, B, f = one_layer(station.values.layers, j, omega2, kx2, places.share[here][:, None])
        p, _, log = layer_back(State(face.p, face.q, np.zeros(1)), A, B, f)
        out[rows[here]] = p * scale if f.growth is None else p * np.exp(log + face.log - near_log) * per_incident


#: From how many depths in a layer on they share two exponentials instead of having the layer's functions each: 5 times as fast at
#: 1000 depths of a uniform slab.
TWO_WAVES = 8


def _steady(u: np.ndarray) -> np.ndarray | None:
    """w = sqrt(u) (1, n) of a layer whose two waves are well separated and do not overflow; or None."""
    w = np.sqrt(u)
    return w if float(np.min(np.abs(w))) > 0.05 and float(np.max(np.abs(w.imag))) < 300 else None


def _two_waves(w: np.ndarray, A: np.ndarray, face: State, scale: np.ndarray, share: np.ndarray) -> np.ndarray:
    """p in a layer of phase w, at shares (Z,) of it in front of its far face, as the sum of its two waves: (Z, n)."""
    by_q = (0.5j * scale) * (A * face.q) / w
    backward, forward = 0.5 * scale * face.p + by_q, 0.5 * scale * face.p - by_q
    wave = np.exp(np.multiply.outer(1j * share, w[0]))
    out = forward[0] / wave
    wave *= backward[0]
    out += wave
    return out


def by_layer(places: Places) -> Iterator[tuple[int, np.ndarray]]:
    """Layers that hold depths, and the indices of these."""
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

    A depth lies in layer j of a period: the state is carried back through the whole periods behind it in closed form, then
    through the layers behind j, then through the rest of layer j. Each step is linear in the far face's state, so that
    the part that depends on the period (two factors) and the part that depends on the place in the cell (two pressures)
    are made once each and multiplied for each depth. `reference.pressure_inside` does all steps for every depth.
    """
    layers, periods = station.values
    m, b, far = station.matrix, station.bloch, station.far
    assert m is not None
    assert b is not None
    if m.growth is not None or layers.solids:
        return _fill_opaque(station, omega, kx, places, rows, near_log, per_incident, out)
    behind, which = np.unique(periods - 1 - places.period, return_inverse=True)
    states, factors = _in_two_terms(m, b, far, behind, near_log, per_incident)
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


def _in_two_terms(
    m: Matrix, b: BlochPhase, far: State, behind: np.ndarray, near_log: np.ndarray, scale: np.ndarray
) -> tuple[State, np.ndarray]:
    """`power_back` for sorted counts of periods as a sum of two states (2, n) times factors (len(behind), 2, n).

    ``Lambda^n M^-n far = g far + f (M^-1 - I) far`` with x = Lambda^2n - 1 in g = 1 + x/(1 + Lambda) and f = Lambda
    x/(Lambda^2 - 1): factor 1 multiplies `far`, factor x (n at the band edge) multiplies far/(1 + Lambda) + Lambda/(Lambda^2 - 1)
    (M^-1 - I) far; both times exp(log - i phase n) scale.
    """
    reduced, flip, less_one, lam = b.reduced[0], b.flip[0], b.less_one[0], b.eigenvalue[0]
    x2 = less_one * (1 + lam)
    edge = np.abs(x2) < TINY
    moved = _moved(m, b, far)
    by_far, by_moved = np.where(edge, 0.0, 1 / (1 + lam)), lam / np.where(edge, 1.0, x2)
    p, q = (np.concatenate([v, by_far * v + by_moved * dv]) for v, dv in zip(far[:2], moved[:2], strict=True))
    # e^{-i phase n} and e^{2i phase n} - 1 have the sine and the cosine of Re(phase n) in common
    turn, decay = np.multiply.outer(behind, reduced.real), np.multiply.outer(behind, reduced.imag)
    sine, cosine = np.sin(turn), np.cos(turn)
    x = expm1_of_parts(np.expm1(np.maximum(-2 * decay, FADED)), sine, cosine)
    log = far.log[0] - near_log
    size = np.exp(_faint(decay + log.real))
    if np.any(flip):
        size = np.where(flip & (behind % 2 == 1)[:, None], -size, size)
    factors = np.empty((behind.size, 2, reduced.size), complex)
    np.multiply(cosine, size, out=factors[:, 0].real)
    np.multiply(sine, -size, out=factors[:, 0].imag)
    factors[:, 0] *= np.exp(1j * log.imag) * scale
    if np.any(edge):
        x = np.where(edge, behind[:, None], x)
    np.multiply(x, factors[:, 0], out=factors[:, 1])
    return State(p, q, far.log), factors


def _moved(m: Matrix, b: BlochPhase, far: State) -> State:
    """(M^-1 - I) far of +-M, which `power_back` multiplies by f."""
    sign, twice = np.where(b.flip, -1.0, 1.0), np.where(b.flip, 2.0, 0.0)
    p = sign * (m.e22 * far.p - m.e12 * far.q) - twice * far.p
    q = sign * (m.e11 * far.q - m.e21 * far.p) - twice * far.q
    return State(p, q, far.log)


def _faint(exponent: np.ndarray) -> np.ndarray:
    """Exponents below -650 moved to -inf, in place: no denormal numbers."""
    exponent[exponent < -650] = -np.inf
    return exponent


#: Pressures (Z, 2, n) in a layer, of two states, at shares (Z,) of its thickness in front of its far face.
Pressures = Callable[[np.ndarray], np.ndarray]


def _back_through(
    layers: LayerValues, omega: np.ndarray, kx: np.ndarray, places: Places, states: State
) -> Iterator[tuple[np.ndarray, Pressures]]:
    """Carry states (2, n) back through a cell that does not grow: for each layer that holds depths, their indices and its pressures."""
    holding = dict(by_layer(places))
    for j, A, B, face in _faces_back(layers, omega, kx, set(holding), states):
        yield holding[j], _rest_of_layer(A, B, face)


def _faces_back(
    layers: LayerValues, omega: np.ndarray, kx: np.ndarray, wanted: set[int], states: State
) -> Iterator[tuple[int, np.ndarray, np.ndarray, State]]:
    """Carry states (2, n) back through a cell that does not grow: wanted layers, their A and B, states at their far faces."""
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


def _rest_of_layer(A: np.ndarray, B: np.ndarray, face: State) -> Pressures:
    """Pressures in a layer of given A (1, 1) and B (1, n) in front of states (2, n) at its far face."""

    def pressures(share: np.ndarray) -> np.ndarray:
        part = share[:, None, None]
        f = entire(A * B * part**2)  # (Z, 1, n)
        return face.p + (f.c * face.p - A * part * f.s * face.q)

    return pressures


def with_tails(
    layers: LayerValues, omega: np.ndarray, kx: np.ndarray, places: Places
) -> Iterator[tuple[int, np.ndarray, Matrix | None]]:
    """Layers that hold depths, the indices of these, and the matrix of the layers behind in the cell."""
    holding = dict(by_layer(places))
    tail: Matrix | None = None
    for j in reversed(range(min(holding), len(layers.thickness))):
        if j in holding:
            yield j, holding[j], tail
        if j > min(holding):
            layer = layer_matrix(layers, j, omega, kx)
            tail = layer if tail is None else times(layer, tail)


def in_layer(layers: LayerValues, j: int, omega: np.ndarray, kx: np.ndarray, far: State, share: np.ndarray) -> State:
    """The state at shares (Z,) of layer j in front of its far face, where it is `far`, (1, n) or (Z, n)."""
    for slot, run in layers.solids:
        if slot == j:
            v = inside_run(run, omega, kx, far, share * layers.thickness[j])
            return State(v.p, v.q, v.log)
    return layer_back(far, *one_layer(layers, j, omega * omega, kx * kx, share[:, None]))


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
    for j, here, tail in with_tails(layers, omega, kx, places):
        behind = periods - 1 - places.period[here]
        state = power_back(station.matrix, station.bloch, station.far, behind[:, None])
        if tail is not None:
            state = matrix_back(tail, state)
        p, _, log = in_layer(layers, j, omega, kx, state, places.share[here])
        out[rows[here]] = p * np.exp(log - near_log) * per_incident
