"""One case compared with the truth: the package's answer, its promise, and the truth. All cases, in processes of their own."""

from __future__ import annotations

import multiprocessing
import re
import sys
import time
import warnings
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import xarray as xr
from tqdm import tqdm

import beamprop as bp

from ..case import Case
from ..cases.numbering import angles_of, make_case, map_of
from ..reference.quadrature import SILENT, Truth, truth

#: A refusal names the argument that asks too much; any other error is a fault of the package.
REFUSAL = re.compile(r"(slab|before|after|beam|frequency|x|y|z|rtol|angle|z0|x0): ")


def answer(case: Case, x: np.ndarray, z: np.ndarray, angles: np.ndarray | None) -> tuple[Any, dict[str, Any]]:
    """The package's field, if it gives one, and what it said."""
    row: dict[str, Any] = {"status": "answered", "reason": ""}
    ds = None
    start = time.perf_counter()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            ds = bp.field(case.slab, case.beam, case.frequency, x, z, angle=angles, rtol=case.rtol)
            ds = ds if angles is None else ds.isel(angle=int(np.flatnonzero(angles == case.beam.angle)[0]))
        except ValueError as error:
            row = {"status": "refused" if REFUSAL.match(str(error)) else "crashed", "reason": str(error)[:90]}
        except Exception as error:  # a crash is a finding, not the study's end
            row = {"status": "crashed", "reason": f"{type(error).__name__}: {error}"[:90]}
    row["seconds"] = time.perf_counter() - start
    row["warned"] = any(issubclass(w.category, bp.AccuracyWarning) for w in caught)
    if angles is not None and ds is not None:  # the warning is of the worst angle
        row["warned"] = row["warned"] and float(ds.error_estimate) > case.rtol
    expected = (bp.AccuracyWarning, bp.HintWarning)  # a wide beam looked at closely is meant here
    messages = [str(w.message) for w in caught if not issubclass(w.category, expected)]
    if messages and not row["reason"]:
        row["reason"] = f"warning: {messages[0][:80]}"
    return ds, row


def compared_with(case: Case, estimate: float) -> tuple[Truth | str, np.ndarray]:
    """The truth at some of a fine grid's positions, known well enough to measure an estimate by; and which positions."""
    positions = np.unique(np.linspace(0, case.x.size - 1, 61).round().astype(int))
    own = case.beam.centre + case.beam.reach(1e-3 * case.rtol) * np.linspace(-1, 1, 41)
    with np.errstate(all="ignore"):
        return truth(case._replace(x=case.x[positions]), own, min(0.1 * case.rtol, 0.3 * estimate)), positions


def error_of(p: np.ndarray, reference: Truth) -> tuple[float, float]:
    """Of the planes that are not dark the worst error over the largest |p|, and how well the truth knows it.

    Where p vanishes, a soft wall say, nothing may be there but rounding.
    """
    seen = reference.scale > SILENT
    error = np.abs(p - reference.p).max(axis=1) / np.where(seen, reference.scale, np.inf)
    error = np.where(np.isfinite(p).all(axis=1), error, np.inf)
    left = ~reference.dark
    surplus = np.where(left, error - reference.error, -np.inf)
    worst = int(np.argmax(surplus))
    return float(error[worst]), float(reference.error[worst])


def compare_with_truth(number: int) -> dict[str, Any]:
    """One case: the package's answer, its promise, and the truth."""
    case = make_case(number)
    angles = angles_of(number, case)
    x, z = map_of(number, case)
    row: dict[str, Any] = {
        "number": number, "kind": case.kind, "source": case.source, "rtol": case.rtol, "error": np.nan, "estimate": np.nan,
        "truth_error": np.nan, "wrong": 0, "dark": 0, "truth": "", "many_angles": angles is not None, "many_planes": z.size > case.z.size,
    }  # fmt: skip
    ds, said = answer(case, x, z, angles)
    row |= said
    if row["status"] == "crashed":
        return row
    answered = row["status"] == "answered"
    row["estimate"] = float(ds.error_estimate) if answered else np.nan
    reference, positions = compared_with(case, row["estimate"] if answered else case.rtol)
    if isinstance(reference, str):
        row["truth"] = reference
        return row | ({"status": "no truth", "reason": row["reason"] or reference} if answered else {})
    row |= {
        "wrong": reference.wrong,
        "dark": int(reference.dark.sum()),
        "truth_error": float(reference.error[~reference.dark].max()),
    }
    if answered:
        p = ds.p.values.reshape(z.size, x.size)[np.searchsorted(z, case.z)][:, np.searchsorted(x, case.x)][:, positions]
        row["error"], row["truth_error"] = error_of(p, reference)
    return row


def study(numbers: Sequence[int], workers: int = 2) -> xr.Dataset:
    """All cases, in processes of their own."""
    return in_processes(compare_with_truth, numbers, workers)


def in_processes(compare: Callable[[int], dict[str, Any]], numbers: Sequence[int], workers: int) -> xr.Dataset:
    """What `compare` says of all cases."""
    with multiprocessing.get_context("spawn").Pool(workers) as pool:
        jobs = pool.imap_unordered(compare, numbers)
        rows = sorted(tqdm(jobs, total=len(numbers), desc="cases", file=sys.stderr), key=lambda r: r["number"])
    keys = [key for key in rows[0] if key != "number"]
    return xr.Dataset({key: ("case", np.array([r[key] for r in rows])) for key in keys},
                      {"case": [r["number"] for r in rows]})  # fmt: skip
