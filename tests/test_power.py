"""The radiated power of beams whose plane waves meet narrow resonances, against integrals that are told where these are."""

import re
import warnings

import mpmath as mp
import numpy as np
import pytest
from panels import panels
from scipy.optimize import brentq
from sided import BULK, LAM, RHO, F

import beamprop as bp

AIR_GAP = (RHO, BULK, LAM / 2)
WATER = (1000.0, 1000.0 * 1480.0**2, 1480.0 / F / 4)
STEEL = (7800.0, 7800.0 * 5900.0**2, 5900.0 / F / 4)


def mismatch(layers, k, frequency):
    """X(k), real: |t|^2 = 1/(1 + X^2) of layers that are the same from both sides, in air; 0 at resonance. With 30 digits."""
    with mp.workdps(30):
        omega, k = mp.mpf(2 * np.pi * frequency), mp.mpf(float(k))
        m = mp.eye(2)
        for rho, K, d in (tuple(map(mp.mpf, layer)) for layer in layers):
            kz = mp.sqrt(omega**2 * rho / K - k**2)
            c, s = mp.cos(kz * d), mp.sin(kz * d)
            m = mp.matrix([[c, rho * s / kz], [-kz * s / rho, c]]) * m
        y = mp.sqrt(omega**2 * RHO / BULK - k**2) / RHO
        return float(mp.re(m[1, 0] / y + m[0, 1] * y) / 2)


def transmitted_share(layers, frequency, fwhm, angle):
    """Share of a Gaussian's power that passes, and the number of resonances off the normal.

    Gauss panels on both sides of each resonance, graded towards it, and towards kx = 0.
    """
    k0, a = 2 * np.pi * frequency / 343.0, fwhm / 2 / np.sqrt(np.log(2))
    coarse = k0 * np.concatenate([[0.0], np.geomspace(1e-7, 0.999, 300)])
    values = [mismatch(layers, k, frequency) for k in coarse]
    resonances = [
        brentq(lambda k: mismatch(layers, k, frequency), coarse[i], coarse[i + 1], xtol=1e-18, rtol=1e-15)
        for i in np.flatnonzero(np.diff(np.sign(values)))
    ]
    graded = k0 * np.concatenate([[0.0], np.geomspace(1e-13, 1.0, 100)])
    edges = np.unique(np.concatenate([[0.0, k0], graded, *(k + sign * graded for k in resonances for sign in (1, -1))]))
    edges = edges[(edges >= 0) & (edges <= k0)]
    k, weight = panels(edges, 16)
    off = k0 * np.sin(np.radians(angle))
    launched = sum(np.exp(-((a * (k - side * off)) ** 2) / 2) for side in (1, -1)) * np.sqrt(k0**2 - k**2) * weight
    share = launched / launched.sum()
    strong = share > 1e-25
    passes = np.array([1 / (1 + mismatch(layers, kx, frequency) ** 2) for kx in k[strong]])
    return share[strong] @ passes, len(resonances)


def measured(layers, frequency, rtol):
    """Shares of power that the package finds, and the error of them that it warned of, or None."""
    slab = bp.Slab([bp.Layer(bp.Fluid(rho, K), d) for rho, K, d in layers])
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        ds = bp.beam_measures(slab, bp.GaussianBeam(0.5, 3, 0, -0.1), frequency, window=1.0, rtol=rtol)
    told = [re.match(r"estimated error (\S+) of a power", str(w.message)) for w in said]
    return ds.power.values, next((float(match[1]) for match in told if match), None)


@pytest.mark.parametrize(("beside", "resonances"), [(0.0, 0), (-1e-5, 0), (1e-5, 1), (1e-3, 1), (0.02, 1), (0.9, 1)])
def test_power_through_a_cavity_between_mirrors(beside, resonances):
    """Air between quarter waves of water, which are 3500 times as hard: at resonance all passes, beside it 1e-13.

    Above the frequency of the resonance at normal incidence there is one at some angle, a millionth of the angles wide and less,
    through which most of the power goes. What is missing from the reflection, in as narrow a minimum, is that power.
    """
    rtol, layers, frequency = 1e-5, [WATER, AIR_GAP, WATER], F * (1 + beside)
    truth, count = transmitted_share(layers, frequency, 0.5, 3)
    (reflected, transmitted), told = measured(layers, frequency, rtol)
    assert count == resonances
    assert transmitted == pytest.approx(truth, rel=rtol)
    assert reflected + transmitted == pytest.approx(1, abs=1e-9)
    assert told is None


def test_power_that_the_last_bits_decide():
    """Mirrors 100 000 times as hard as air, at resonance at normal incidence: rounding of the frequency moves the power, by what
    is told."""
    layers = [STEEL, AIR_GAP, STEEL]
    truth, _ = transmitted_share(layers, F, 0.5, 3)
    (_, transmitted), told = measured(layers, F, 1e-8)
    assert 1e-8 < told < 1e-3
    assert transmitted == pytest.approx(truth, rel=3 * told)
