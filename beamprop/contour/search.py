"""The search for a contour: its fixed data, bent plans, and the poles on the wrong side of their contours.

A `Search` is made once for a field and an rtol and does not change; a `Planned` is a bent plan with the poles on the wrong side of its
contour, up to the Re kx to which they were searched for. Everything is for one frequency.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..modes import misplaced
from ..response.sampled_slab import SampledSlab
from . import paths, survey
from .check_points import Checks
from .paths import BentPlan, Contour, Extent

#: The most plane waves of a contour: their response takes 3.2 MB a plane.
MOST_PLANE_WAVES = 200_000
#: The most beams for whose spectra's ends a contour meets the axis: panels graded towards the axis, some 90 for each end of a spectrum,
#: are 16 x 90 x 20 = 29 000 nodes then.
MOST_CUT = 8
#: From this many plane waves on a band begins at the beam's own plane waves: on contours with fewer, those nearer to the normal cost less
#: than the response that shows whether they matter.
MANY_PLANE_WAVES = 200
#: Tolerance over rtol with which the ends of spectra and bands are determined: none of these shows in an error of rtol.
BELOW_RTOL = 1e-3
#: Wavelengths above which, or below one over it, a size is likely in another unit: millimetres and megahertz for metres and hertz are 1e3 and 1e6 off.
ODD_SIZE = 1e3


class Search(NamedTuple):
    """The data by which a contour is chosen."""

    slab: SampledSlab
    checks: Checks
    extent: Extent
    rtol: float
    noise: float  #: relative rounding of the response
    sharp: float  #: distance from kx = 0 of the nearest singularity
    ends: np.ndarray  #: |kx| at which spectra are cut off while they matter still

    @property
    def start(self) -> float:
        """Re kx from which poles are searched for: before the nearest singularity, and before waves 0.06 degrees off the normal."""
        return min(1e-3 * self.slab.k0, 0.1 * min(self.sharp, self.extent.branch))


class Planned(NamedTuple):
    """A bent plan, and the poles on the wrong side of its contour up to Re kx = `searched`."""

    plan: BentPlan
    poles: misplaced.MisplacedPoles
    searched: float

    @property
    def unclear(self) -> bool:
        """Whether there are more modes than can be separated."""
        return self.poles is misplaced.UNCLEAR

    @property
    def any_misplaced(self) -> bool:
        """Whether a contour below the axis alone leaves any pole on its wrong side."""
        return bool(self.poles.poles) or math.isfinite(self.poles.crossing)


def begin(s: SampledSlab, checks: Checks, extent: Extent, rtol: float, seen: survey.Survey) -> tuple[Search, Planned]:
    """The search, its band no wider than the plane waves that arrive, and a first plan, without poles yet."""
    search = Search(s, checks, extent, rtol, seen.noise, seen.sharp, np.empty(0))
    if too_many_plane_waves(first_plan(search)):  # the spectrum of a sharp edge, but a slab lets little of it through
        extent = extent._replace(band=survey.arriving_band(s, checks, extent, BELOW_RTOL * rtol))
        search = search._replace(extent=extent)
    if first_plan(search).nodes > MANY_PLANE_WAVES:
        low = checks.sources.low(s.k0, 1e-6 * rtol)
        if low > 0 and survey.wide_enough(checks.transfer, checks.z, low, extent.band):
            search = search._replace(extent=extent._replace(low=low))
    if checks.sources.requested.size <= MOST_CUT:
        search = search._replace(ends=survey.cut_spectra(s, checks, search.extent, 0.1 * rtol))
    return search, Planned(first_plan(search), misplaced.NONE, 0.0 if checks.guided else math.inf)


def first_plan(search: Search, deepest: float = math.inf) -> BentPlan:
    """A bent plan from the error terms, no deeper than `deepest`."""
    return paths.plan_bent(search.extent, search.rtol, search.noise, deepest, search.sharp)


def too_many_plane_waves(plan: BentPlan) -> bool:
    """Whether a plan, or the second one that it is compared with, takes too many plane waves."""
    return plan.second_plan().nodes > MOST_PLANE_WAVES


def with_poles(search: Search, planned: Planned) -> Planned:
    """The plan with the poles on the wrong side of its contour up to the end of its band, crossing the axis where it has to.

    A crossing contour is at most half as deep as the crossing is wide, about as steep as where it leaves the origin.
    """
    plan = planned.plan
    if plan.band <= planned.searched:
        return planned
    searched = 1.15 * plan.band  # beyond the end of the second contour, 1.12 times the band
    poles = misplaced.misplaced(search.slab, 1.05 * plan.depth, searched, search.start)
    if math.isfinite(poles.crossing):
        gap = poles.gap / 2
        if plan.depth > 0.5 * gap:
            plan = first_plan(search, 0.5 * gap)._replace(band=plan.band)
        plan = plan._replace(crossing=poles.crossing, gap=gap)
    return Planned(plan, poles, searched)


def shallower(search: Search, planned: Planned) -> Planned:
    """A plan at a third of the depth, with fewer modes between its contour and the axis."""
    plan = first_plan(search, planned.plan.depth / 3)._replace(band=planned.plan.band)
    return Planned(plan, planned.poles, 0.0)


def pair_of_contours(search: Search, planned: Planned) -> tuple[Contour, Contour]:
    """The contours of a plan and of its second plan, with circles around the poles on their wrong side."""
    places = search.checks.places
    return places.contour(search, planned, False), places.contour(search, planned, True)


def refusal(search: Search) -> str:
    """The message of a refusal where poles cannot be separated: the least loss with which they can."""
    plan = first_plan(search)
    # the first, third and fifth depth of a search with loss, where the contour would not have too many plane waves
    shallow = [first_plan(search, plan.depth * share)._replace(band=plan.band) for share in (1 / 9, 1 / 81)]
    depths = [1.05 * p.depth for p in (plan, *shallow) if p is plan or p.second_plan().nodes < MOST_PLANE_WAVES / 4]
    loss = misplaced.enough_loss(search.slab, depths, 1.15 * plan.band, search.start)
    remedy = (
        ", or take a thinner slab or fewer periods: of losses up to 1, over each density and modulus, none would do"
        if loss is None
        else (
            f": a relative loss of {loss:.0e} would do, density + {loss:.0e}j |density| and bulk modulus - {loss:.0e}j |bulk modulus| "
            "in every layer and half-space"
        )
    )
    return (
        f"slab: it guides more backward waves than can be told from the forward ones; add loss{remedy}{sizes(search)}"
    )


def sizes(search: Search) -> str:
    """The sizes in a question, in wavelengths, for the end of a refusal; those of wrong units are far from what a wave of them does."""
    wavelength = 2 * math.pi / search.slab.k0
    source, across = 2 * search.extent.source / wavelength, search.checks.places.across
    farthest, slab = math.hypot(across, search.extent.path) / wavelength, search.slab.thickness / wavelength
    given = [v for v in (source, farthest, slab) if v > 0]
    odd = any(v > ODD_SIZE or v < 1 / ODD_SIZE for v in given)
    thick = f", the slab {slab:.3g} thick" if slab > 0 else ""
    return (
        f"; in wavelengths of {wavelength:.3g} m in front the source is {source:.3g} wide, the farthest position {farthest:.3g} away{thick}"
        f"{' (are all lengths in metres and the frequency in hertz?)' if odd else ''}"
    )


def too_many(search: Search) -> str:
    """The message of a refusal where a contour would take too many plane waves."""
    return (
        f"rtol: {search.rtol:g} needs more than {MOST_PLANE_WAVES} plane waves for this source and window (the spectrum of a sharp "
        "edge does not end on its own launch plane: ask for z a little behind z0; and a beam that has spread over very many "
        "wavelengths takes as many plane waves: ask for a shorter way or a higher rtol)"
        f"{sizes(search)}"
    )


def too_many_in_space(search: Search) -> str:
    """The same in three dimensions, where the lattice of (kx, ky) has an end too."""
    return (
        f"rtol: {search.rtol:g} needs too many plane waves in three dimensions for this beam and these positions: ask for positions nearer to the "
        "beam, for z a little behind z0 where the beam is narrow or its edge sharp, for a shorter way, or a higher rtol"
        f"{sizes(search)}"
    )
