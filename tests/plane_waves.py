"""Plane waves at 2500 Hz through a slab, by the package and with 50 digits."""

import numpy as np
from oracles import slab_response

import beamprop as bp
from beamprop import response
from beamprop.media.values import slab_values

F = 2500.0
OMEGA = 2 * np.pi * F
K0 = OMEGA / 343


def r_t(slab, kx):
    ds = bp.scattering(slab, F, kx=kx)
    return ds.r.values, ds.t.values


def amplitudes(slab, kx, z=None):
    """r, t and p at depths z inside, of one plane wave or an array of them."""
    f, kx = np.array([F]), np.atleast_1d(np.asarray(kx, complex))
    out = response.solve(
        slab_values(slab, f),
        slab.before.at(f),
        slab.after.at(f),
        np.array([[OMEGA]]),
        kx[None],
        None if z is None else np.asarray(z, float),
    )
    return out.r[0], out.t[0], out.inside[0]


def inside(slab, kx, z):
    """p at depths z per unit incident pressure, (Z, n)."""
    return amplitudes(slab, kx, z)[2]


def cells(slab):
    return [(layer.fluid.density, layer.fluid.bulk_modulus, layer.thickness) for layer in slab.cell.layers]


def witness(slab, kx):
    """r and t with 50 digits."""
    ends = [(v.density, v.bulk_modulus) for v in (slab.before, slab.after)]
    return [complex(v) for v in slab_response(cells(slab), slab.periods, *ends, F, kx)]
