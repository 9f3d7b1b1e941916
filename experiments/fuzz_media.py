"""Media in words with random arguments: materials, attenuations, tables, models; each is evaluated at a frequency, too."""

from __future__ import annotations

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from fuzz_cases import Rng, draw_slab, draw_text_file, fluid, magnitude, pick

import beamprop as bp

#: A function, and what makes the arguments that it needs and those that may be left out.
Entry = tuple[Callable[..., Any], dict[str, Any], dict[str, Any]]


def evaluated(make: Callable[..., Any]) -> Callable[..., Any]:
    """The function, its fluid or membrane evaluated before it is given."""

    @functools.wraps(make)
    def made(*args: Any, **arguments: Any) -> Any:
        medium = make(*args, **arguments)
        medium.at(np.array([700.0, 2500.0]))
        return medium

    return made


def share(rng: Rng) -> float:
    return float(rng.uniform(0.01, 1.2))


def gas(rng: Rng) -> bp.Gas:
    return bp.Gas(*(magnitude(rng) for _ in range(3)))


def attenuation(rng: Rng) -> Any:
    return pick(
        rng, (0.0, magnitude(rng), bp.power_law(1.0, 1e3, float(rng.uniform(0.1, 2)), bool(rng.random() < 0.5)))
    )


def name(rng: Rng) -> str:
    return pick(rng, [*bp.materials(), "Aluminum", "watr", ""])


def table(rng: Rng) -> Path:
    """A file that holds a table, or a line of it with a cell that is wrong."""
    path = draw_text_file(rng)
    cells = [pick(rng, ("1", "2.5", "", "x", "-1", "1e-3", "steel", "1+0.1i")) for _ in range(4)]
    header = ["thickness_mm", pick(rng, ("density", "material", "areal_density")), "sound_speed", "attenuation (dB/cm)"]
    rows = [header, ["1", "steel", "", ""] if "material" in header else ["0", "0.1", "", ""]]
    if "density" in header:
        rows[1] = ["1", "1000", "1500", ""]
    path.write_text("\n".join(",".join(row) for row in (*rows, cells)[: pick(rng, (2, 3))]), encoding="utf-8")
    return path


def mixture(first: Any, second: Any, fraction: Any = 0.3) -> bp.Fluid:
    return bp.wood_mixture((first, fraction), (second, 0.7))


def tabulated(frequency: Any, values: Any) -> Any:
    return bp.Tabulated(frequency, values)(1.5)


MEDIA_CALLS: dict[str, Entry] = {
    "Gas": (bp.Gas, {}, {"density": magnitude, "pressure": magnitude, "viscosity": magnitude, "prandtl": magnitude}),
    "Membrane.drude": (
        evaluated(bp.Membrane.drude),
        {"areal_density": magnitude, "cutoff_frequency": magnitude},
        {"linewidth": magnitude},
    ),
    "Membrane.lorentz": (
        evaluated(bp.Membrane.lorentz),
        {"areal_density": magnitude, "resonance_frequency": magnitude, "resonator_density": magnitude},
        {"linewidth": magnitude},
    ),
    "Slab.from_table": (bp.Slab.from_table, {"table": table}, {"periods": lambda r: 3, "background": fluid}),
    "Slab.interface": (bp.Slab.interface, {}, {"before": fluid, "after": fluid}),
    "Tabulated": (
        tabulated,
        {"frequency": lambda r: np.cumsum(r.uniform(0.1, 2, 4)), "values": lambda r: r.normal(size=4)},
        {},
    ),
    "from_speed, attenuation": (
        evaluated(bp.Fluid.from_speed),
        {"density": magnitude, "sound_speed": magnitude, "attenuation": attenuation},
        {"active": lambda r: True},
    ),
    "delany_bazley_miki": (
        evaluated(bp.delany_bazley_miki),
        {"flow_resistivity": lambda r: 1e4 * share(r)},
        {"gas": gas},
    ),
    "johnson_champoux_allard": (
        evaluated(bp.johnson_champoux_allard),
        {
            "flow_resistivity": magnitude,
            "porosity": share,
            "tortuosity": lambda r: 1 + magnitude(r),
            "viscous_length": magnitude,
            "thermal_length": magnitude,
        },
        {"gas": gas},
    ),
    "material": (
        evaluated(bp.material),
        {"name": name},
        {"temperature": lambda r: 30 * share(r), "humidity": lambda r: 90 * share(r), "attenuation": attenuation},
    ),
    "materials": (bp.materials, {}, {}),
    "narrow_slits": (evaluated(bp.narrow_slits), {"width": magnitude}, {"porosity": share, "gas": gas}),
    "narrow_tubes": (evaluated(bp.narrow_tubes), {"radius": magnitude}, {"porosity": share, "gas": gas}),
    "power_law": (
        bp.power_law,
        {"db_per_cm": magnitude, "reference_frequency": magnitude},
        {"exponent": lambda r: 2 * share(r), "dispersion": lambda r: True},
    ),
    "tolerance": (
        lambda *args, **arguments: bp.tolerance(*args, **arguments)[0].thickness,
        {"slab": draw_slab},
        {"thickness": lambda r: 0.2 * share(r), "density": lambda r: 0.2 * share(r), "seed": lambda r: 3},
    ),
    "wood_mixture": (evaluated(mixture), {"first": fluid, "second": fluid}, {"fraction": share}),
}
