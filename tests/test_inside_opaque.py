"""p inside periods that hardly anything passes, where the matrix of one period grows: against layers with 60 digits."""

import numpy as np
import pytest
from accuracy_study.reference import many_digits
from accuracy_study.reference.medium import Medium

import beamprop as bp
from beamprop.response import interior
from beamprop.response.sampled_slab import sample
from beamprop.response.transfer_function import through

F = 2500.0
LAM = 343.0 / F
K0 = 2 * np.pi / LAM
#: Layers in which p falls by exp(-84) at normal incidence, between layers of air or of the same fluid with loss.
OPAQUE = bp.Layer(bp.Fluid(-20 * 1.25, bp.AIR.bulk_modulus), 3 * LAM)
CELLS = {
    "air between": [OPAQUE, bp.Layer(bp.AIR, 0.1 * LAM)],
    "loss between": [bp.Layer(bp.Fluid((1 + 9j) * 1.25, bp.AIR.bulk_modulus), 0.7 * LAM), OPAQUE],
}


@pytest.mark.parametrize("name", CELLS)
def test_p_inside_opaque_periods(name, monkeypatch):
    """At each plane to 1e-11 of what the plane wave is there, which is exp(-260) of the incident one at the last."""
    slab = bp.Slab(CELLS[name], 3)
    period = slab.thickness / 3
    z = np.array([0.0, 0.02, 0.5, 0.9, 1.0, 1.01, 1.6, 2.2, 2.98, 3.0]) * period
    k = np.array([0.013, 0.4, 0.99, 1.3, 2.1]) * K0
    calls, fill = [], interior._fill_opaque
    monkeypatch.setattr(interior, "_fill_opaque", lambda *given: calls.append(given) or fill(*given))
    got = through(sample(slab, F), -0.05)(k + 0j, z)
    medium = Medium(slab, F)
    want = np.array([many_digits.response(medium, kx, z, -0.05) for kx in k]).T
    assert calls
    assert np.abs(want[-1]).max() < 1e-100
    np.testing.assert_allclose(got / want, 1, rtol=0, atol=1e-11)


@pytest.mark.parametrize("name", CELLS)
def test_velocity_inside_opaque_periods(name):
    """(p, v_z) at a depth carried back through the rest of a layer is p at a depth in front of it, where both wave's sizes count."""
    slab = bp.Slab(CELLS[name], 3)
    k = np.array([0.013, 0.4, 0.99, 1.3, 2.1]) * K0
    w, ends = 2 * np.pi * F, 0.0
    for layer in CELLS[name] * 3:
        rho, K = complex(layer.fluid.density), complex(layer.fluid.bulk_modulus)
        z = ends + layer.thickness * np.array([0.2, 0.21, 0.93, 0.95])
        ends += layer.thickness
        p, v = (through(sample(slab, F), -0.05, q)(k + 0j, z) for q in ("p", "v_z"))
        kz, d = np.sqrt(rho * (w**2 / K - k**2 / rho)), np.diff(z)[::2, None]
        back = np.cos(kz * d) * p[1::2] - 1j * w * rho * np.sin(kz * d) / kz * v[1::2]
        np.testing.assert_allclose(back / p[::2], 1, rtol=0, atol=1e-11)
        along = through(sample(slab, F), -0.05, "v_x")(k + 0j, z)
        np.testing.assert_allclose(along * w * rho / p, 1, rtol=0, atol=1e-11)
    assert np.abs(p).max() < 1e-80
