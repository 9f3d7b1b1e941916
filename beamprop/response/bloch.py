"""Bloch waves of an infinite stack."""

from __future__ import annotations

import numpy as np

from ..media.values import LayerValues, SegmentValues
from .cell import cell_matrix
from .conditioning import ROUNDING, SHIFT
from .layer import perturbed
from .periods import bloch_phase


def bloch_wavenumber(layers: LayerValues, omega: np.ndarray, kx: np.ndarray) -> np.ndarray:
    """kz of the Bloch wave that decays, or where none does carries energy, along +z; continuous along kx. (F, n)."""
    m = cell_matrix(layers, omega, kx)
    phase = bloch_phase(m).phase
    ratio = (np.exp(1j * phase - (0.0 if m.growth is None else m.growth)) - m.a - m.e11) / np.where(
        m.e12 == 0, 1, m.e12
    )
    neither = _undamped(phase)
    phase = np.where(neither, phase.real + 0j, phase)  # rounding decides nothing
    phase = np.where(neither & ((ratio / 1j).real < 0), -phase, phase)
    return _unwrapped(phase, kx.real) / layers.thickness.sum()


def _undamped(phase: np.ndarray) -> np.ndarray:
    """Where a phase has an imaginary part that may be rounding: it is left out."""
    return np.abs(phase.imag) <= 1e-11 * (1 + np.abs(phase))


def bloch_error(layers: LayerValues, omega: np.ndarray, kx: np.ndarray) -> np.ndarray:
    """Estimated error of `bloch_wavenumber` [rad/m]: its change with the last bits of kx and of the layers. (F, n).

    At a band edge kz is a square root of them. Whole turns and the sign are left out: near an edge they are not told by kz.
    """
    moved = perturbed(SegmentValues(layers, 1), SHIFT).layers
    one = bloch_phase(cell_matrix(layers, omega, kx)).phase
    two = bloch_phase(cell_matrix(moved, omega, kx * (1 + SHIFT * np.exp(0.7j)))).phase
    change = np.minimum(*(np.abs(_without_turns(one - way * two)) for way in (1, -1)))
    left_out = np.where(_undamped(one), np.abs(one.imag), 0.0)
    error = (change + left_out + ROUNDING * np.abs(one)) / layers.thickness.sum()
    return np.where(np.isfinite(error), error, np.inf)


def _without_turns(phase: np.ndarray) -> np.ndarray:
    return phase - 2 * np.pi * np.rint(phase.real / (2 * np.pi))


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
