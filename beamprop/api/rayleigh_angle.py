"""`rayleigh_angle`: the angle at which a beam in a fluid excites the leaky Rayleigh wave of a solid."""

from __future__ import annotations

import numpy as np

from .. import validate
from ..media.fluids import Fluid
from ..media.solids import Solid
from ..media.structures import Slab
from .guided_modes import guided_modes

#: Leaky Rayleigh waves are searched for up to this |Im kx| over k0: light solids in water reach 0.1.
STRIP = 0.2


def rayleigh_angle(fluid: Fluid, solid: Solid, frequency: float = 1e6) -> float:
    """The angle of incidence [degree] at which the leaky Rayleigh wave of a solid under a fluid is in step with a plane wave.

    Its sine is Re kx/k0 of the pole of reflection that is slower than the solid's shear wave and faster than sound in
    the fluid (`guided_modes` of ``Slab.interface(fluid, solid)``), which differs a little from that of the free solid's wave.

    Parameters
    ----------
    fluid : Fluid
    solid : Solid
    frequency : float, Hz
        The angle depends on it only where the properties do.

    Raises
    ------
    ValueError
        The solid has no leaky Rayleigh wave: its shear wave is slower than sound in the fluid.

    Notes
    -----
    Viktorov, *Rayleigh and Lamb Waves* (1967), chapter 1.

    Examples
    --------
    >>> water, steel = bp.Fluid.from_speed(1000.0, 1480.0), bp.Solid(7900.0, 5900.0, 3200.0)
    >>> round(bp.rayleigh_angle(water, steel), 2)
    29.94
    """
    validate.instance(fluid, Fluid, "fluid")
    validate.instance(solid, Solid, "solid")
    f = validate.as_number(frequency, "frequency", positive=True)
    values, k0 = solid.at(np.array([f])), float(fluid.wavenumber(np.array([f]))[0].real)
    if not 0 < k0 < np.inf:
        raise ValueError(f"fluid: expected one that carries forward waves at {f} Hz, got {fluid!r}")
    shear = 2 * np.pi * f * abs(complex(np.sqrt(values.density / values.shear_modulus)[0])) / k0
    if shear < 1:
        modes = guided_modes(Slab.interface(fluid, solid), f, kx_over_k0_max=1.5, strip_over_k0=STRIP, leaky=True)
        k = modes.kx_over_k0.values
        leaky = k[(k.real > shear) & (k.real < 1) & (k.imag >= 0)]
    if shear >= 1 or not leaky.size:
        expected = (
            "one with a leaky Rayleigh wave in the fluid, faster than sound in it and slower than its own shear wave"
        )
        raise validate.refuse("solid", expected, solid)
    return float(np.degrees(np.arcsin(leaky[0].real)))
