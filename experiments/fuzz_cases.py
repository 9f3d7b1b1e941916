"""Random media and random calls, good and bad: each is made from its number alone, so that it can be asked again."""

from __future__ import annotations

import decimal
import fractions
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

import beamprop as bp

SEED = 2500
#: A question to ask, and the name under which it is counted.
Case = tuple[str, Callable[[], Any]]
Rng = np.random.Generator


def _pick(rng: Rng, options: Any) -> Any:
    return options[int(rng.integers(len(options)))]


# --- media ------------------------------------------------------------------------------------------------


def magnitude(rng: Rng) -> float:
    """A positive number: mostly an ordinary one, sometimes anything that a double can be."""
    decades = ((-2, 2), (-6, 6), (-50, 50), (-323, 308))[int(rng.choice(4, p=(0.6, 0.25, 0.12, 0.03)))]
    return float(10.0 ** rng.uniform(*decades))


def real(rng: Rng) -> float:
    """A number of either sign, sometimes a special one."""
    special = (0.0, -0.0, np.inf, -np.inf, np.nan, 1.0)
    return _pick(rng, special) if rng.random() < 0.015 else magnitude(rng) * _pick(rng, (1, 1, 1, -1))


def cplx(rng: Rng, loss: int) -> complex:
    """A number with no loss, some, or much, of the sign that a passive medium has; sometimes of the other."""
    size = real(rng)
    share = _pick(rng, (0.0, 0.0, 1e-12, 1e-3, 0.3, 10.0)) * (loss if rng.random() < 0.99 else -loss)
    with np.errstate(all="ignore"):
        return complex(size, np.float64(abs(size)) * share)


def fluid(rng: Rng) -> bp.Fluid:
    """A fluid, perhaps anisotropic or active, in units of air or of one."""
    rho, K = (1.25, 147_000.0) if rng.random() < 0.7 else (1.0, 1.0)
    x = None if rng.random() < 0.7 else _pick(rng, (cplx(rng, 1) * rho, np.inf, cplx(rng, 1)))
    return bp.Fluid(cplx(rng, 1) * rho, cplx(rng, -1) * K, x, active=bool(rng.random() < 0.2))


def slab(rng: Rng) -> bp.Slab:
    """A slab of a few layers and membranes, of few or very many periods, in air or elsewhere."""
    pieces: list[Any] = [
        bp.Membrane(cplx(rng, 1))
        if rng.random() < 0.1
        else bp.Layer(fluid(rng), magnitude(rng) * _pick(rng, (1e-3, 0.1)))
        for _ in range(int(rng.integers(1, 5)))
    ]
    sides = [bp.AIR if rng.random() < 0.85 else fluid(rng) for _ in range(2)]
    one = bp.Slab(bp.Cell(pieces), int(10.0 ** _pick(rng, (0, 0, rng.uniform(0, 3), rng.uniform(0, 15)))), *sides)
    return one if rng.random() < 0.8 else one + bp.Slab.uniform(fluid(rng), magnitude(rng))


def medium(number: int) -> list[Case]:
    """A random slab made, and plane waves and Bloch waves asked of it."""
    rng = np.random.default_rng([SEED, 0, number])
    made: list[bp.Slab] = []

    def make() -> bp.Slab:
        made.append(slab(rng))
        return made[0]

    frequency = 2500.0 if rng.random() < 0.5 else magnitude(rng)
    kx = [0.0, 1.0, 46.0, *(abs(real(rng)) for _ in range(2))]
    shifted = np.array(kx[:4]) - 1j * magnitude(rng)
    return [
        ("media made", make),
        ("scattering", lambda: bp.scattering(made[0], frequency, kx=kx)),
        ("scattering, complex kx", lambda: bp.scattering(made[0], frequency, kx=shifted)),
        ("scattering, angles", lambda: bp.scattering(made[0], frequency, angle=[0.0, 30.0, 89.9, 90.0])),
        ("bloch", lambda: bp.bloch(made[0].segments[0][0], frequency, kx=kx)),
    ]


# --- calls ------------------------------------------------------------------------------------------------


class Odd:
    """An object that is nothing of what is expected, and cannot even be shown."""

    def __repr__(self) -> str:
        raise RuntimeError("cannot be shown")


def bad(rng: Rng) -> Any:
    """A value of any type, mostly wrong wherever it is given."""
    numbers: list[Any] = [0, -1, 1e155, 5e-324, 1e-300, -1e300, np.nan, np.inf, 10**400, 10**5000, 1 + 2j, 2**63, 0.5]
    kinds: list[Any] = [
        None,
        True,
        np.True_,
        "text",
        b"x",
        "",
        "\0",
        {},
        {1.0},
        [],
        (),
        [[1.0]],
        object,
        abs,
        Odd(),
        bp.AIR,
    ]
    scalars: list[Any] = [
        np.complex64(2j),
        np.int8(3),
        np.float16(0.1),
        np.datetime64("2024"),
        fractions.Fraction(1, 3),
    ]
    arrays: list[Any] = [
        np.ma.masked,
        np.ma.array([1.0, 2.0], mask=[0, 1]),
        np.array([]),
        np.zeros((2, 2)),
        np.array(["a"]),
        np.array([1, None], object),
        np.arange(3.0) * np.nan,
        np.array([True, False]),
        np.broadcast_to(1.0, 10**12),
        np.arange(5)[::-1],
        [1.0, "a"],
        [10**400],
        [0.0, 0.0],
        decimal.Decimal("1.5"),
        xr.DataArray([1.0, 2.0]),
        xr.Dataset(),
        lambda f: "nothing",
        lambda f: f * np.nan,
        lambda: 1,
        np.longdouble("1e4000"),
        bp.GaussianBeam,
    ]
    return _pick(rng, numbers + kinds + scalars + arrays)


def _axis(low: float, high: float, most: int = 40) -> Callable[[Rng], Any]:
    """A number or a short axis of `most` numbers at most, increasing or not, within a range."""

    def make(rng: Rng) -> Any:
        count = min(most, int(_pick(rng, (1, 1, 2, 7, 40))))
        values = np.sort(rng.uniform(low, high, count)) if rng.random() < 0.7 else np.linspace(low, high, count)
        return float(values[0]) if count == 1 else _pick(rng, (values, values.tolist(), values[::-1]))

    return make


def _slab(rng: Rng) -> bp.Slab:
    lossy, lossless = bp.lmmd_cell(), bp.lmmd_cell(rho_m=0.05, delta_rho=0.0)
    options = (
        lambda: bp.Slab(lossy, int(_pick(rng, (1, 20, 450)))),
        lambda: bp.Slab(lossless, 20),
        lambda: bp.Slab.uniform(bp.AIR, magnitude(rng)),
        lambda: bp.Slab.uniform(bp.Fluid.from_speed(1000.0, 1480.0), 0.1) + bp.Slab(lossy, 3),
        lambda: bp.lmmd_emt_slab(bp.Slab(lossy, 20)),
        lambda: slab(rng),
    )
    return _pick(rng, options)()


def _beam(rng: Rng) -> Any:
    x = np.linspace(-0.3, 0.3, 61)
    z0 = _pick(rng, (0.0, -0.1, -0.1, -1.0, -magnitude(rng)))
    options = (
        lambda: bp.GaussianBeam(_pick(rng, (0.096, 1.0, magnitude(rng))), angle=rng.uniform(-60, 60), z0=z0),
        lambda: bp.GaussianBeam(
            0.3, angle=rng.uniform(-60, 60), x0=_pick(rng, (rng.uniform(-3, 3), -magnitude(rng), magnitude(rng))), z0=z0
        ),
        lambda: bp.GaussianBeam(0.3, angle=rng.uniform(-60, 60), z0=z0, form="rotated", width_of="intensity"),
        lambda: bp.Profile(x, np.exp(-((x / 0.1) ** 2)), z0=z0),
        lambda: bp.Profile(np.sort(rng.normal(size=9)), rng.normal(size=9) + 1j, z0=z0),
        lambda: bp.Slits(0.05, 0.2, int(_pick(rng, (1, 2, 30))), z0=z0),
    )
    return _pick(rng, options)()


def _field(rng: Rng) -> xr.Dataset:
    x, z = np.linspace(-1, 1, int(rng.integers(4, 60))), np.linspace(0, 0.4, int(rng.integers(1, 6)))
    p = rng.normal(size=(z.size, x.size)) + 1j * rng.normal(size=(z.size, x.size))
    p *= _pick(rng, (0.0, 1.0, magnitude(rng)))
    if rng.random() < 0.2:
        p[0, 0] = np.nan
    return xr.Dataset({"p": (("z", "x"), p, {"units": "Pa"})}, {"x": x, "z": z})


def _answer(rng: Rng) -> xr.Dataset:
    slab = bp.Slab(bp.lmmd_cell(), 5)
    beam = bp.GaussianBeam(0.2)
    options = (
        lambda: bp.scattering(slab, [2400.0, 2500.0], kx_over_k0=[0.0, 0.5, 2.0]),
        lambda: bp.bloch(slab.cell, 2500.0, kx_over_k0=[-1.0, 0.0, 1.0]),
        lambda: bp.field(slab, beam, 2500.0, np.linspace(-1, 1, 9), [0.0, 0.1]),
        lambda: bp.beam_width(slab, beam, [2400.0, 2500.0]),
        lambda: bp.compare(_field(np.random.default_rng(1)), _field(np.random.default_rng(1))),
        lambda: _field(rng),
    )
    return _pick(rng, options)()


def _nodes(rng: Rng) -> xr.Dataset:
    count = int(_pick(rng, (0, 2, 3, 30)))
    return xr.Dataset({"p": ("node", rng.normal(size=count) + 0j)}, {n: ("node", rng.normal(size=count)) for n in "xz"})


def _text(rng: Rng) -> Path:
    """A file of numbers, of nonsense, or none."""
    folder = Path(tempfile.mkdtemp(prefix="fuzz."))
    path = folder / _pick(rng, ("a.txt", "a.nc", "a.zarr", "a"))
    text = _pick(
        rng, ("", "0 1\n1 2\n2 3\n", "0,1\n0,1\n", "% x y p @ freq=1\n0 0 1\n", "1e400 1\n2 2\n", "\0\xff", "x\n")
    )
    if rng.random() < 0.9:
        path.write_text(text, encoding="utf-8")
    return path


def _flag(rng: Rng) -> bool:
    return bool(rng.random() < 0.5)


FREQUENCY, X, Z, ANGLE = _axis(500, 5000), _axis(-2, 2), _axis(0, 1), _axis(-80, 80)
#: Of questions that take longer.
FEW, ONE_OR_TWO = _axis(1000, 3000, 3), _axis(-60, 60, 2)
#: Every public function, and what makes its arguments; those in the second table may be left out.
CALLS: dict[str, tuple[Callable[..., Any], dict[str, Any], dict[str, Any]]] = {
    "Fluid": (bp.Fluid, {"density": lambda r: cplx(r, 1), "bulk_modulus": lambda r: cplx(r, -1)}, {"density_x": real, "active": _flag}),
    "Fluid.from_speed": (bp.Fluid.from_speed, {"density": magnitude, "sound_speed": magnitude}, {"active": _flag}),
    "Layer": (bp.Layer, {"fluid": fluid, "thickness": magnitude}, {}),
    "Membrane": (bp.Membrane, {"areal_density": lambda r: cplx(r, 1)}, {"active": _flag}),
    "Cell": (bp.Cell, {"layers": lambda r: [bp.Layer(bp.AIR, 0.1)] * int(r.integers(0, 3))}, {}),
    "Slab": (bp.Slab, {"cell": lambda r: bp.lmmd_cell()}, {"periods": lambda r: 3, "before": fluid, "after": fluid}),
    "Slab.stack": (bp.Slab.stack, {"segments": lambda r: [(bp.lmmd_cell(), 2)]}, {"before": fluid, "after": fluid}),
    "Slab.uniform": (bp.Slab.uniform, {"fluid": fluid, "thickness": magnitude}, {"before": fluid}),
    "lmmd_cell": (
        bp.lmmd_cell,
        {},
        {"rho_m": lambda r: cplx(r, 1), "delta_rho": magnitude, "n_layers": lambda r: 6, "eta": magnitude, "design_frequency": magnitude, "background": fluid},
    ),
    "standard_emt": (bp.standard_emt, {"cell": lambda r: _slab(r).segments[0][0]}, {}),
    "lmmd_emt": (bp.lmmd_emt, {"cell": lambda r: _slab(r).segments[0][0]}, {}),
    "lmmd_emt_slab": (bp.lmmd_emt_slab, {"slab": _slab}, {"interface": _flag}),
    "GaussianBeam": (bp.GaussianBeam, {"fwhm": magnitude}, {"angle": real, "x0": real, "z0": real, "width_of": lambda r: "intensity", "form": lambda r: "rotated"}),
    "Profile": (bp.Profile, {"x": lambda r: [0.0, 0.1, 0.2], "p": lambda r: [magnitude(r), 2j, 3]}, {"z0": lambda r: -magnitude(r), "angle": real}),
    "Profile.from_data": (bp.Profile.from_data, {"profile": lambda r: _field(r).p[0]}, {"z0": lambda r: -magnitude(r)}),
    "Profile.from_file": (bp.Profile.from_file, {"path": _text}, {"conjugate": _flag}),
    "Slits": (bp.Slits, {"width": magnitude, "separation": magnitude}, {"count": lambda r: int(r.integers(1, 9)), "z0": real}),
    "scattering": (bp.scattering, {"slab": _slab, "frequency": FREQUENCY, "kx_over_k0": _axis(-3, 3)}, {}),
    "scattering, angle": (bp.scattering, {"slab": _slab, "frequency": FREQUENCY, "angle": ANGLE}, {}),
    "bloch": (bp.bloch, {"cell": lambda r: _slab(r).segments[0][0], "frequency": FREQUENCY, "kx": _axis(-100, 100)}, {"background": fluid}),
    "field": (bp.field, {"slab": _slab, "beam": _beam, "frequency": FEW, "x": X, "z": Z}, {"angle": ANGLE, "rtol": lambda r: 1e-6}),
    "field, periodic": (bp.field, {"slab": _slab, "beam": _beam, "frequency": lambda r: 2500.0, "x": X, "z": Z, "boundary": lambda r: "periodic"}, {"period": magnitude}),
    "beam_width": (bp.beam_width, {"slab": _slab, "beam": _beam, "frequency": FEW}, {"angle": ONE_OR_TWO, "rtol": lambda r: 1e-5, "air_distance": magnitude}),
    "beam_measures": (bp.beam_measures, {"slab": _slab, "beam": _beam, "frequency": lambda r: 2500.0}, {"angle": ONE_OR_TWO, "rtol": lambda r: 1e-4}),
    "guided_modes": (bp.guided_modes, {"slab": _slab, "frequency": lambda r: 2500.0}, {"kx_over_k0_max": magnitude, "strip_over_k0": magnitude}),
    "fwhm": (bp.fwhm, {"profile": lambda r: _field(r).p}, {"dim": lambda r: "x", "width_of": lambda r: "pressure"}),
    "compare": (bp.compare, {"a": _field, "b": _field}, {"rescale": _flag}),
    "save": (bp.save, {"ds": _answer, "path": _text}, {"split_complex": _flag, "compression": lambda r: 3}),
    "load": (bp.load, {"path": _text}, {}),
    "save_field": (bp.save_field, {"path": _text, "slab": _slab, "beam": _beam, "frequency": lambda r: 2500.0, "x": X, "z": Z}, {"memory": magnitude}),
    "provenance": (bp.provenance, {"ds": _answer}, {}),
    "to_grid": (bp.to_grid, {"ds": _nodes, "x": lambda r: [0.0, 0.1], "z": lambda r: [0.0, 0.1]}, {}),
    "read_comsol": (bp.read_comsol, {"path": _text}, {"x": lambda r: "x", "expression": lambda r: "p", "conjugate": _flag}),
    "plot.field": (bp.plot.field, {"ds": _answer}, {"quantity": lambda r: "real", "colorbar": _flag, "limit": magnitude}),
    "plot.scattering": (bp.plot.scattering, {"ds": _answer}, {"quantity": lambda r: "absorption", "log": _flag, "label": lambda r: "a"}),
    "plot.bloch": (bp.plot.bloch, {"ds": _answer}, {"imaginary": _flag, "mirror": _flag}),
    "plot.width": (bp.plot.width, {"ds": _answer}, {"label": lambda r: "a"}),
    "plot.comparison": (bp.plot.comparison, {"cmp_ds": _answer}, {}),
    "fem.plan": (bp.fem.plan, {"slab": _slab, "beam": _beam, "frequency": lambda r: 2500.0, "period": lambda r: 1.37}, {"order": lambda r: 2, "elements_x": lambda r: 9, "layer_rows": lambda r: 1}),
    "fem.field": (bp.fem.field, {"slab": _slab, "beam": _beam, "frequency": lambda r: 1500.0, "x": lambda r: [0.0, 0.1], "z": lambda r: [0.0, 0.1], "period": lambda r: 1.37}, {"order": lambda r: 1, "elements_x": lambda r: 9, "memory_limit": lambda r: 1e8}),
}  # fmt: skip


def call(number: int) -> list[Case]:
    """One public function with random arguments, some of them bad."""
    rng = np.random.default_rng([SEED, 1, number])
    name = _pick(rng, list(CALLS))
    function, needed, optional = CALLS[name]
    share = _pick(rng, (0.0, 0.0, 0.15, 0.4))
    makers = needed | {n: m for n, m in optional.items() if rng.random() < 0.3}

    def ask() -> Any:
        try:
            arguments = {n: bad(rng) if rng.random() < share else m(rng) for n, m in makers.items()}
        except ValueError as error:  # of what an argument is made of: counted among the media
            return error
        return function(**arguments)

    return [(name, ask)]


CASES: dict[str, Callable[[int], list[Case]]] = {"media": medium, "calls": call}
