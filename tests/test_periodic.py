"""Periodic arrays of sources with sharp edges: every order counts on the launch plane, few of them elsewhere."""

import numpy as np
import pytest
from fem_reference import periodic_field

import beamprop as bp
from beamprop.response.fluid_slab import FluidSlab

F, PERIOD = 2500.0, 0.2
SLITS = bp.Slits(0.011, 0.03, z0=-0.05)
X = np.linspace(-0.09, 0.09, 8)
#: A tenth of a millimetre from the launch plane and more, and in any order.
Z = np.array([0.03, -0.0499, -0.0498, -0.049, 0.2, -0.03, 0.0])
PLASTIC = bp.Fluid.from_speed(40.0, 500.0)
SLABS = {
    "layers": bp.Slab(bp.Cell((bp.Layer(PLASTIC, 0.02), bp.Layer(bp.AIR, 0.013)))),
    "hyperbolic": bp.Slab.uniform(bp.Fluid(5.0 + 0.5j, 1.5e5 - 1e3j, density_x=-2.0 + 0.2j), 0.04),
    "opaque": bp.Slab.uniform(bp.Fluid(bp.AIR.density, -40.0), 0.025),
}


@pytest.mark.parametrize("slab", SLABS.values(), ids=SLABS)
def test_orders_that_are_left_out_are_below_rounding(slab):
    """On every plane, the sum of all orders in extended precision."""
    count = 13_000  # exp(-2 pi 13000/0.2 1e-4) is 2e-18
    exact = periodic_field(slab, SLITS, F, X, Z, PERIOD, count)
    p = bp.field(slab, SLITS, F, X, Z, boundary="periodic", period=PERIOD).p.values
    assert np.max(np.abs(p - exact).max(axis=1) / np.abs(exact).max(axis=1)) < 1e-11


def test_a_map_takes_the_orders_that_reach_each_plane(monkeypatch):
    """All planes at 200 000 orders would take 600 times as many values of the response as one."""
    respond, values = FluidSlab.response, []

    def counted(s, kx, z=None, quantity="p"):
        values.append(np.size(kx) * (1 if z is None else np.size(z)))
        return respond(s, kx, z, quantity)

    monkeypatch.setattr(FluidSlab, "response", counted)
    z = np.linspace(SLITS.z0, 0.3, 600)
    p = bp.field(SLABS["layers"], SLITS, F, X, z, boundary="periodic", period=PERIOD).p
    assert sum(values) < 4e6
    near = np.abs(X[:, None] - SLITS.positions).min(axis=1) < SLITS.width / 2
    assert np.abs(p.values[0][~near]).max() < 0.2 < np.abs(p.values[0][near]).min()
