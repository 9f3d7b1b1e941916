"""pymls: fluids and porous layers in its own air, for exp(+j w t): conjugated."""

import cmath
import math

from mediapack import Air, EqFluidJCA, Fluid
from protocol import Stack, answer
from pymls import Layer, Solver, backing


def medium(stack: Stack, layer: float | tuple[complex, complex, float]) -> tuple[object, float]:
    """A fluid, or the foam."""
    if isinstance(layer, float):
        return EqFluidJCA(**stack.foam), layer
    rho, K, thickness = layer
    return Fluid(rho=rho.real, c=cmath.sqrt(K / rho).real), thickness


def response(stack: Stack) -> tuple[complex, complex]:
    """Between two half-spaces of its air."""
    if not (Air.rho == stack.around[0] and math.isclose(Air.K, stack.around[1])):
        raise ValueError(f"pymls' air is no longer {stack.around}: {Air.rho}, {Air.K}")
    solver = Solver(layers=[Layer(*medium(stack, layer)) for layer in stack.layers], backing=backing.transmission)
    out = solver.solve(stack.frequency, math.degrees(stack.angle))
    return out["R"][0].conjugate(), out["T"][0].conjugate()


answer(response)
