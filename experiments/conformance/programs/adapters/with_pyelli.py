"""pyElli: p-polarised light by 4 x 4 matrices; lengths in its nanometres, scaled."""

import cmath
import math

import elli
from protocol import Stack, answer


def material(permittivity: complex) -> elli.IsotropicMaterial:
    """A fixed index; pyElli takes n + i k for exp(-i w t)."""
    n = cmath.sqrt(permittivity)
    return elli.ConstantRefractiveIndex(n).get_mat()


def response(stack: Stack) -> tuple[complex, complex]:
    """r and t of the electric field, which are those of the magnetic one between equal half-spaces."""
    layers = [elli.Layer(material(permittivity), 1e9 * d) for permittivity, _, d in stack.relative()]
    structure = elli.Structure(material(1), layers, material(1))
    out = structure.evaluate(1e9 * stack.wavelength, math.degrees(stack.angle))
    return complex(out.r_pp.squeeze()), complex(out.t_pp.squeeze())


answer(response)
