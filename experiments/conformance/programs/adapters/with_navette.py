"""navette: p-polarised light by its scattering matrices; lengths in its nanometres, scaled."""

import cmath
import math

import numpy as np
from navette import _smatrix
from protocol import Stack, answer


def response(stack: Stack) -> tuple[complex, complex]:
    """Indices with permeability 1; smooth faces."""
    layers = stack.relative()
    indices = np.array([1, *(cmath.sqrt(permittivity) for permittivity, _, _ in layers), 1], complex)
    thicknesses = np.array([0.0, *(1e9 * d for _, _, d in layers), 0.0])
    smooth = np.zeros(indices.size)
    out = _smatrix.solve_coherent_block_fields(
        0,
        indices.size - 1,
        indices,
        thicknesses,
        smooth,
        smooth.astype(np.int32),
        1e9 * stack.wavelength,
        complex(math.sin(stack.angle)),
        1,
    )
    return -out[0], out[2]  # it counts r of the electric field along its own direction


answer(response)
