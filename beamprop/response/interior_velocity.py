"""The particle velocity inside a slab, from the states that the recursion left at the faces.

The state (p, q) tells both components: ``v_z = q/(i w)``, and ``v_x = kx p/(w rho_x)``, of which `fill_velocity` gives the factor of
kx, even in kx as p and v_z are. Neither divides by a density along z, which may be 0; 1/rho_x is a layer's mobility over its
thickness, 0 for an infinite density.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..arrays.matmul import BLOCK
from ..media.values import LayerValues
from .cell import matrix_back
from .interior import ROWS, by_layer, station_at, with_tails
from .layer import State, layer_back, one_layer
from .periods import power_back
from .recursion import Places, Station, places_of, segment_of
from .solid_run import inside_run, quantity_of, without_zero


def fill_velocity(
    stations: list[Station],
    omega: np.ndarray,
    kx: np.ndarray,
    z: np.ndarray,
    near_log: np.ndarray,
    per_incident: np.ndarray,
    quantity: str,
) -> np.ndarray:
    """v_z, or v_x or s_xz over kx, at depths z inside the slab per unit incident pressure: (F, Z, n).

    A depth on an interface belongs to the layer that begins there.
    """
    out = np.empty((kx.shape[0], z.size, kx.shape[1]), complex)
    owner = segment_of(np.array([s.start for s in stations]), z)
    size = max(ROWS, BLOCK // (4 * kx.shape[1]))  # depths whose states stay in the cache
    for index, station in enumerate(stations):
        rows = np.flatnonzero(owner == index)
        for start in range(0, rows.size, size):
            block = rows[start : start + size]
            places = places_of(station.values, z[block] - station.start)
            for i in range(kx.shape[0]):
                w, k, at_i = omega[i : i + 1], kx[i : i + 1], station_at(station, i)
                layers = at_i.values.layers
                for j, here, behind in _states_behind(at_i, w, k, places):
                    v, log = _velocity(layers, j, (w, k), behind, places.share[here], quantity)
                    out[i, block[here]] = v * np.exp(log - near_log[i]) * per_incident[i]
    return out


def _velocity(
    layers: LayerValues,
    j: int,
    w_and_kx: tuple[np.ndarray, np.ndarray],
    behind: State,
    share: np.ndarray,
    quantity: str,
) -> tuple[np.ndarray, np.ndarray]:
    """A quantity of `fill_velocity`, and its logarithm at shares (Z,) of a layer."""
    w, kx = w_and_kx
    run = dict(layers.solids).get(j)
    if run is None:
        state = layer_back(behind, *one_layer(layers, j, w * w, kx * kx, share[:, None]))
        if quantity == "s_xz":
            return 0 * state.p, state.log
        v = -1j * state.q if quantity == "v_z" else state.p * (layers.mobility[j, 0] / layers.thickness[j])
        return v / w, state.log
    inside = inside_run(run, w, without_zero(kx, w), behind, share * layers.thickness[j])
    return quantity_of(inside, quantity, w, without_zero(kx, w)), inside.log


def _states_behind(
    station: Station, omega: np.ndarray, kx: np.ndarray, places: Places
) -> Iterator[tuple[int, np.ndarray, State]]:
    """Layers that hold depths, the indices of these, and the states at the layer's far face in their periods."""
    if station.matrix is None or station.bloch is None:
        yield from ((j, here, station.faces[j]) for j, here in by_layer(places))
        return
    for j, here, tail in with_tails(station.values.layers, omega, kx, places):
        periods = station.values.periods - 1 - places.period[here]
        state = power_back(station.matrix, station.bloch, station.far, periods[:, None])
        yield j, here, state if tail is None else matrix_back(tail, state)
