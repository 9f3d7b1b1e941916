"""The field of questions that the bent contours do not serve: spectra that end in a step, and profiles on their launch plane."""

from __future__ import annotations

import mpmath as mp
import numpy as np

from ..case import Case
from .contour import panels
from .medium import Medium
from .quadrature import EPS, Truth, field_sum
from .source import Source

#: Kinds of built questions with a truth of their own: a spectrum that ends in a step, which no contour but the real axis serves;
#: and a profile at its samples on its launch plane, where what is launched is the field.
STEPPED, LAUNCHED = "stepped", "as launched"


def on_the_axis(case: Case) -> Truth:
    """The truth of a question without guided modes, by panels on the real axis, graded to 0, its branch points and ends."""
    m = Medium(case.slab, case.frequency)
    source = Source(case.beam, m.k0)
    end, fields = source.band(1e-17), []
    for count in (300, 450):
        steps = end * np.geomspace(1e-13, 1, 200)
        near = [b + side * steps for b in (0.0, *m.branches()) for side in (-1, 1)]
        edges = np.concatenate([np.linspace(0, end, count), *near])
        k, w = panels(np.unique(edges[(edges >= 0) & (edges <= end)]))
        x = case.x - case.beam.centre
        fields.append(field_sum(source, lambda kk: m.response(kk, case.z, case.beam.z0), k + 0j, w + 0j, None, x))
    scale = np.abs(fields[1]).max(axis=1)
    error = np.abs(fields[1] - fields[0]).max(axis=1) / scale
    return Truth(fields[1], scale, error, np.zeros(scale.size, bool), 0)


def as_launched(case: Case) -> Truth:
    """p exp(i k0 sin(angle) x) at samples of a profile about x = 0, its phases in 40 digits."""
    beam, samples = case.beam, getattr(case.beam, "samples", case.beam)
    rho, _, K = (float(complex(v[0]).real) for v in case.slab.before.at(np.array([case.frequency])))
    with mp.workdps(40):
        k0 = 2 * mp.pi * mp.mpf(case.frequency) * mp.sqrt(mp.mpf(rho) / mp.mpf(K))
        tilt = k0 * mp.sin(mp.radians(mp.mpf(beam.angle)))
        turn = np.array([complex(mp.expj(tilt * mp.mpf(float(x)))) for x in case.x])
    p = (samples.p[np.searchsorted(samples.x, case.x)] * turn)[None]
    return Truth(p, np.abs(p).max(axis=1), np.array([EPS]), np.zeros(1, bool), 0)
