"""A field as the package answers it, with its warning, and its error on each plane."""

import warnings

import numpy as np
import sided

import beamprop as bp


def slab_of(layers, periods=1, after=sided.AIR):
    """The slab of layers (density, bulk modulus, thickness) in front of a half-space (density, bulk modulus)."""
    return bp.Slab([bp.Layer(bp.Fluid(rho, K), d) for rho, K, d in layers], periods, after=bp.Fluid(*after))


def field_and_warning(*question, **options):
    """The dataset of `bp.field`, and whether an AccuracyWarning came with it."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        ds = bp.field(*question, **options)
    return ds, any(issubclass(w.category, bp.AccuracyWarning) for w in caught)


def plane_errors(p, truth):
    """Largest error on each plane over its largest |p|."""
    return np.abs(p - truth).max(axis=-1) / np.abs(truth).max(axis=-1)
