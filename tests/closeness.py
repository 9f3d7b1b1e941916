"""How near two arrays are."""

import numpy as np

#: A few roundings.
RTOL = 1e-13


def close(found, wanted, rtol=RTOL, axis=None):
    """Largest difference over the largest wanted value (along an axis)."""
    scale = np.max(np.abs(wanted), axis=axis, keepdims=True)
    assert np.all(np.isfinite(found))
    assert np.max(np.abs(found - wanted) / np.where(scale > 0, scale, 1)) < rtol
