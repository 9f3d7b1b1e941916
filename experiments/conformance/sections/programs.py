"""Other programs: what they answered in their live runs."""

from __future__ import annotations

import beamprop as bp

from .. import published
from ..programs import live
from ..programs.stacks import ANGLES, FOAM, PROGRAMS, PYMLS_AIR, PYMLS_GAS, STACKS, Stack, question
from ..records import Row, Section, rounding
from .ask import plane_wave


def slab(stack: Stack) -> bp.Slab:
    """The package's slab of a stack."""
    foam = bp.johnson_champoux_allard(
        FOAM["sigma"], FOAM["phi"], FOAM["alpha"], FOAM["Lambda"], FOAM["Lambda_prime"], gas=bp.Gas(*PYMLS_GAS)
    )
    layers = [bp.Layer(foam, v) if isinstance(v, float) else bp.Layer(bp.Fluid(*v[:2]), v[2]) for v in stack.layers]
    return bp.Slab(layers, background=bp.Fluid(*stack.around))


def of_planes() -> list[Row]:
    """Foams in air by PLANES, as pymls' tests have it."""
    out, air = [], bp.Fluid(*PYMLS_AIR)
    foams = {name: bp.johnson_champoux_allard(*v, gas=bp.Gas(*PYMLS_GAS)) for name, v in published.PLANES_FOAMS.items()}
    for (layers, angle, frequency), *theirs in published.PLANES:
        structure = bp.Slab([bp.Layer(foams[name], d) for name, d in layers], background=air)
        ours = plane_wave(structure, frequency, angle=angle)
        names = " on ".join(f"{1e3 * d:g} mm of {name}" for name, d in layers)
        for what, a, b in zip("rt", ours, theirs, strict=True):
            place = f"{what} of {names}, {frequency:.0f} Hz, {angle:g}°"
            out.append(Row(place, "PLANES, tables of pymls", a, b.conjugate(), rounding(10), scale=1))
    return out


def of_live_runs() -> list[Row]:
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


def rows() -> list[Row]:
    """Live runs and a printed table."""
    return of_live_runs() + of_planes()


SECTION = Section(
    "Other programs",
    "Plane waves through stacks of layers by programs from PyPI, each run in an environment of its own; the optical ones take pressure for "
    "the magnetic field, relative density for permittivity and inverse relative modulus for permeability. The foams of the tables of pymls are in `experiments/conformance/published.py`.",
    rows,
)
