"""Questions asked in several threads at once: each answer is the one that a single thread gets."""

import functools
import random
import threading
from concurrent.futures import ThreadPoolExecutor

import dask
import dask.array as da
import numpy as np
import pytest

import beamprop as bp
from beamprop.arrays import fft
from beamprop.contour import sums

SLABS = {
    "lossy": bp.Slab(bp.lmmd_cell(), periods=60),
    "lossless": bp.Slab(bp.lmmd_cell(rho_m=0.05, delta_rho=0.0), periods=60),
    "water": bp.Slab.uniform(bp.Fluid.from_speed(1000.0, 1480.0), 0.05),
}
BEAM = bp.GaussianBeam(0.096, angle=20, z0=-0.1)
#: A large even grid: sums over it are FFTs.
X = np.linspace(-1.0, 1.0, 2048, endpoint=False)
Z = np.linspace(-0.1, 0.3, 9)

#: Questions that use FFTs of shapes that are alike, and one that uses none.
KINDS = {
    "field": lambda slab, f: bp.field(slab, BEAM, f, X, Z).p,
    "periodic": lambda slab, f: bp.field(slab, BEAM, f, X, Z, boundary="periodic").p,
    "many angles": lambda slab, f: bp.field(slab, BEAM, f, X, Z[:3], angle=np.linspace(-30, 30, 40)).p,
    "beam_measures": lambda slab, f: bp.beam_measures(slab, BEAM, f).to_array(),
    "beam_width": lambda slab, f: bp.beam_width(slab, BEAM, f + np.linspace(0, 500, 21)).to_array(),
    "scattering": lambda slab, f: bp.scattering(slab, f, kx_over_k0=np.linspace(0, 5, 1001)).to_array(),
}


def _questions():
    """Name -> question."""
    return {
        f"{kind}, {name}, {f} Hz": functools.partial(ask, slab, f)
        for kind, ask in KINDS.items()
        for name, slab in SLABS.items()
        for f in (2000.0, 2300.0)
    }


@pytest.fixture(scope="module")
def serial():
    """Name -> (question, its answer in this thread alone)."""
    return {name: (ask, np.asarray(ask())) for name, ask in _questions().items()}


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_the_questions_reach_the_fft(monkeypatch):
    """Or what follows would hold by itself."""
    shapes = []
    plan = fft.plan_for
    for module in (fft, sums):
        monkeypatch.setattr(module, "plan_for", lambda rows, n: shapes.append((rows, n)) or plan(rows, n))
    for name, ask in _questions().items():
        before = len(shapes)
        ask()
        assert (len(shapes) > before) != name.startswith("scattering"), name


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_threads_answer_as_one_does(serial):
    """Eight threads ask all questions, each in an order of its own."""
    names = list(serial)
    together = threading.Barrier(8)

    def differing(seed):
        order = random.Random(seed).sample(names, len(names))
        together.wait()
        return [
            name for name in order if not np.array_equal(np.asarray(serial[name][0]()), serial[name][1], equal_nan=True)
        ]

    with ThreadPoolExecutor(8) as pool:
        assert list(pool.map(differing, range(8))) == [[]] * 8


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_dask_threads_answer_as_one_does(serial):
    """The same questions as arrays of dask, computed by its threaded scheduler."""
    names = [name for name in serial for _ in range(4)]
    random.Random(0).shuffle(names)
    arrays = [
        da.from_delayed(dask.delayed(ask, pure=False)().data, answer.shape, answer.dtype)
        for ask, answer in (serial[name] for name in names)
    ]
    for name, answer in zip(names, dask.compute(*arrays, scheduler="threads", num_workers=8), strict=True):
        np.testing.assert_array_equal(answer, serial[name][1], err_msg=name)


def test_threads_share_no_buffers():
    """Two threads that live at the same time get buffers of their own for one shape; one thread gets the same again."""
    together = threading.Barrier(2)

    def buffers():
        plan = fft.plan_for(3, 64)
        together.wait()
        return plan, fft.plan_for(3, 64) is plan

    with ThreadPoolExecutor(2) as pool:
        (one, again), (two, _) = [task.result() for task in [pool.submit(buffers), pool.submit(buffers)]]
    assert again
    assert not np.shares_memory(one.source, two.source)
    assert not np.shares_memory(one.result, two.result)


def test_plans_are_bounded(monkeypatch):
    """A thread keeps some plans, those used last, of a bounded size; a plan above that size is made and not kept."""

    def shapes():
        monkeypatch.setattr(fft, "MOST_BUFFERS", 64 * 10_000)
        for n in range(40, 80):
            fft.plan_for(2, n)
        many = list(fft._PLANS.kept)
        fft.plan_for(100, 90)
        large = list(fft._PLANS.kept)
        fft.plan_for(100, 101)
        return many, large, list(fft._PLANS.kept)

    with ThreadPoolExecutor(1) as pool:
        many, large, huge = pool.submit(shapes).result()
    assert many == [(2, n) for n in range(64, 80)]
    assert large[-1] == (100, 90)
    assert sum(64 * r * n for r, n in large) <= 64 * 10_000
    assert (100, 101) not in huge
