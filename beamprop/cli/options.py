"""Options of the command, and the objects that they describe. The paper's parameters are the defaults."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from ..media.structures import Slab


class Number(click.ParamType):
    """A complex number as Python writes it: 0.05+0.05j."""

    name = "complex"

    def convert(self, value: Any, param: Any, ctx: Any) -> complex:
        try:
            return complex(str(value).replace(" ", "").replace("i", "j"))
        except ValueError:
            self.fail(f"expected a number such as 0.05 or 0.05+0.05j, got {value!r}", param, ctx)


class Axis(click.ParamType):
    """A number, numbers with commas between, or start:stop:count."""

    name = "axis"

    def convert(self, value: Any, param: Any, ctx: Any) -> Any:
        if not isinstance(value, str):
            return value
        from .. import memory

        try:
            if ":" not in value:
                numbers = [float(v) for v in value.split(",")]
                return numbers[0] if len(numbers) == 1 else numbers
            start, stop, count = (kind(v) for kind, v in zip((float, float, int), value.split(":"), strict=True))
            if count < 1:
                raise ValueError
        except ValueError:
            self.fail(f"expected a number, a,b,c or start:stop:count, got {value!r}", param, ctx)
        try:
            memory.check(f"count of {value!r}", 80.0 * count, "an axis", "ask for fewer points")
        except ValueError as error:
            self.fail(str(error), param, ctx)
        return spaced(start, stop, count)


def spaced(start: float, stop: float, count: int) -> list[float]:
    """Evenly spaced numbers, both ends exact."""
    step = (stop - start) / max(1, count - 1)
    return [start + i * step for i in range(count - 1)] + [stop if count > 1 else start]


class Target(click.ParamType):
    """A file to write, with one of some endings, in a folder that exists and can be written to."""

    name = "file"

    def __init__(self, *endings: str) -> None:
        self.endings = endings

    def convert(self, value: Any, param: Any, ctx: Any) -> Path:
        path = Path(value)
        if path.suffix.lower() not in self.endings:
            self.fail(f"expected a name ending in {' or '.join(self.endings)}, got {str(value)!r}", param, ctx)
        from ..io.storage import check_target

        try:
            return check_target(path)
        except ValueError as error:
            self.fail(str(error).removeprefix("path: "), param, ctx)


Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]


def all_of(*options: Decorator) -> Decorator:
    """Several options as one decorator."""

    def decorate(function: Callable[..., Any]) -> Callable[..., Any]:
        for one in reversed(options):
            function = one(function)
        return function

    return decorate


def option(*names: str, default: Any, kind: Any = None, text: str, show: bool | str = True) -> Decorator:
    """An option with its default shown."""
    return click.option(*names, default=default, type=kind, show_default=show, help=text)


CELL = all_of(
    option("--rho-m", default="0.05+0.05j", kind=Number(), text="Mean relative density."),
    option("--delta-rho", default=0.025, text="Modulation of the loss."),
    click.option("--lossless", is_flag=True, help="Drop the losses: Im(rho-m) and delta-rho."),
    option("--n-layers", default=10, text="Layers in a period."),
    option("--eta", default=1 / 60, text="Period over the wavelength at the design frequency.", show="1/60"),
    option("--design-frequency", default=2500.0, text="[Hz]"),
    option("--density", default="1.25", kind=Number(), text="Of the background and both half-spaces [kg/m3]."),
    option("--sound-speed", default="343", kind=Number(), text="Of the background and both half-spaces [m/s]."),
)
SLAB = all_of(
    CELL,
    option("--periods", default=450, text="Periods of the slab."),
    option(
        "--medium",
        default="exact",
        kind=click.Choice(["exact", "lmmd-emt", "lmmd-emt-bare", "standard-emt", "none"]),
        text="The layers themselves, an effective medium (bare: without the interface term), or background only.",
    ),
    click.option("--after-density", type=Number(), help="Of the half-space behind, if it differs [kg/m3]."),
    click.option("--after-speed", type=Number(), help="Of the half-space behind, if it differs [m/s]."),
)
BEAM = all_of(
    option("--fwhm", default=0.096, text="Full width at half maximum at the launch plane [m]."),
    option(
        "--angle", default="0", kind=Axis(), text="From the normal [degree]; an axis: a, a,b,c or start:stop:count."
    ),
    option("--x0", default=0.0, text="Middle of the beam [m]."),
    option(
        "--width-of",
        default="pressure",
        kind=click.Choice(["pressure", "intensity"]),
        text="What fwhm is the width of.",
    ),
    option("--form", default="launch", kind=click.Choice(["launch", "rotated"]), text="Kind of oblique beam."),
    option("--rtol", default=1e-8, text="Asked relative error."),
)
OUTPUT_WITHOUT_PLOT = all_of(
    click.option("--output", "-o", type=Target(".nc", ".zarr"), help="Write the dataset to this .nc or .zarr."),
    click.option("--json", "as_json", is_flag=True, help="Print the dataset as JSON."),
    click.option("--quiet", "-q", is_flag=True, help="Print nothing but what was asked for by --json."),
)
OUTPUT = all_of(
    click.option("--plot", "-p", type=Target(".png", ".pdf"), help="Draw it into this .png or .pdf."),
    OUTPUT_WITHOUT_PLOT,
)


# --- from options to objects --------------------------------------------------------------------------------


def cell_of(o: dict[str, Any]) -> Any:
    """The cell and its background."""
    from ..media.fluids import Fluid
    from ..media.lmmd import lmmd_cell

    background = Fluid.from_speed(o["density"], o["sound_speed"])
    rho_m, delta_rho = o["rho_m"], o["delta_rho"]
    if o["lossless"]:
        rho_m, delta_rho = rho_m.real, 0.0
    return lmmd_cell(rho_m, delta_rho, o["n_layers"], o["eta"], o["design_frequency"], background), background


def slab_of(o: dict[str, Any]) -> Slab:
    """The slab, or an effective medium in its place."""
    from ..media.effective import lmmd_emt_slab, standard_emt
    from ..media.fluids import Fluid
    from ..media.structures import Slab

    cell, before = cell_of(o)
    after = before
    if o["after_density"] is not None or o["after_speed"] is not None:
        density = o["density"] if o["after_density"] is None else o["after_density"]
        speed = o["sound_speed"] if o["after_speed"] is None else o["after_speed"]
        after = Fluid.from_speed(density, speed)
    slab = Slab(cell, o["periods"], before, after)
    if o["medium"].startswith("lmmd"):
        return lmmd_emt_slab(slab, interface=o["medium"] == "lmmd-emt")
    if o["medium"] != "exact":
        fluid = standard_emt(cell) if o["medium"] == "standard-emt" else before
        return Slab.uniform(fluid, slab.thickness, before, after)
    return slab


def beam_of(o: dict[str, Any], z0: float = 0.0) -> Any:
    """The beam, launched at z0."""
    from ..sources.gaussian import GaussianBeam

    return GaussianBeam(o["fwhm"], 0.0, o["x0"], z0, o["width_of"], o["form"])
