"""The positions and planes at which two contours are compared, dark planes among them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from ..response.transfer_function import TransferFunction
from ..sources.angles import AngleInterpolation
from ..sources.base import Beam
from . import near_normal
from .paths import BentPlan, Contour

if TYPE_CHECKING:
    from .search import Planned, Search

#: w S(k) and w S(-k) of each beam at the nodes of a contour: (B, n) each.
Amplitudes = tuple[np.ndarray, np.ndarray]


class Places(Protocol):
    """Positions on each plane at which two contours are compared: on a line along x, or on a grid in the plane (x, y)."""

    @property
    def across(self) -> float:
        """The largest distance from the source's middle [m]."""

    @property
    def on_a_line(self) -> bool:
        """Whether fields do not depend on y, so that contours in stretches serve too."""

    def too_large(self, search: Search, plan: BentPlan) -> bool:
        """Whether a plan takes more than can be summed, beside too many nodes."""

    def contour(self, search: Search, planned: Planned, second: bool) -> Contour:
        """The contour of a plan, or of its second plan, with circles around the poles on its wrong side."""

    def amplitudes(self, k0: float, sources: AngleInterpolation, contour: Contour) -> Amplitudes:
        """Of the beams that are summed."""

    def fields(
        self, k0: float, beams: AngleInterpolation, contour: Contour, h: np.ndarray, amplitudes: Amplitudes
    ) -> np.ndarray:
        """p of all `beams`, without interpolation, on the planes of h (Z, n): (B, Z, P)."""

    def with_wider_look(self, search: Search, planned: Planned, checks: Checks) -> Checks:
        """Checks with the peaks far outside of the requested positions."""


class Checks(NamedTuple):
    """The points at which two contours are compared, with what their fields are made of."""

    sources: AngleInterpolation
    k0: float
    transfer: TransferFunction
    places: Places
    z: np.ndarray
    guided: bool  #: whether the transfer function has guided modes (none without a slab)
    peaks_outside: np.ndarray  #: |p| where each requested beam lands outside of the positions, else 0; (A, Z)
    #: whether a plane is dark to rounding for each requested beam, (A, Z); None before it is determined
    dark: np.ndarray | None


#: Wavelengths from a face at which planes are compared too, a plain choice: what is evanescent comes and goes there within about one.
BESIDE_FACES = (-1.0, -0.25, 0.0, 0.25, 1.0)


def check_planes(z: np.ndarray, thickness: float, wavelength: float) -> np.ndarray:
    """Planes for a comparison: the ends and places between, and those next to the slab's faces, and within a wavelength of them."""
    zs = np.sort(z)
    spread = np.linspace(0, zs.size - 1, 7).round().astype(int)
    faces = np.array([0.0, thickness])
    wanted = np.add.outer(faces, wavelength * np.array(BESIDE_FACES)).ravel()
    nearest = np.argmin(np.abs(zs[:, None] - wanted), axis=0)
    behind = np.searchsorted(zs, faces)
    picked = np.concatenate([spread, nearest, behind - 1, behind, behind + 1])
    return np.unique(zs[np.clip(picked, 0, zs.size - 1)])


def check_positions(x: np.ndarray, centre: float, source: float, many: bool = False) -> np.ndarray:
    """Positions for a comparison: the ends, places between, and the source's width about its middle.

    For `many` interpolated beams half as many, since neighbouring beams complement each other. Their numbers are a plain
    choice: each position costs a column of two sums, and `error.MARGIN` covers larger differences between them.
    """
    picked, around = (17, 19) if many else (31, 41)
    xs = np.sort(x)
    xs = xs[np.unique(np.linspace(0, xs.size - 1, picked).round().astype(int))]
    ends = _towards_ends(x, xs, source)
    own = centre + source * np.linspace(-1, 1, around // 4 if ends.size else around)
    return np.concatenate([xs, own, ends])


def _towards_ends(x: np.ndarray, picked: np.ndarray, source: float) -> np.ndarray:
    """Positions that lie ever closer towards both ends, down to the source's width, where those picked are farther apart.

    Images of the beam by a finite step in kx come in from both ends, about as wide as the source.
    """
    apart = float(np.max(np.diff(picked), initial=0.0))
    if apart <= 2 * source:
        return np.empty(0)
    octaves = math.log2(apart / source)  # four positions an octave up to twenty, and at least two an octave
    steps = np.geomspace(source, apart, 2 + math.ceil(min(4 * octaves, max(20, 2 * octaves))))
    wanted = np.concatenate([picked[0] + steps, picked[-1] - steps])
    order = np.sort(x)
    return order[np.clip(np.searchsorted(order, wanted), 0, x.size - 1)]


# --- dark planes ------------------------------------------------------------------------------------------

#: Up to DARKEST planes for each of three beams are compared too, if |p| is DARKER times that within half a wavelength in front and
#: behind: nodes of standing waves, of two waves with amplitudes in the ratio (1 - 0.3)/(1 + 0.3) = 0.54 or nearer to 1.
DARKEST, DARKER = 4, 0.3
#: A plane is dark to rounding if |p| is LIGHTLESS times that BESIDE wavelengths in front and behind: next to a node a standing wave has
#: risen to sin(2 pi BESIDE) = 6e-3 of its antinode, and 1e-11 of that, 300 EPS of the antinode, is rounding of the response.
BESIDE, LIGHTLESS = 1e-3, 1e-11


def darkest_planes(sources: AngleInterpolation, k0: float, transfer: TransferFunction, z: np.ndarray) -> np.ndarray:
    """Planes at nodes of standing waves, where errors over the largest |p| of the plane are largest.

    By the strong plane waves of three beams: a plane that is dark for all of them is dark for the beam (Parseval).
    """
    order = np.sort(z)
    darkest: list[float] = []
    chosen = sources.spread(3)
    for angle in sources.requested[chosen]:
        darker = _darkness(_strengths(sources.at(float(angle)), k0, transfer, order), order, np.pi / k0)
        picked: list[float] = []
        for i in np.argsort(darker, kind="stable"):
            if darker[i] > DARKER or len(picked) == DARKEST:
                break
            if all(abs(order[i] - plane) > 0.1 / k0 for plane in picked):  # not the same node again
                picked.append(float(order[i]))
        darkest += picked
    return np.unique(darkest)


def _darkness(size: np.ndarray, z: np.ndarray, window: float) -> np.ndarray:
    """Sizes on sorted planes over the lesser of the largest within a window in front and behind: small at a node only."""
    half_windows = np.floor(
        (z - z[0]) / (window / 2)
    )  # as floats: more than an integer holds, where z spans kilometres at MHz
    bins = (
        np.unique(half_windows, return_inverse=True)[1] if half_windows[-1] > 4 * z.size else half_windows.astype(int)
    )
    largest = np.zeros(bins[-1] + 5)
    np.maximum.at(largest, bins + 2, size)
    padded = np.concatenate([size[:1], size, size[-1:]])
    front = np.max([largest[bins], largest[bins + 1], padded[:-2]], axis=0)
    behind = np.max([largest[bins + 3], largest[bins + 4], padded[2:]], axis=0)
    beside = np.minimum(front, behind)
    return np.divide(size, beside, out=np.ones(size.shape), where=beside > size)


def with_dark_planes(checks: Checks) -> Checks:
    """Determine the planes that are dark to rounding, such as the pressure-release face of a perfect wall."""
    sources, k0, transfer, z = checks.sources, checks.k0, checks.transfer, checks.z
    step = BESIDE * 2 * np.pi / k0
    near = np.concatenate([z, np.maximum(z - step, sources.beam.z0), z + step])
    chosen = sources.spread(9)
    dark = []
    for angle in sources.requested[chosen]:
        here, front, behind = np.split(_strengths(sources.at(float(angle)), k0, transfer, near), 3)
        dark.append(here < LIGHTLESS * np.where(behind > 0, np.minimum(front, behind), front))
    return checks._replace(dark=interpolated(sources.requested, sources.requested[chosen], np.array(dark)))


def _strengths(beam: Beam, k0: float, transfer: TransferFunction, z: np.ndarray) -> np.ndarray:
    """The largest |S h| of a beam's strong plane waves on each plane, (Z,)."""
    k = strong_waves(beam, k0)
    # H is even in kx; not at kx = 0, the only plane wave that passes a layer of density 0
    h = np.abs(transfer(np.maximum(np.abs(k), near_normal.NEAREST * k0) + 0j, z))
    return np.max(np.nan_to_num(h * np.abs(beam.spectrum(k, k0))), axis=1)


def strong_waves(beam: Beam, k0: float) -> np.ndarray:
    """Nine strong plane waves of a beam, from end to end of the band in which |S| is 0.3 of the largest, that propagate."""
    lo, hi = beam.band(k0, 0.3)
    if not beam.entire:  # its band is all that propagates: the strong part is looked for
        k = np.linspace(-0.999, 0.999, 4001) * k0
        size = np.abs(beam.spectrum(k, k0))
        lo, hi = k[np.flatnonzero(size >= 0.3 * size.max())[[0, -1]]]
    return np.clip(np.linspace(lo, hi, 9), -0.98 * k0, 0.98 * k0)


def _neighbours(at: np.ndarray, known: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Indices of those of `known`, increasing, that lie above and below each of `at`."""
    above = np.clip(np.searchsorted(known, at), 0, known.size - 1)
    return above, np.where(known[above] == at, above, np.maximum(above - 1, 0))


def interpolated(at: np.ndarray, known: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Values (P, ...) at `known`, increasing, carried to `at`: the lesser of both neighbours'."""
    above, below = _neighbours(at, known)
    return np.minimum(values[above], values[below])


def worse_neighbours(at: np.ndarray, known: np.ndarray, values: np.ndarray) -> np.ndarray:
    """The index, for each of `at`, of the neighbour among `known` with the larger of values (P,)."""
    above, below = _neighbours(at, known)
    return np.where(values[above] >= values[below], above, below)
