"""What the adapters share: questions come on stdin, answers go to stdout. Runs in the programs' environments, on the standard library alone."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable


class Stack:
    """A question: `around` and `layers` as (density, bulk modulus[, thickness]), w, kx, the angle in radians."""

    def __init__(self, entry: dict) -> None:
        self.around = tuple(entry["around"])
        self.layers = [v if isinstance(v, float) else (complex(*v[0]), complex(*v[1]), v[2]) for v in entry["layers"]]
        self.frequency, self.foam = entry["frequency"], entry["foam"]
        self.w, self.angle = 2 * math.pi * self.frequency, math.radians(entry["angle"])
        self.speed = math.sqrt(self.around[1] / self.around[0])
        self.wavelength = self.speed / self.frequency

    def relative(self) -> list[tuple[complex, complex, float]]:
        """Layers as permittivity, permeability and thickness."""
        return [(rho / self.around[0], self.around[1] / K, d) for rho, K, d in self.layers]


def answer(response: Callable[[Stack], tuple[complex, complex]]) -> None:
    """r and t of the pressure for exp(-i w t), phases at the near and the far face, of every question."""
    out = {}
    for name, entry in json.load(sys.stdin).items():
        out[name] = [[complex(v).real, complex(v).imag] for v in response(Stack(entry))]
    json.dump(out, sys.stdout)
