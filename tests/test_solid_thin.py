"""Thin solid layers at many kx, whose functions are polynomials in kx^2, against many digits."""

import numpy as np
import pytest
import solid_oracles
from test_solids import IN_WATER, stack, worst

import beamprop as bp


@pytest.mark.parametrize("loss", [0.0, 0.02])
@pytest.mark.parametrize("thickness", [1e-6, 1e-5, 4e-5, 1.5e-4])
def test_many_kx_of_thin_layers_agree_with_many_digits(thickness, loss):
    """Enough kx for powers of kx^2, at two frequencies; of the thickest layers some are too thick for them."""
    media = ((7900.0, 5900.0, 3200.0), (1200.0, 2600.0 * (1 - 1j * loss), 1150.0 * (1 - 2j * loss)))
    layers = [(*media[j % 2], thickness * (1 + 0.05 * j)) for j in range(5)]
    kx = 2 * np.pi * 1e6 / 1480 * np.linspace(0, 2.9, 301) * (1 - 1j * loss)
    ds = bp.scattering(stack(layers), [0.7e6, 1e6], kx=kx)
    for i, frequency in enumerate((0.7e6, 1e6)):
        for j in (0, 1, 50, 76, 203, 300):
            exact = solid_oracles.response(layers, 1, IN_WATER, IN_WATER, frequency, kx[j])
            assert worst(ds.isel(frequency=i, kx=j), *exact) < 1e-11
