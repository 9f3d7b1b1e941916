"""What is asked where nothing is said: frequencies about that of the design, and lengths by its wavelength.

The paper's own numbers, 2500 Hz in air, are where every default begins; at another wavelength, all lengths go with it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from .media import CELL, of_layers
from .values import Axis, frequency, number, spaced

if TYPE_CHECKING:
    import numpy as np

    from ..media.fluids import Fluid
    from ..media.structures import Slab

#: Wavelength of the paper's design [m].
PAPER = 343.0 / 2500.0
#: From this factor between the frequency of a question and that of the paper's design on, the latter was probably not meant.
FAR = 10.0


class Design(NamedTuple):
    """The frequency [Hz] that defaults are taken about, and their wavelength in front of the slab [m]."""

    frequency: float
    wavelength: float
    layered: bool = False  #: whether the layers are the user's own

    @property
    def scale(self) -> float:
        """The wavelength over that of the paper."""
        return self.wavelength / PAPER

    @property
    def band(self) -> np.ndarray:
        """Frequencies about the design's [Hz]."""
        return spaced(0.8 * self.frequency, 1.2 * self.frequency, 101)

    @property
    def launch(self) -> float:
        """A launch plane in front of the slab, for pictures [m]."""
        return -0.1 * self.scale

    @property
    def x(self) -> np.ndarray:
        """Lateral positions about the beam [m]."""
        return spaced(-0.7 * self.scale, 0.7 * self.scale, 561)

    def z(self, launch: float, slab: Slab) -> np.ndarray:
        """Depths from the launch plane [m] to behind a slab: a quarter of it, and of a few layers two wavelengths.

        Even, and on faces of the cells where they are finer than such planes resolve.
        """
        from ..media.planes import even_on_faces

        behind = max(0.25 * slab.thickness, 2 * self.wavelength if self.layered else 0.0)
        end = slab.thickness + behind if self.layered else 1.25 * slab.thickness
        return even_on_faces(slab, spaced(launch, end, 561))


def design(table: Mapping[str, Any], before: Fluid, requested: Axis | None = None) -> Design:
    """The design of a slab that is described by a table with the names of `media.SLAB`.

    Parameters
    ----------
    table : mapping of str to plain values
    before : Fluid
        In front of the slab.
    requested : float or array, Hz, optional
        The frequencies of the question. The paper's cell has a frequency of its own; of other layers, the middle of these is taken.

    Raises
    ------
    ValueError
        Layers of the user's own, and no frequency.

    Examples
    --------
    >>> design({}, bp.AIR).wavelength
    0.1372
    """
    layered = of_layers(table)
    if not layered:
        middle = frequency(table.get("design_frequency", CELL["design_frequency"].default), "design_frequency")
    elif requested is None:
        raise ValueError("frequency: expected a frequency [Hz] for these layers, got none")
    else:
        middle = requested if isinstance(requested, float) else float(requested.min() + requested.max()) / 2
    if not layered and requested is not None and "design_frequency" not in table:
        _hint(middle, requested)
    return Design(middle, _wavelength(table, before, middle), layered)


def _hint(middle: float, requested: Axis) -> None:
    """Warn where every frequency is far from that of a design which nobody chose."""
    import warnings

    from ..media.hints import HintWarning

    first, least, most = (
        (requested,) * 3 if isinstance(requested, float) else (requested[0], requested.min(), requested.max())
    )
    if least > FAR * middle or most < middle / FAR:
        said = f"design_frequency: the cell is the paper's, designed for {middle:g} Hz; give one near {first:g} Hz to scale it"
        warnings.warn(said, HintWarning, stacklevel=3)


def _wavelength(table: Mapping[str, Any], before: Fluid, at: float) -> float:
    """Wavelength in front [m]; the paper's for a fluid that carries no waves, which the question refuses by itself."""
    if before.dispersive or "background" in table:
        k = complex(before.wavenumber(max(at, 1e-30))).real
        wavelength = 2 * math.pi / k if k > 0 else PAPER
    else:
        speed = number(table.get("sound_speed", CELL["sound_speed"].default), "sound_speed").real
        wavelength = speed / at if at > 0 else PAPER
    return wavelength if math.isfinite(wavelength) and wavelength > 0 else PAPER
