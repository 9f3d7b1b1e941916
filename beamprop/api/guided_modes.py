"""`guided_modes`: the modes that a slab guides."""

from __future__ import annotations

import itertools
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from .. import memory, validate
from ..io import datasets
from ..media.structures import Slab
from ..modes import argument_principle, guided
from ..modes.branches import branches
from ..response.sampled_slab import SampledSlab, sample
from . import checks, hints


def guided_modes(
    slab: Slab, frequency: Any, kx_over_k0_max: float = 10.0, strip_over_k0: float = 0.5, *, leaky: bool = False
) -> xr.Dataset:
    """The modes that a slab guides: zeros of its dispersion function, found without a guess.

    The argument principle counts them in the strip k_edge < Re kx < kx_over_k0_max k0, \\|Im kx\\| < strip_over_k0 k0, where
    k_edge is the larger wavenumber of the two half-spaces; boxes are halved until Newton's method finds each one. -kx is a
    mode too.

    A layer of density exactly 0 is a soft wall, p = 0, on both sides: the answer has the modes of the part in front, for which
    k_edge is that of ``slab.before``, of the part behind, with that of ``slab.after``, and of the parts between two such
    layers, which are closed: k_edge is k0/1000, since their modes may have any Re kx. The cells of a repeated one each have theirs.

    Parameters
    ----------
    slab : Slab
    frequency : float or 1-D array, Hz
    kx_over_k0_max, strip_over_k0 : float
        The strip, over the wavenumber of ``slab.before``.
    leaky : bool
        Also the modes that radiate into a half-space, from Re kx = k0/1000 on: zeros on the sheet that is reached from the
        real axis, forward ones above it, backward ones below. Plates of solids have mostly these.

    Returns
    -------
    Dataset
        On (frequency, mode), by growing Re kx: complex `kx` [rad/m] and `kx_over_k0`; `direction` +1 where energy flows along
        +Re kx (forward), -1 against it (backward, or a complex mode of a lossless slab that grows along +x); `residual`, the
        last step of Newton's method over kx; `error_estimate`, how far a mode moves, over kx, with the last bits of the
        layers (modes that are nearly one feel their square root). nan and 0 where a frequency has fewer modes than another;
        `count`, on (frequency), is how many the argument principle counts. Along an array of frequencies, `branch` numbers the
        dispersion curves: a mode continues the one that is nearest where its curve leads from the frequency before, and
        steps of frequency as fine as the curves bend keep them whole; -1 where there is no mode.

    Warns
    -----
    AccuracyWarning
        An estimated error is above 1e-6.

    Raises
    ------
    ValueError
        Wrong arguments, or modes that were counted and not found.

    Examples
    --------
    >>> ds = bp.guided_modes(bp.Slab(bp.lmmd_cell(0.05, 0), periods=20), 2500.0)
    >>> int(ds["count"]) == ds.sizes["mode"]
    True
    """
    validate.instance(slab, Slab, "slab")
    f = validate.axis(frequency, "frequency", positive=True)
    hints.warn_of_solids(slab, f)
    highest = validate.as_number(kx_over_k0_max, "kx_over_k0_max", positive=True)
    strip = validate.as_number(strip_over_k0, "strip_over_k0", positive=True)
    flat = np.atleast_1d(f)
    search = Search(highest, strip, validate.flag(leaky, "leaky"))
    answers = [_modes_at(slab, float(g), search) for g in flat]
    most = max(len(modes) for modes, _ in answers)
    kx = np.full((flat.size, most), complex(np.nan, np.nan))
    direction, (residual, error) = np.zeros(kx.shape, int), np.full((2, *kx.shape), np.nan)
    for i, (modes, _) in enumerate(answers):
        for j, mode in enumerate(modes):
            kx[i, j], direction[i, j], residual[i, j], error[i, j] = mode
    if most:
        checks.warn_of_plane_waves(np.nan_to_num(error, nan=0.0), flat, "mode", np.arange(most))
    k0 = slab.before.wavenumber(flat).real
    dims, pick = (("frequency",), ...) if f.ndim else ((), 0)
    both = (*dims, "mode")
    variables = {
        "kx": (both, kx[pick]),
        "kx_over_k0": (both, (kx / k0[:, None])[pick]),
        "direction": (both, direction[pick]),
        "residual": (both, residual[pick]),
        "error_estimate": (both, error[pick]),
        "count": (dims, np.array([total for _, total in answers])[pick]),
    }
    if f.ndim:
        variables["branch"] = both, branches(k0, kx)
    coords = checks.coords(frequency=f) | {"mode": (("mode",), np.arange(most))}
    return datasets.make(
        variables, coords, "guided_modes", flat, slab=slab, kx_over_k0_max=highest, strip_over_k0=strip, leaky=leaky
    )


class Search(NamedTuple):
    """Where modes are searched for, over k0, and whether leaky ones too."""

    highest: float
    strip: float
    leaky: bool


#: Modes of a part between two walls are searched for from this Re kx on, over k0: those that decay along x lie at Re kx = 0.
CLOSED = 1e-3


def _modes_at(slab: Slab, frequency: float, search: Search) -> tuple[list[guided.Mode], int]:
    """The modes of all parts of a slab at one frequency, by Re kx, and how many the argument principle counts."""
    modes, total = [], 0
    for part, times in sample(slab, frequency).parts_between_walls():
        own, count = _modes_of(part, frequency, search)
        memory.check("slab", 400.0 * (total + times * count), "the modes of all its parts", "take fewer periods")
        modes += times * own
        total += times * count
    return sorted(modes, key=lambda mode: mode.kx.real), total


def _modes_of(s: SampledSlab, frequency: float, search: Search) -> tuple[list[guided.Mode], int]:
    edge = s.last_branch * (1 + guided.BESIDE) if s.branch_points else CLOSED * s.k0
    if search.highest * s.k0 <= edge:
        raise ValueError(
            f"kx_over_k0_max: expected more than {edge / s.k0:.6g}, where guided modes begin, got {search.highest}"
        )
    spans = [(edge, search.highest * s.k0)]
    if search.leaky and s.branch_points:  # between branch points, whose cuts stand upright
        ends = sorted({CLOSED * s.k0, *(b for b in s.real_branches if b > CLOSED * s.k0)})
        inner = [(a * (1 + guided.BESIDE), b * (1 - guided.BESIDE)) for a, b in itertools.pairwise(ends)]
        spans = [span for span in inner if span[0] < span[1]] + spans
    modes: list[guided.Mode] = []
    total = 0
    for left, right in spans:
        own, count = _modes_in(
            s, frequency, argument_principle.Box(left, right, -search.strip * s.k0, search.strip * s.k0)
        )
        modes, total = modes + own, total + count
    return modes, total


def _modes_in(s: SampledSlab, frequency: float, box: argument_principle.Box) -> tuple[list[guided.Mode], int]:
    """The modes in a box."""
    most = memory.most_values()
    try:
        modes, total = guided.find_modes(s, box, most)
    except argument_principle.TooManyValues:
        raise ValueError(
            f"kx_over_k0_max: expected a strip that {most:.2g} values of the dispersion function search through, got "
            f"{box.right / s.k0:g} by {box.high / s.k0:g} k0; search a part of it, by kx_over_k0_max and strip_over_k0"
        ) from None
    except argument_principle.TooManyModes:
        raise ValueError(
            f"slab: two of its modes at {frequency} Hz are one to rounding, and run both ways; add loss"
        ) from None
    except argument_principle.UncertainCount as counts:
        raise ValueError(
            f"kx_over_k0_max: expected a strip in which modes can be counted, got {counts} modes at {frequency} Hz; "
            "one may lie on the edge of the strip: change it a little"
        ) from None
    if len(modes) != total:
        raise ValueError(
            f"kx_over_k0_max: {total} modes were counted at {frequency} Hz and {len(modes)} found; "
            "one may lie on the edge of the strip: change it a little"
        )
    return modes, total
