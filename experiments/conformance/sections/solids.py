"""Waves along faces and plates of solids."""

from __future__ import annotations

import math

import beamprop as bp

from .. import published
from ..formulas import solids
from ..records import Row, Section, next_term, printed, rounding

WATER = (1000.0, 1480.0)
#: A fluid too light to load a solid: by its density over theirs, some 1e-9.
NOTHING = (1e-5, 343.0)
SOLIDS = {"steel": (7900.0, 5900.0, 3200.0), "aluminium": (2700.0, 6320.0, 3130.0), "brass": (8400.0, 4400.0, 2200.0)}
ACRYLIC = (1180.0, 2700.0, 1340.0)
FREQUENCY = 1e6
LOAD = next_term(10 * NOTHING[0] / 2000.0)
AIR = (1.2, 343.0)
#: Solids of the package's table whose leaky Rayleigh wave is much faster than sound in water.
TABLE = ("aluminium", "brass", "copper", "fused silica", "steel", "titanium", "tungsten")


def kx_of(solid: tuple, fluid: tuple, fd: float = 0.0, end: float = 1.5, strip: float = 0.02) -> list[complex]:
    """Slownesses of the package's leaky and trapped waves of a half-space, or of a plate of frequency times thickness fd."""
    around, made = bp.Fluid.from_speed(*fluid), bp.Solid(*solid)
    slab = bp.Slab(bp.Layer(made, fd / FREQUENCY), background=around) if fd else bp.Slab.interface(around, made)
    ds = bp.guided_modes(slab, FREQUENCY, kx_over_k0_max=end, strip_over_k0=strip, leaky=True)
    return [complex(k) / (2 * math.pi * FREQUENCY) for k in ds.kx.values]


def nearest(values: list[complex], to: complex) -> complex:
    """Of some waves the one meant."""
    return min(values, key=lambda v: abs(v - to))


def of_faces() -> list[Row]:
    """Rayleigh's, leaky Rayleigh and Scholte waves."""
    poisson = (2500.0, 3000.0 * math.sqrt(3), 3000.0)
    exact = solids.rayleigh_of_poisson_solid()
    ours = nearest(kx_of(poisson, NOTHING, end=1.01), 1 / exact / poisson[2])
    out = [
        Row("Rayleigh's wave over shear waves, cL² = 3 cT²", "Rayleigh 1885", (1 / ours / poisson[2]).real, exact, LOAD)
    ]
    for name, solid in (SOLIDS | {"acrylic": ACRYLIC}).items():
        waves, slow = kx_of(solid, WATER), solids.scholte(solid, WATER)
        speed = 1 / nearest(waves, slow).real
        out.append(
            Row(f"speed (m/s) of the Scholte wave of {name} in water", "Scholte 1947", speed, 1 / slow, rounding(10))
        )
        if solid is not ACRYLIC:
            leaky = solids.leaky_rayleigh(solid, WATER)
            ratio = nearest(waves, leaky) * WATER[1]
            out.append(
                Row(
                    f"kx/k0 of the leaky Rayleigh wave of {name} in water",
                    "Viktorov 1967",
                    ratio,
                    leaky * WATER[1],
                    rounding(10),
                )
            )
    return out


def of_ratios() -> list[Row]:
    """Rayleigh's wave of solids whose cubic has a root in closed form, or one of their own."""
    out = []
    for name, ratio, exact in (
        ("Poisson's ratio 0", math.sqrt(2), math.sqrt(3 - math.sqrt(5))),
        ("Poisson's ratio 0.4", math.sqrt(6), solids.rayleigh((1.0, math.sqrt(6), 1.0))),
        ("cL = 100 cT", 100.0, solids.rayleigh((1.0, 100.0, 1.0))),
    ):
        ours = nearest(kx_of((2500.0, 3000.0 * ratio, 3000.0), NOTHING, end=1.01), 1 / exact / 3000.0)
        out.append(
            Row(f"Rayleigh's wave over shear waves, {name}", "Rayleigh 1885", (1 / ours / 3000.0).real, exact, LOAD)
        )
    return out


def of_angles() -> list[Row]:
    """Rayleigh angles: below water by the loaded face, below air by the free one, which air changes in second order."""
    out = []
    for name in TABLE:
        listed = bp.materials()[name]
        solid = (listed.density, listed.sound_speed, listed.shear_speed)
        for around, fluid in (("water", WATER), ("air", AIR)):
            ours = bp.rayleigh_angle(bp.Fluid.from_speed(*fluid), bp.Solid(*solid))
            leaky = solids.leaky_rayleigh(solid, fluid)
            free = 1 / solids.rayleigh(solid)
            air = fluid is AIR
            sine = fluid[1] * (free if air else leaky.real)
            tolerance = next_term(10 * (leaky.imag / leaky.real) ** 2) if air else rounding(10)
            row = f"Rayleigh angle (degree) of {name} in {around}"
            source = "Rayleigh 1885" if air else "Viktorov 1967"
            out.append(Row(row, source, ours, math.degrees(math.asin(sine)), tolerance))
    return out


def of_plates() -> list[Row]:
    """Lamb waves of free plates, and a plate so thin that one is left."""
    out = []
    for name, solid in SOLIDS.items():
        thin = solids.thin_plate(solid)
        speed = 1 / nearest(kx_of(solid, NOTHING, 10.0, end=1.01), 1 / thin).real
        second = (math.pi * 10.0 / thin) ** 2 / 6  # a bound of (nu kx d)^2/(24 (1 - nu)^2) for nu up to 1/2
        out.append(
            Row(f"speed (m/s) of S0, {name} 0.01 MHz mm", "Lamb 1917, thin plates", speed, thin, next_term(second))
        )
        waves = kx_of(solid, NOTHING, 3000.0, end=1.01)
        for i, exact in enumerate(solids.lamb(3000.0, solid)):
            ours = nearest(waves, exact).real
            out.append(Row(f"slowness (s/m) of Lamb wave {i}, {name} 3 MHz mm", "Lamb 1917", ours, exact, LOAD))
    return out


def of_brass() -> list[Row]:
    """Every printed wave of a brass plate in water; both signs of Im are printed, and ours is told by the direction."""
    out = []
    for mhz, waves in published.BRASS_IN_WATER.items():
        ours = [s * WATER[1] for s in kx_of(SOLIDS["brass"], WATER, 1e3 * mhz, end=1.3, strip=0.12)]
        if len(ours) != len(waves):
            raise ValueError(f"brass: expected {len(waves)} waves, got {len(ours)}")
        for i, (real, imaginary) in enumerate(waves):
            exact = complex(real, imaginary)
            value = nearest([complex(k.real, abs(k.imag)) for k in ours], exact)
            name = f"kx/k0 of a brass plate in water, {mhz:.3f} MHz mm, wave {i}"
            out.append(Row(name, "Kiefer et al. 2019", value, exact, printed(math.sqrt(2) * 1e-9, exact)))
    return out


def rows() -> list[Row]:
    """Faces, plates, and a published spectrum."""
    return of_faces() + of_ratios() + of_angles() + of_plates() + of_brass()


SECTION = Section(
    "Solids",
    "Waves along faces and plates of solids, by the textbook's equations and as printed. Free solids are those in a fluid of 1e-5 kg/m3. "
    "Rayleigh angles are those of the package's table of materials. "
    "The spectrum of a brass plate is that of `experiments/conformance/published.py`, and is found complete.",
    rows,
)
