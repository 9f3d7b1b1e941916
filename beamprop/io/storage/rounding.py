"""Values rounded to so many digits of the largest one, which compress; the error is recorded beside them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr

from ... import validate

#: Attribute with the largest error of a value, of a complex one's real and imaginary part each [units of the variable].
ERROR = "rounding_error"
#: A double has hardly one digit more.
MOST_DIGITS = 15
#: Multiples of a step up to this number of steps, of steps and values between these, are exact in single precision.
SINGLE, SMALLEST, LARGEST = 2.0**24, 2.0**-126, 2.0**127
#: Values of which the largest is below are kept as they are: their steps might be no normal numbers.
LEAST = 1e-280


def as_digits(digits: Any) -> int | None:
    """Number of digits to keep; None keeps all."""
    if digits is None:
        return None
    count = validate.as_count(digits, "digits")
    if count > MOST_DIGITS:
        raise validate.refuse("digits", f"a whole number from 1 to {MOST_DIGITS}", digits)
    return count


def rounded(ds: xr.Dataset, digits: int) -> xr.Dataset:
    """Data variables as multiples of a power of two that is at most 10^-digits of their largest value; coordinates as they are."""
    return ds.assign({name: _rounded(v.variable, digits) for name, v in ds.data_vars.items() if v.dtype.kind in "fc"})


def _rounded(v: xr.Variable, digits: int) -> xr.Variable:
    values = np.ascontiguousarray(v.values, complex if v.dtype.kind == "c" else float)
    real = values.view(float)
    largest = float(np.max(np.abs(values), where=np.isfinite(values), initial=0.0))
    before = float(v.attrs.get(ERROR, 0.0))
    if largest < LEAST:
        return xr.Variable(v.dims, v.values, v.attrs | {ERROR: before})
    # the error of half a step is below 10^-digits / 2 in both parts, and the steps themselves are exact
    step = 2.0 ** math.floor(math.log2(largest) - digits * math.log2(10))
    real = np.rint(real / step) * step
    if largest / step < SINGLE and step >= SMALLEST and largest < LARGEST:
        real = real.astype(np.float32)
    out = real.view(np.result_type(real, np.complex64)) if v.dtype.kind == "c" else real
    return xr.Variable(v.dims, out.reshape(v.shape), v.attrs | {ERROR: step / 2 + before})


def in_double(ds: xr.Dataset) -> xr.Dataset:
    """Rounded variables in double precision again, which holds what single precision holds."""
    single = {name: v for name, v in ds.data_vars.items() if ERROR in v.attrs and v.dtype.kind in "fc"}
    return ds.assign({n: v.astype(complex if v.dtype.kind == "c" else float) for n, v in single.items()})
