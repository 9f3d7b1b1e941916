"""
A double wall: mass law, resonance of the air between, and wool in it
=====================================================================

Two limp leaves of 10 kg/m2, 10 cm apart, let all sound of 86.0 Hz through at normal incidence, where the masses swing on the air
(the usual formula says 86.3 Hz), and of 171.9 Hz at 60 degrees; at 1000 Hz they hold back 80.4 dB, and a single leaf of the same
mass 43.3 dB.
At 1719.3 Hz, where the air is half a wave thick, all passes again, 0.0 dB; with mineral wool in between, 98.3 dB are left there.
"""

import numpy as np
import xarray as xr
from gallery_main import PAGE, main, panels
from scipy.optimize import brentq

import beamprop as bp

MASS, DEPTH = 10.0, 0.1
WOOL = bp.johnson_champoux_allard(15e3, 0.98, 1.0, viscous_length=80e-6, thermal_length=160e-6)


def double_wall(fluid):
    """Two leaves with a layer of a fluid between."""
    return bp.Slab(bp.Cell([bp.Membrane(MASS), bp.Layer(fluid, DEPTH), bp.Membrane(MASS)]), background=bp.AIR)


def loss(wall, frequency, angle=0.0):
    """Transmission loss [dB]."""
    return -10 * np.log10(bp.scattering(wall, frequency, angle=angle).energy_transmission)


def closed_form(frequency):
    """Transmission loss of the empty wall, from t = e^(ikd)/((1 + z)^2 - z^2 e^(2ikd)), z = -i omega m/(2 rho c)."""
    omega = 2 * np.pi * frequency
    z = -0.5j * omega * MASS / (1.25 * 343)
    return 20 * np.log10(abs((1 + z) ** 2 - z**2 * np.exp(2j * omega / 343 * DEPTH)))


def resonance(order, angle=0.0):
    """Frequency [Hz] at which all passes: tan(k d cos) = 2 rho c/(omega m cos), k d cos from order pi to a quarter-wave more."""
    cosine, step = np.cos(np.radians(angle)), 343 / (4 * DEPTH)

    def mismatch(f):
        phase = 2 * np.pi * f / 343 * DEPTH * cosine
        return np.sin(phase) - np.cos(phase) * 2 * 1.25 * 343 / (2 * np.pi * f * MASS * cosine)

    return brentq(mismatch, (2 * order + 1e-6) * step / cosine, (2 * order + 1) * step / cosine)


def study(quick=False):
    """Transmission losses from 30 Hz to 5 kHz of three walls, and of the double one where all passes."""
    lowest, oblique, second = resonance(0), resonance(0, 60.0), resonance(1)
    sharp = [resonance(order) * np.linspace(0.98, 1.02, 41) for order in (0, 1, 2)]
    frequency = np.unique(np.concatenate([np.geomspace(30, 5000, 101 if quick else 601), *sharp]))
    empty, filled = double_wall(bp.AIR), double_wall(WOOL)
    single = bp.Slab(bp.Membrane(2 * MASS), background=bp.AIR)
    walls = {"single leaf": single, "double wall": empty, "with wool": filled}
    return {
        "leaf_kg": MASS,
        "depth_cm": 100 * DEPTH,
        "resonance_hz": lowest,
        "formula_hz": np.sqrt(2 * 1.25 * 343**2 / (MASS * DEPTH)) / (2 * np.pi),
        "oblique_hz": oblique,
        "oblique_angle": 60,
        "at_hz": 1000,
        "double_db": float(loss(empty, 1000.0)),
        "single_db": float(loss(single, 1000.0)),
        "half_wave_hz": second,
        "half_wave_db": float(loss(empty, second)),
        "wool_db": float(loss(filled, second)),
        "mass_law_db": 20 * np.log10(abs(1 - 1j * np.pi * 1000 * 2 * MASS / (1.25 * 343))),
        "largest_difference_db": float(abs(loss(empty, frequency) - closed_form(frequency)).max()),
        "resonance_db": float(loss(empty, lowest)),
        "oblique_db": float(loss(empty, oblique, 60.0)),
        "losses": xr.Dataset({name: loss(wall, frequency) for name, wall in walls.items()}),
    }


def picture(result, width=PAGE):
    """Transmission losses by frequency."""
    figure, (ax,) = panels(1, width / 2 if width == PAGE else width)
    for name, values in result["losses"].items():
        ax.plot(values.frequency, values, label=name)
    ax.set(xlabel="frequency [Hz]", ylabel="transmission loss, 0° [dB]", xscale="log", ylim=(0, None))
    ax.legend(loc="upper left")
    return figure


if __name__ == "__main__":
    main(study, picture)
