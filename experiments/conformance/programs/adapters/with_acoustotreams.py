"""acoustotreams: layered fluids by scattering matrices of plane waves; k0 is that of its own air, 343 m/s."""

import cmath
import math

from acoustotreams import AcousticMaterial, AcousticSMatrices, ScalarPlaneWaveBasisByComp
from protocol import Stack, answer


def response(stack: Stack) -> tuple[complex, complex]:
    """Of a wave that goes up."""
    k = stack.w / stack.speed
    basis = ScalarPlaneWaveBasisByComp([(k * math.sin(stack.angle), 0.0)])
    around = AcousticMaterial(stack.around[0], stack.speed)
    inside = [AcousticMaterial(rho, cmath.sqrt(K / rho)) for rho, K, _ in stack.layers]
    thicknesses = [d for _, _, d in stack.layers]
    slab = AcousticSMatrices.slab(thicknesses, basis, stack.w / AcousticMaterial().c, [around, *inside, around])
    return complex(slab[1, 0][0, 0]), complex(slab[0, 0][0, 0])


answer(response)
