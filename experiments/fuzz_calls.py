"""Every public function with random arguments, good and bad."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from fuzz_cases import (
    SEED,
    Case,
    bad,
    cplx,
    draw_answer,
    draw_axis,
    draw_beam,
    draw_field,
    draw_flag,
    draw_nodes,
    draw_slab,
    draw_text_file,
    fluid,
    magnitude,
    medium,
    pick,
    real,
)
from fuzz_media import MEDIA_CALLS

import beamprop as bp


def draw_variables(rng: Any) -> Any:
    """What a field is asked for."""
    return pick(
        rng, ("p", "v_x", ["v_z", "intensity"], "power_through", ["p", "v_x", "v_z", "intensity", "power_through"])
    )


def spectrum(kx_over_k0: Any, eta: Any = 1 / 60) -> Any:
    """A question of a sweep."""
    return bp.scattering(bp.Slab(bp.lmmd_cell(eta=eta), 5), 2500.0, kx_over_k0=kx_over_k0)


def draw_axes(rng: Any) -> Any:
    """Axes of a sweep of few points, now and then of names that the question does not have."""
    name = pick(rng, ("kx_over_k0", "kx_over_k0", "eta", "frequency"))
    axes = {"kx_over_k0": rng.uniform(0, 5, 3), name: rng.uniform(0.01, 0.1, 2)}
    return pick(rng, (axes, axes, {}, [("kx_over_k0", [0.0])]))


FREQUENCY, X, Z, ANGLE = draw_axis(500, 5000), draw_axis(-2, 2), draw_axis(0, 1), draw_axis(-80, 80)
#: Of questions that take longer.
FEW, ONE_OR_TWO = draw_axis(1000, 3000, 3), draw_axis(-60, 60, 2)
#: Every public function, and what makes its arguments; those in the second table may be left out.
CALLS: dict[str, tuple[Callable[..., Any], dict[str, Any], dict[str, Any]]] = {
    "Fluid": (
        bp.Fluid,
        {"density": lambda r: cplx(r, 1), "bulk_modulus": lambda r: cplx(r, -1)},
        {"density_x": real, "active": draw_flag},
    ),
    "Fluid.from_speed": (bp.Fluid.from_speed, {"density": magnitude, "sound_speed": magnitude}, {"active": draw_flag}),
    "Layer": (bp.Layer, {"fluid": fluid, "thickness": magnitude}, {}),
    "Membrane": (bp.Membrane, {"areal_density": lambda r: cplx(r, 1)}, {"active": draw_flag}),
    "Cell": (bp.Cell, {"layers": lambda r: [bp.Layer(bp.AIR, 0.1)] * int(r.integers(0, 3))}, {}),
    "Slab": (bp.Slab, {"cell": lambda r: bp.lmmd_cell()}, {"periods": lambda r: 3, "before": fluid, "after": fluid}),
    "Slab.stack": (bp.Slab.stack, {"segments": lambda r: [(bp.lmmd_cell(), 2)]}, {"before": fluid, "after": fluid}),
    "Slab.uniform": (bp.Slab.uniform, {"fluid": fluid, "thickness": magnitude}, {"before": fluid}),
    "lmmd_cell": (
        bp.lmmd_cell,
        {},
        {
            "rho_m": lambda r: cplx(r, 1),
            "delta_rho": magnitude,
            "n_layers": lambda r: 6,
            "eta": magnitude,
            "design_frequency": magnitude,
            "background": fluid,
        },
    ),
    "standard_emt": (bp.standard_emt, {"cell": lambda r: draw_slab(r).segments[0][0]}, {}),
    "lmmd_emt": (bp.lmmd_emt, {"cell": lambda r: draw_slab(r).segments[0][0]}, {}),
    "lmmd_emt_slab": (bp.lmmd_emt_slab, {"slab": draw_slab}, {"interface": draw_flag}),
    "GaussianBeam": (
        bp.GaussianBeam,
        {"fwhm": magnitude},
        {"angle": real, "x0": real, "z0": real, "width_of": lambda r: "intensity", "form": lambda r: "rotated"},
    ),
    "Profile": (
        bp.Profile,
        {"x": lambda r: [0.0, 0.1, 0.2], "p": lambda r: [magnitude(r), 2j, 3]},
        {"z0": lambda r: -magnitude(r), "angle": real},
    ),
    "Profile.from_data": (
        bp.Profile.from_data,
        {"profile": lambda r: draw_field(r).p[0]},
        {"z0": lambda r: -magnitude(r)},
    ),
    "Profile.from_file": (bp.Profile.from_file, {"path": draw_text_file}, {"conjugate": draw_flag}),
    "Slits": (
        bp.Slits,
        {"width": magnitude, "separation": magnitude},
        {"count": lambda r: int(r.integers(1, 9)), "z0": real},
    ),
    "Solid": (
        bp.Solid,
        {"density": magnitude, "longitudinal_speed": magnitude, "shear_speed": magnitude},
        {"active": draw_flag},
    ),
    "rayleigh_angle": (
        bp.rayleigh_angle,
        {"fluid": fluid, "solid": lambda r: bp.Solid(magnitude(r), 5900.0, pick(r, (3200.0, 1100.0, 4200.0)))},
        {},
    ),
    "Piston": (bp.Piston, {"radius": magnitude}, {"baffle": lambda r: "soft", "z0": real}),
    "Bowl": (bp.Bowl, {"radius_of_curvature": magnitude, "aperture": magnitude}, {"pressure": real, "z0": real}),
    "SourcePlane": (
        bp.SourcePlane,
        {"x": lambda r: [0.0, 0.1, 0.2], "y": lambda r: [0.0, 0.1], "p": lambda r: r.normal(size=(2, 3))},
        {"z0": lambda r: -magnitude(r)},
    ),
    "Array": (
        bp.Array,
        {"positions": lambda r: r.normal(size=(3, 2)), "element": lambda r: bp.Piston(0.01)},
        {"weights": lambda r: [1, 2j, 3], "angle": real},
    ),
    "SourceSum": (
        bp.SourceSum,
        {
            "sources": lambda r: (bp.Piston(0.01), bp.GaussianBeam(magnitude(r))),
            "weights": lambda r: (1, r.normal() * 1j),
        },
        {},
    ),
    "scattering": (bp.scattering, {"slab": draw_slab, "frequency": FREQUENCY, "kx_over_k0": draw_axis(-3, 3)}, {}),
    "scattering, angle": (bp.scattering, {"slab": draw_slab, "frequency": FREQUENCY, "angle": ANGLE}, {}),
    "bloch": (
        bp.bloch,
        {"cell": lambda r: draw_slab(r).segments[0][0], "frequency": FREQUENCY, "kx": draw_axis(-100, 100)},
        {"background": fluid},
    ),
    "field": (
        bp.field,
        {"slab": draw_slab, "beam": draw_beam, "frequency": FEW, "x": X, "z": Z},
        {"angle": ANGLE, "rtol": lambda r: 1e-6, "variables": draw_variables},
    ),
    "field, periodic": (
        bp.field,
        {
            "slab": draw_slab,
            "beam": draw_beam,
            "frequency": lambda r: 2500.0,
            "x": X,
            "z": Z,
            "boundary": lambda r: "periodic",
        },
        {"period": magnitude, "variables": draw_variables},
    ),
    "beam_width": (
        bp.beam_width,
        {"slab": draw_slab, "beam": draw_beam, "frequency": FEW},
        {"angle": ONE_OR_TWO, "rtol": lambda r: 1e-5, "air_distance": magnitude},
    ),
    "beam_measures": (
        bp.beam_measures,
        {"slab": draw_slab, "beam": draw_beam, "frequency": lambda r: 2500.0},
        {"angle": ONE_OR_TWO, "rtol": lambda r: 1e-4},
    ),
    "guided_modes": (
        bp.guided_modes,
        {"slab": draw_slab, "frequency": lambda r: 2500.0},
        {"kx_over_k0_max": magnitude, "strip_over_k0": magnitude},
    ),
    "fwhm": (bp.fwhm, {"profile": lambda r: draw_field(r).p}, {"dim": lambda r: "x", "width_of": lambda r: "pressure"}),
    "compare": (bp.compare, {"a": draw_field, "b": draw_field}, {"rescale": draw_flag}),
    "save": (
        bp.save,
        {"ds": draw_answer, "path": draw_text_file},
        {"split_complex": draw_flag, "compression": lambda r: 3, "digits": lambda r: 4},
    ),
    "export": (
        bp.export,
        {"ds": draw_answer, "path": lambda r: draw_text_file(r).with_suffix(pick(r, (".mat", ".vti", ".vtr", ".csv")))},
        {},
    ),
    "load": (bp.load, {"path": draw_text_file}, {}),
    "save_field": (
        bp.save_field,
        {"path": draw_text_file, "slab": draw_slab, "beam": draw_beam, "frequency": lambda r: 2500.0, "x": X, "z": Z},
        {"memory": magnitude, "variables": draw_variables},
    ),
    "provenance": (bp.provenance, {"ds": draw_answer}, {}),
    "to_grid": (bp.to_grid, {"ds": draw_nodes, "x": lambda r: [0.0, 0.1], "z": lambda r: [0.0, 0.1]}, {}),
    "read_comsol": (
        bp.read_comsol,
        {"path": draw_text_file},
        {"x": lambda r: "x", "expression": lambda r: "p", "conjugate": draw_flag},
    ),
    "faces": (bp.faces, {"slab": draw_slab}, {"planes": lambda r: 50, "before": magnitude, "after": magnitude}),
    "plot.field": (
        bp.plot.field,
        {"ds": draw_answer},
        {
            "quantity": lambda r: pick(r, bp.plot.QUANTITIES),
            "colorbar": draw_flag,
            "limit": magnitude,
            "half_level": draw_flag,
        },
    ),
    "plot.cut": (
        bp.plot.cut,
        {"ds": draw_answer},
        {"z": lambda r: 0.0, "quantity": lambda r: pick(r, bp.plot.QUANTITIES)},
    ),
    "plot.animate": (
        bp.plot.animate,
        {"ds": draw_answer, "path": lambda r: draw_text_file(r).with_suffix(".gif")},
        {"frames": lambda r: 2, "limit": magnitude},
    ),
    "plot.scattering": (
        bp.plot.scattering,
        {"ds": draw_answer},
        {"quantity": lambda r: "absorption", "log": draw_flag, "label": lambda r: "a"},
    ),
    "plot.bloch": (bp.plot.bloch, {"ds": draw_answer}, {"imaginary": draw_flag, "mirror": draw_flag}),
    "plot.width": (bp.plot.width, {"ds": draw_answer}, {"label": lambda r: "a", "along": lambda r: "angle"}),
    "plot.modes": (bp.plot.modes, {"ds": draw_answer}, {"label": lambda r: "a"}),
    "plot.sweep": (
        bp.plot.sweep,
        {"ds": draw_answer},
        {"log": draw_flag, "along": lambda r: "x", "band": lambda r: "frequency", "percentiles": lambda r: (10, 90)},
    ),
    "plot.comparison": (bp.plot.comparison, {"cmp_ds": draw_answer}, {}),
    "fem.plan": (
        bp.fem.plan,
        {"slab": draw_slab, "beam": draw_beam, "frequency": lambda r: 2500.0, "period": lambda r: 1.37},
        {"order": lambda r: 2, "elements_x": lambda r: 9, "layer_rows": lambda r: 1},
    ),
    "fem.field": (
        bp.fem.field,
        {
            "slab": draw_slab,
            "beam": draw_beam,
            "frequency": lambda r: 1500.0,
            "x": lambda r: [0.0, 0.1],
            "z": lambda r: [0.0, 0.1],
            "period": lambda r: 1.37,
        },
        {"order": lambda r: 1, "elements_x": lambda r: 9, "memory_limit": lambda r: 1e8},
    ),
    "sweep": (
        bp.sweep,
        {"question": lambda r: spectrum, "axes": draw_axes},
        {"progress": lambda r: False, "workers": lambda r: 1},
    ),
    **MEDIA_CALLS,
}


def call(number: int) -> list[Case]:
    """One public function with random arguments, some of them bad."""
    rng = np.random.default_rng([SEED, 1, number])
    name = pick(rng, list(CALLS))
    function, needed, optional = CALLS[name]
    share = pick(rng, (0.0, 0.0, 0.15, 0.4))
    makers = needed | {n: m for n, m in optional.items() if rng.random() < 0.3}

    def ask() -> Any:
        try:
            arguments = {n: bad(rng) if rng.random() < share else m(rng) for n, m in makers.items()}
        except ValueError as error:  # of what an argument is made of: counted among the media
            return error
        return function(**arguments)

    return [(name, ask)]


CASES: dict[str, Callable[[int], list[Case]]] = {"media": medium, "calls": call}
