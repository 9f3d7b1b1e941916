"""tmm: p-polarised light; r and t of the electric field are those of the magnetic one between equal half-spaces."""

import cmath
import math

import tmm
from protocol import Stack, answer


def response(stack: Stack) -> tuple[complex, complex]:
    """By indices, with a permeability of 1."""
    layers = stack.relative()
    indices = [1, *(cmath.sqrt(permittivity) for permittivity, _, _ in layers), 1]
    thicknesses = [math.inf, *(d for _, _, d in layers), math.inf]
    out = tmm.coh_tmm("p", indices, thicknesses, stack.angle, stack.wavelength)
    return out["r"], out["t"]


answer(response)
