"""PyMoosh: TM waves of the magnetic field, with permittivity and permeability; lengths in its nanometres, scaled."""

import contextlib
import sys

import numpy as np
from protocol import Stack, answer

with contextlib.redirect_stdout(sys.stderr):
    import PyMoosh


def response(stack: Stack) -> tuple[complex, complex]:
    """By scattering matrices."""
    layers = stack.relative()
    materials = [
        [1.0, 1.0],
        *([complex(permittivity), complex(permeability)] for permittivity, permeability, _ in layers),
    ]
    order = [0, *range(1, len(materials)), 0]
    thicknesses = np.array([0.0, *(1e9 * d for _, _, d in layers), 0.0])
    structure = PyMoosh.Structure(materials, order, thicknesses, verbose=False)
    return PyMoosh.coefficient(structure, 1e9 * stack.wavelength, stack.angle, 1)[:2]


answer(response)
