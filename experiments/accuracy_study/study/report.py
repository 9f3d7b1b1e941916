"""What is printed of the study: verdicts, tables, the picture, and the statements."""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from common import Statement

from ..cases.first import SOURCES
from ..cases.numbering import KINDS

#: A warning is needless where the field is right to a third of rtol.
NEEDLESS = 1 / 3


def verdicts(ds: xr.Dataset) -> dict[str, np.ndarray]:
    """Which cases are what; an error counts less what the truth itself may be off, below which no estimate is too sure."""
    status, warned = ds.status.values, ds.warned.values.astype(bool)
    compared = status == "answered"
    error = ds.error.values - ds.truth_error.values
    with np.errstate(invalid="ignore"):
        return {
            "compared": compared,
            "refused": status == "refused",
            "refused needlessly": (status == "refused") & np.isfinite(ds.truth_error.values),
            "crashed": status == "crashed",
            "without truth": status == "no truth",
            "warned": warned,
            "warned needlessly": compared
            & warned
            & (ds.dark.values == 0)
            & (ds.error.values + ds.truth_error.values < NEEDLESS * ds.rtol.values),
            "broken": compared & (error > ds.rtol.values) & ~warned,
            "too sure": compared & (error > 3 * np.maximum(ds.estimate.values, ds.truth_error.values)),
        }


COLUMNS = ("refused", "refused needlessly", "warned", "warned needlessly", "crashed", "compared", "broken", "too sure")


def class_table(ds: xr.Dataset) -> str:
    """By class, then by source, then all: what the promise was worth."""
    lines = [
        "| class | cases | refused | needlessly | warned | needlessly | crashed | compared | rtol broken | estimate < error/3 "
        "| median estimate/error | median s |",
        "|---" * 12 + "|",
    ]
    v = verdicts(ds)
    groups = [(k, ds.kind.values == k) for k in KINDS] + [(k, ds.source.values == k) for k in SOURCES]
    groups.append(("one of 40 or 150 angles", ds.many_angles.values.astype(bool)))
    groups.append(("in a map of 250 planes and more", ds.many_planes.values.astype(bool)))
    for name, rows in [*groups, ("all", np.ones(ds.sizes["case"], bool))]:
        if not rows.any():
            continue
        compared = v["compared"] & rows
        ratio = ds.estimate.values[compared] / np.maximum(ds.error.values[compared], 1e-17)
        middle = " | ".join(str(c) for c in [int(rows.sum()), *(int((v[key] & rows).sum()) for key in COLUMNS)])
        median = np.median(ratio) if compared.any() else np.nan
        lines.append(f"| {name} | {middle} | {median:.2g} | {np.nanmedian(ds.seconds.values[rows]):.2g} |")
    return "\n".join(lines)


def reasons(ds: xr.Dataset) -> str:
    """Why cases were refused, crashed, or had no truth, counted."""
    keys = [
        (s, "".join("#" if c.isdigit() else c for c in r))
        for s, r in zip(ds.status.values, ds.reason.values, strict=True)
        if r
    ]
    lines = ["| status | reason | cases |", "|---|---|---|"]
    for status, reason in sorted(set(keys)):
        lines.append(f"| {status} | {reason} | {keys.count((status, reason))} |")
    return "\n".join(lines)


#: What each letter before a listed case stands for.
FAULTS = ("broken", "too sure", "crashed", "refused", "refused needlessly", "warned needlessly", "without truth")


def faults(ds: xr.Dataset) -> str:
    """Every case of which something is to be said, one a line."""
    v = verdicts(ds)
    lines = []
    for i, number in enumerate(ds.case.values):
        what = [name for name in FAULTS if v[name][i]]
        what = [name for name in what if name + " needlessly" not in what]
        if not what:
            continue
        of = {name: ds[name].values[i] for name in ds}
        lines.append(
            f"{number:6d}  {of['kind']}, {of['source']}: {', '.join(what)}; error {of['error']:.1e}, "
            f"estimate {of['estimate']:.1e}, rtol {of['rtol']:.1e}, truth to {of['truth_error']:.0e}"
            + (", warned" if of["warned"] else "")
            + (f", {of['dark']} dark planes" if of["dark"] else "")
            + (f"; {of['reason'] or of['truth']}" if of["reason"] or of["truth"] else "")
        )
    return "\n".join(lines) or "nothing to say of any case"


def plot(ds: xr.Dataset) -> plt.Figure:
    """True error against rtol, and the estimate against the true error."""
    v = verdicts(ds)
    compared = v["compared"]
    fig, (left, right) = plt.subplots(1, 2, figsize=(13, 6), layout="constrained")
    for i, kind in enumerate(KINDS):
        rows = compared & (ds.kind.values == kind)
        style: dict[str, Any] = {
            "s": 9,
            "color": plt.get_cmap("tab20")(i % 20),
            "marker": "ox"[i // 20],
            "label": kind,
        }
        error = np.maximum(ds.error.values[rows], 1e-17)
        left.scatter(ds.rtol.values[rows], error, **style)
        right.scatter(error, ds.estimate.values[rows], **style)
    marked = compared & v["warned"]
    left.scatter(
        ds.rtol.values[marked], ds.error.values[marked], s=50, facecolors="none", edgecolors="k", label="warned"
    )
    span = np.array([1e-17, 1.0])
    left.plot([1e-11, 1e-3], [1e-11, 1e-3], "k-", lw=0.8)
    right.plot(span, span, "k-", lw=0.8)
    right.plot(span, span / 3, "k--", lw=0.8)
    scales = {"xscale": "log", "yscale": "log"}
    above = "a point above the line must be warned of"
    left.set(**scales, xlabel="requested rtol", ylabel="true error", title=above)
    below = "no point below the dashed line, a third"
    right.set(**scales, xlabel="true error", ylabel="error_estimate", title=below, xlim=(1e-17, 2))
    left.legend(fontsize="x-small", loc="upper left", ncols=2)
    return fig


def statements(ds: xr.Dataset, apart: np.ndarray) -> list[Statement]:
    """The promise, what it costs in needless refusals and warnings, and the limit of vanishing absorption."""
    v = verdicts(ds)
    share = f"{int(v['compared'].sum())} of {v['compared'].size} cases compared"
    rows = []
    for stated, key in (
        ("error above rtol without a warning", "broken"),
        ("estimate below a third of the error", "too sure"),
    ):
        rows.append(Statement("accuracy", f"no {stated}", f"{int(v[key].sum())}; {share}", not v[key].any()))
    rows.append(Statement("accuracy", "no crash", str(int(v["crashed"].sum())), not v["crashed"].any()))
    needless = v["refused needlessly"] | v["warned needlessly"]
    counts = [int(v[key].sum()) for key in ("refused needlessly", "warned needlessly")]
    rows.append(
        Statement(
            "accuracy",
            "refusals and warnings that are needless: fewer than 1 %",
            f"{counts[0]} refusals, {counts[1]} warnings of {needless.size}",
            float(needless.mean()) < 0.01,
        )
    )
    rates = apart[:-1] / apart[1:]
    computed = f"ten times less loss, {rates[2:].min():.3f} to {rates[2:].max():.3f} times nearer below 1e-4"
    holds = bool(np.all(np.abs(rates[2:] - 10) < 0.2))
    rows.append(Statement("accuracy", "vanishing loss tends to the lossless field, linearly", computed, holds))
    return rows
