"""Fast Fourier transforms: plans that each thread makes for itself, and lengths that suit them. The only user of an FFT library."""

from __future__ import annotations

import math
import threading
from typing import Any, NamedTuple

import numpy as np

from ..memory import check_fft


class Plan(NamedTuple):
    """Two FFTs: sum_m c_m e^{2 pi i m j/n} of source[0] (rows, n) into result[0], e^{-2 pi i m j/n} of 1; unscaled."""

    source: np.ndarray
    result: np.ndarray
    run: tuple[Any, Any]


#: Of the plans that a thread keeps: how many, and how many bytes of buffers. Planning takes less than a millisecond, so that a
#: shape too large to be kept loses nothing to speak of.
MOST_PLANS, MOST_BUFFERS = 16, 2**27


class _Plans(threading.local):
    """The plans of the running thread, the one used last at the end.

    A plan is executed in its own buffers, without the interpreter's lock: two threads that shared one would mix their fields.
    """

    def __init__(self) -> None:
        self.kept: dict[tuple[int, int], Plan] = {}


_PLANS = _Plans()


def plan_for(rows: int, n: int) -> Plan:
    """A plan for (rows, n) that the running thread alone uses."""
    kept = _PLANS.kept
    plan = kept.pop((rows, n), None) or _new_plan(rows, n)
    kept[rows, n] = plan
    while len(kept) > MOST_PLANS or (len(kept) > 1 and sum(map(_buffered, kept)) > MOST_BUFFERS):
        del kept[next(iter(kept))]
    if _buffered((rows, n)) > MOST_BUFFERS:
        del kept[rows, n]
    return plan


def _buffered(shape: tuple[int, int]) -> int:
    """Bytes of a plan's two pairs of buffers."""
    return 64 * shape[0] * shape[1]


def _new_plan(rows: int, n: int) -> Plan:
    """Buffers and the transforms between them. Out of place: faster where FFTW estimates, and a source keeps its zeros.

    FFTW makes and destroys plans in one thread at a time only: pyfftw holds a lock of its own while it does either.
    """
    check_fft(rows * n)
    try:
        import pyfftw
    except ImportError:  # no wheel for this platform
        return _scipy_plan(rows, n)
    source, result = (pyfftw.zeros_aligned((2, rows, n), dtype="complex128") for _ in range(2))
    # ESTIMATE plans in less than a millisecond; MEASURE takes 0.2 to 0.6 s a shape and gains no more than a fifth
    plans = [
        pyfftw.FFTW(source[i], result[i], axes=(1,), direction=direction, flags=("FFTW_ESTIMATE",))
        for i, direction in enumerate(("FFTW_BACKWARD", "FFTW_FORWARD"))
    ]
    return Plan(source, result, (plans[0].execute, plans[1].execute))


def _scipy_plan(rows: int, n: int) -> Plan:
    """The same by scipy, a third slower."""
    import scipy.fft

    source, result = (np.zeros((2, rows, n), complex) for _ in range(2))

    def backward() -> None:
        result[0] = scipy.fft.ifft(source[0], axis=1, norm="forward")

    def forward() -> None:
        result[1] = scipy.fft.fft(source[1], axis=1)

    return Plan(source, result, (backward, forward))


def transform(coefficients: np.ndarray) -> np.ndarray:
    """sum_m c_m e^{2 pi i m j/n} along the last axis, unscaled."""
    flat = coefficients.reshape(-1, coefficients.shape[-1])
    plan = plan_for(*flat.shape)
    plan.source[0] = flat
    plan.run[0]()
    return plan.result[0].reshape(coefficients.shape).copy()


def fast_length(n: int) -> int:
    """A length that an FFT likes: 2^a or 5 2^a up to an eighth longer than asked, else the next 2^a 3^b 5^c.

    Factors of 3 cost: 1152 and 1296 points take twice as long as 1280 (FFTW, plans by estimate).
    """
    powers = [f << max(0, math.ceil(math.log2(n / f))) for f in (1, 5)]
    longer = [m for m in powers if n <= m <= 1.125 * n]
    return min(longer) if longer else next_smooth(n)


def next_smooth(n: int) -> int:
    """The next 2^a 3^b 5^c."""
    best = 1 << max(0, (n - 1).bit_length())
    five = 1
    while five < best:
        three = five
        while three < best:
            two = three
            while two < n:
                two *= 2
            best = min(best, two)
            three *= 3
        five *= 5
    return best


def cosine_coefficients(values: np.ndarray) -> np.ndarray:
    """Coefficients (N, ...) of the cosine series through values (N, ...) at (j + 1/2) pi/N, into the same array."""
    from scipy.fft import dct

    series = dct(values, type=2, axis=0, overwrite_x=True)
    series *= 1 / len(values)
    series[0] /= 2
    return np.asarray(series)


def cosine_series(values: np.ndarray, n: int) -> np.ndarray:
    """The cosine series through values (N,) at (j + 1/2) pi/N, at the angles i pi/n, i = 0 to n > N: (n + 1,)."""
    from scipy.fft import dct

    series = np.zeros(n + 1, complex)
    series[: values.size] = dct(values, type=2) / (2 * values.size)
    return np.asarray(dct(series, type=1))
