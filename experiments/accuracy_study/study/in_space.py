"""Fields in three dimensions compared with the truth, and what is printed of it."""

from __future__ import annotations

import re
import time
import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

import beamprop as bp

from ..case import SpaceCase
from ..cases.in_space import KINDS, requested, space_case
from ..reference import in_space
from .comparison import REFUSAL, error_of, in_processes

SOURCES = ("GaussianBeam", "Piston", "Bowl", "Array")


def answer(case: SpaceCase, grid: tuple[np.ndarray, np.ndarray, np.ndarray]) -> tuple[Any, dict[str, Any]]:
    """The package's field at (x, y, z) of a grid, if it gives one, and what it said."""
    row: dict[str, Any] = {"status": "answered", "reason": "", "warned": False}
    (x, y, z), ds, start = grid, None, time.perf_counter()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            ds = bp.field(case.slab, case.beam, case.frequency, x, z, y=y, rtol=case.rtol)
        except ValueError as error:
            row |= {"status": "refused" if REFUSAL.match(str(error)) else "crashed", "reason": str(error)[:90]}
        except Exception as error:  # a crash is a finding, not the study's end
            row |= {"status": "crashed", "reason": f"{type(error).__name__}: {error}"[:90]}
    kinds = {w.category for w in caught}
    row |= {"seconds": time.perf_counter() - start, "warned": bp.AccuracyWarning in kinds}
    if strange := kinds - {bp.AccuracyWarning, bp.HintWarning}:
        row["reason"] = f"warning: {strange}"[:90]
    return ds, row


def compare_in_space(number: int) -> dict[str, Any]:
    """One case: the package's answer, its promise, and the truth."""
    case = space_case(number)
    x, y, z = grid = requested(number, case)
    ds, said = answer(case, grid)
    row = {
        "number": number,
        "kind": case.kind,
        "source": type(case.beam).__name__,
        "volume": z.size > case.z.size,
        "rtol": case.rtol,
        "error": np.nan,
        "estimate": np.nan,
        "truth_error": np.nan,
    } | said
    if ds is None:
        return row
    row["estimate"] = float(ds.error_estimate)
    with np.errstate(all="ignore"):
        reference = in_space.truth(case)
    if isinstance(reference, str):
        return row | {"status": "no truth", "reason": reference}
    own = np.ix_(*(np.searchsorted(v, of) for v, of in ((z, case.z), (y, case.y), (x, case.x))))
    p = ds.p.values.reshape(z.size, y.size, x.size)[own].reshape(case.z.size, -1)
    row["error"], row["truth_error"] = error_of(p, reference)
    return row


def study(numbers: Sequence[int], workers: int = 2) -> xr.Dataset:
    """All cases, in processes of their own."""
    return in_processes(compare_in_space, numbers, workers)


def summary(ds: xr.Dataset) -> str:
    """What the promise was worth by class, then of all; reasons; and every case of which something is to be said."""
    status, rtol, warned = ds.status.values, ds.rtol.values, ds.warned.values.astype(bool)
    compared = status == "answered"
    error = ds.error.values - ds.truth_error.values
    broken = compared & (error > rtol) & ~warned
    sure = compared & (ds.estimate.values < error / 3)
    lines = [
        "| class | cases | refused | crashed | warned | without truth | compared | rtol broken | estimate < error/3 | worst error/rtol | median s |"
    ]
    lines.append("|---" * 11 + "|")
    kinds = {kind: ds.kind.values == kind for kind in KINDS}
    kinds |= {source: ds.source.values == source for source in SOURCES}
    kinds |= {"volumes": ds.volume.values.astype(bool), "all": np.ones(status.shape, bool)}
    for kind, rows in kinds.items():
        if not rows.any():
            continue
        counts = [
            rows,
            rows & (status == "refused"),
            rows & (status == "crashed"),
            rows & warned,
            rows & (status == "no truth"),
        ]
        counts += [rows & compared, rows & broken, rows & sure]
        quiet = rows & compared & ~warned
        worst = np.max((ds.error.values / rtol)[quiet], initial=0.0)
        numbers = " | ".join(str(int(c.sum())) for c in counts)
        lines.append(f"| {kind} | {numbers} | {worst:.2g} | {np.median(ds.seconds.values[rows]):.2g} |")
    lines.append("")
    for i, number in enumerate(ds.case.values):
        if broken[i] or sure[i] or warned[i] or status[i] != "answered" or ds.reason.values[i]:
            of = {name: ds[name].values[i] for name in ds}
            lines.append(
                f"{number:5d} {of['kind']}, {of['source']}: {of['status']}{', warned' if warned[i] else ''}; error {of['error']:.1e}, estimate "
                f"{of['estimate']:.1e}, rtol {of['rtol']:.1e}, truth to {of['truth_error']:.0e}; {re.sub('[0-9.]{6,}', '#', str(of['reason']))}"
            )
    return "\n".join(lines)
