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


def pick(rng: Rng, options: Any) -> Any:
    return options[int(rng.integers(len(options)))]


# --- media ------------------------------------------------------------------------------------------------


def magnitude(rng: Rng) -> float:
    """A positive number: mostly an ordinary one, sometimes anything that a double can be."""
    decades = ((-2, 2), (-6, 6), (-50, 50), (-323, 308))[int(rng.choice(4, p=(0.6, 0.25, 0.12, 0.03)))]
    return float(10.0 ** rng.uniform(*decades))


def real(rng: Rng) -> float:
    """A number of either sign, sometimes a special one."""
    special = (0.0, -0.0, np.inf, -np.inf, np.nan, 1.0)
    return pick(rng, special) if rng.random() < 0.015 else magnitude(rng) * pick(rng, (1, 1, 1, -1))


def cplx(rng: Rng, loss: int) -> complex:
    """A number with no loss, some, or much, of the sign that a passive medium has; sometimes of the other."""
    size = real(rng)
    share = pick(rng, (0.0, 0.0, 1e-12, 1e-3, 0.3, 10.0)) * (loss if rng.random() < 0.99 else -loss)
    with np.errstate(all="ignore"):
        return complex(size, np.float64(abs(size)) * share)


def fluid(rng: Rng) -> bp.Fluid:
    """A fluid, perhaps anisotropic or active, in units of air or of one."""
    rho, K = (1.25, 147_000.0) if rng.random() < 0.7 else (1.0, 1.0)
    x = None if rng.random() < 0.7 else pick(rng, (cplx(rng, 1) * rho, np.inf, cplx(rng, 1)))
    return bp.Fluid(cplx(rng, 1) * rho, cplx(rng, -1) * K, x, active=bool(rng.random() < 0.2))


def slab(rng: Rng) -> bp.Slab:
    """A slab of a few layers and membranes, of few or very many periods, in air or elsewhere."""
    pieces: list[Any] = [
        bp.Membrane(cplx(rng, 1))
        if rng.random() < 0.1
        else bp.Layer(fluid(rng), magnitude(rng) * pick(rng, (1e-3, 0.1)))
        for _ in range(int(rng.integers(1, 5)))
    ]
    sides = [bp.AIR if rng.random() < 0.85 else fluid(rng) for _ in range(2)]
    stack = bp.Slab(bp.Cell(pieces), int(10.0 ** pick(rng, (0, 0, rng.uniform(0, 3), rng.uniform(0, 15)))), *sides)
    return stack if rng.random() < 0.8 else stack + bp.Slab.uniform(fluid(rng), magnitude(rng))


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
    return pick(rng, numbers + kinds + scalars + arrays)


def draw_axis(low: float, high: float, most: int = 40) -> Callable[[Rng], Any]:
    """A number or a short axis of `most` numbers at most, increasing or not, within a range."""

    def make(rng: Rng) -> Any:
        count = min(most, int(pick(rng, (1, 1, 2, 7, 40))))
        values = np.sort(rng.uniform(low, high, count)) if rng.random() < 0.7 else np.linspace(low, high, count)
        return float(values[0]) if count == 1 else pick(rng, (values, values.tolist(), values[::-1]))

    return make


def draw_slab(rng: Rng) -> bp.Slab:
    lossy, lossless = bp.lmmd_cell(), bp.lmmd_cell(rho_m=0.05, delta_rho=0.0)
    options = (
        lambda: bp.Slab(lossy, int(pick(rng, (1, 20, 450)))),
        lambda: bp.Slab(lossless, 20),
        lambda: bp.Slab.uniform(bp.AIR, magnitude(rng)),
        lambda: bp.Slab.uniform(bp.Fluid.from_speed(1000.0, 1480.0), 0.1) + bp.Slab(lossy, 3),
        lambda: bp.lmmd_emt_slab(bp.Slab(lossy, 20)),
        lambda: slab(rng),
    )
    return pick(rng, options)()


def draw_beam(rng: Rng) -> Any:
    x = np.linspace(-0.3, 0.3, 61)
    z0 = pick(rng, (0.0, -0.1, -0.1, -1.0, -magnitude(rng)))
    options = (
        lambda: bp.GaussianBeam(pick(rng, (0.096, 1.0, magnitude(rng))), angle=rng.uniform(-60, 60), z0=z0),
        lambda: bp.GaussianBeam(
            0.3, angle=rng.uniform(-60, 60), x0=pick(rng, (rng.uniform(-3, 3), -magnitude(rng), magnitude(rng))), z0=z0
        ),
        lambda: bp.GaussianBeam(0.3, angle=rng.uniform(-60, 60), z0=z0, form="rotated", width_of="intensity"),
        lambda: bp.Profile(x, np.exp(-((x / 0.1) ** 2)), z0=z0),
        lambda: bp.Profile(np.sort(rng.normal(size=9)), rng.normal(size=9) + 1j, z0=z0),
        lambda: bp.Slits(0.05, 0.2, int(pick(rng, (1, 2, 30))), z0=z0),
    )
    return pick(rng, options)()


def draw_field(rng: Rng) -> xr.Dataset:
    x, z = np.linspace(-1, 1, int(rng.integers(4, 60))), np.linspace(0, 0.4, int(rng.integers(1, 6)))
    p = rng.normal(size=(z.size, x.size)) + 1j * rng.normal(size=(z.size, x.size))
    p *= pick(rng, (0.0, 1.0, magnitude(rng)))
    if rng.random() < 0.2:
        p[0, 0] = np.nan
    return xr.Dataset({"p": (("z", "x"), p, {"units": "Pa"})}, {"x": x, "z": z})


def draw_answer(rng: Rng) -> xr.Dataset:
    slab = bp.Slab(bp.lmmd_cell(), 5)
    beam = bp.GaussianBeam(0.2)
    options = (
        lambda: bp.scattering(slab, [2400.0, 2500.0], kx_over_k0=[0.0, 0.5, 2.0]),
        lambda: bp.bloch(slab.cell, 2500.0, kx_over_k0=[-1.0, 0.0, 1.0]),
        lambda: bp.field(slab, beam, 2500.0, np.linspace(-1, 1, 9), [0.0, 0.1]),
        lambda: bp.beam_width(slab, beam, [2400.0, 2500.0]),
        lambda: bp.compare(draw_field(np.random.default_rng(1)), draw_field(np.random.default_rng(1))),
        lambda: draw_field(rng),
    )
    return pick(rng, options)()


def draw_nodes(rng: Rng) -> xr.Dataset:
    count = int(pick(rng, (0, 2, 3, 30)))
    return xr.Dataset({"p": ("node", rng.normal(size=count) + 0j)}, {n: ("node", rng.normal(size=count)) for n in "xz"})


def draw_text_file(rng: Rng) -> Path:
    """A file of numbers, of nonsense, or none."""
    folder = Path(tempfile.mkdtemp(prefix="fuzz."))
    path = folder / pick(rng, ("a.txt", "a.nc", "a.zarr", "a"))
    text = pick(
        rng, ("", "0 1\n1 2\n2 3\n", "0,1\n0,1\n", "% x y p @ freq=1\n0 0 1\n", "1e400 1\n2 2\n", "\0\xff", "x\n")
    )
    if rng.random() < 0.9:
        path.write_text(text, encoding="utf-8")
    return path


def draw_flag(rng: Rng) -> bool:
    return bool(rng.random() < 0.5)
