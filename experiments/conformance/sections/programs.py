"""Other programs: what they answered in their live runs."""

from __future__ import annotations

import beamprop as bp

from ..programs import live
from ..programs.stacks import ANGLES, FOAM, PROGRAMS, PYMLS_GAS, STACKS, Stack, question
from ..records import Row, Section, rounding
from .ask import plane_wave


def slab(stack: Stack) -> bp.Slab:
    """The package's slab of a stack."""
    foam = bp.johnson_champoux_allard(
        FOAM["sigma"], FOAM["phi"], FOAM["alpha"], FOAM["Lambda"], FOAM["Lambda_prime"], gas=bp.Gas(*PYMLS_GAS)
    )
    layers = [bp.Layer(foam, v) if isinstance(v, float) else bp.Layer(bp.Fluid(*v[:2]), v[2]) for v in stack.layers]
    return bp.Slab(layers, background=bp.Fluid(*stack.around))


def rows() -> list[Row]:
    """r and t of every question; each layer may round as both sides do."""
    out, stored = [], live.stored()
    for program in PROGRAMS.values():
        entry = stored[program.name]
        source = f"{program.name} {entry['version']}, {entry['date']}"
        for name in program.stacks:
            structure = slab(STACKS[name])
            tolerance = rounding(max(10, len(STACKS[name].layers)))
            for angle in ANGLES:
                ours = plane_wave(structure, STACKS[name].frequency, angle=angle)
                theirs = [complex(*v) for v in entry["answers"][question(name, angle)]]
                for what, a, b in zip("rt", ours, theirs, strict=True):
                    out.append(Row(f"{what} of {question(name, angle)}", source, a, b, tolerance, scale=1))
    return out


SECTION = Section(
    "Other programs",
    "Plane waves through stacks of layers by programs from PyPI, each run in an environment of its own; the optical ones take pressure for "
    "the magnetic field, relative density for permittivity and inverse relative modulus for permeability.",
    rows,
)
