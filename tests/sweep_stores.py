"""A cheap question, and what the tests of stores of sweeps share."""

import os
import time

import numpy as np
import xarray as xr

import beamprop as bp
from beamprop.study import sweep

VALUES = np.arange(40.0)
FACTOR = 3.0


def plane(value):
    return xr.Dataset({"y": ("x", FACTOR * value * np.arange(3.0)), "c": 1j * value}, {"x": [1.0, 2.0, 4.0]})


def store_of_small_blocks(folder, monkeypatch):
    """The path of a store to be made, with blocks of seven points, whatever they take."""
    monkeypatch.setattr(sweep, "points_of_a_block", lambda seconds, bytes_each: 7)
    return folder / "study.zarr"


def ask(path, question=plane, values=VALUES, **options):
    return bp.sweep(question, {"value": values}, store=path, progress=False, **options)


def in_memory(question=plane, values=VALUES):
    return bp.sweep(question, {"value": values}, workers=1, progress=False)


def empty(path, *numbers):
    """Make blocks empty ones, as a kill before their status leaves them."""
    for number in numbers:
        (path / "status" / "c" / str(number)).unlink()


def counted(folder):
    """A question that leaves a file for every point it answers, and the numbers of those files."""
    folder.mkdir()

    def question(value):
        (folder / f"{value}-{time.perf_counter_ns()}").touch()
        return plane(value)

    return question, lambda: sorted(float(name.split("-")[0]) for name in os.listdir(folder))
