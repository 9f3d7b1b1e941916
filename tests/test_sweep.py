"""Sweeps in memory: what they answer, against the plain loop; what fails, what is refused."""

import functools
import itertools
import re
import warnings
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import numpy as np
import pytest
import sweep as benchmark
import xarray as xr
from threadpoolctl import threadpool_info, threadpool_limits

import beamprop as bp
from beamprop.io import datasets
from beamprop.study import blocks, run, sweep
from beamprop.study.axes import study_of

F = np.array([2400.0, 2500.0])
ETA = np.array([1 / 60, 1 / 40, 1 / 30])


def width(eta, frequency):
    return bp.beam_width(bp.Slab(bp.lmmd_cell(eta=eta), 20), bp.GaussianBeam(0.096), frequency)


def plane(value, word="a"):
    """A cheap question with a dimension of its own."""
    return xr.Dataset({"y": ("x", value * np.arange(3.0)), "c": 1j * value + len(word)}, {"x": [1.0, 2.0, 4.0]})


@pytest.fixture(scope="module")
def widths():
    return bp.sweep(width, {"eta": ETA, "frequency": F}, workers=1, progress=False)


def test_values_are_those_of_the_plain_loop(widths):
    """Every variable at every point; widths that are computed together to rounding, all else bit for bit."""
    for eta, frequency in itertools.product(ETA, F):
        point = widths.sel(eta=eta, frequency=frequency)
        for name, v in width(eta, frequency).data_vars.items():
            assert point[name].item() == pytest.approx(
                v.item(), rel=1e-10, abs=1e-8 if name == "error_estimate" else 1e-9
            )
    assert (widths.status == 1).all()
    assert (widths.message == "").all()
    values = np.array([0.1, 0.2, 0.7])
    for point, value in zip(bp.sweep(plane, {"value": values}, workers=1, progress=False).y, values, strict=True):
        np.testing.assert_array_equal(point, plane(value).y)


@pytest.mark.parametrize("places", [1, 5])
def test_values_do_not_depend_on_what_was_measured_first(widths, places, monkeypatch):
    """So that a study that goes on after a kill ends in the same bits: widths are computed with their block alone."""
    monkeypatch.setattr(sweep, "PLACES", places)
    again = bp.sweep(width, {"eta": ETA, "frequency": F}, workers=1, progress=False)
    for name, v in widths.data_vars.items():
        np.testing.assert_array_equal(again[name], v)


def test_axes_have_units_and_come_first(widths):
    assert widths.fwhm_out.dims == ("eta", "frequency")
    assert widths.frequency.attrs == {"units": "Hz", "long_name": "frequency"}
    assert widths.eta.attrs["units"] == "1"
    assert widths.fwhm_out.attrs["units"] == "m"


def test_provenance_of_a_point_rebuilds_its_slab_and_beam(widths):
    """Not those of another; of several points with one record, theirs; of the whole, the study."""
    for eta, frequency in itertools.product(ETA, F):
        record = bp.provenance(widths.sel(eta=eta, frequency=frequency))
        assert record["slab"] == bp.Slab(bp.lmmd_cell(eta=eta), 20)
        assert record["beam"] == bp.GaussianBeam(0.096)
    assert bp.provenance(widths.sel(eta=ETA[1]))["slab"].cell == bp.lmmd_cell(eta=ETA[1])
    assert bp.provenance(widths)["question"] == "sweep"
    assert "def width" in bp.provenance(widths)["study"]["parts"]["question.source"]


def test_records_are_kept_once_in_a_block():
    """40 points with one slab have as many records as blocks, not points."""
    ds = bp.sweep(lambda frequency: width(ETA[0], frequency), {"frequency": np.linspace(2400, 2500, 40)}, workers=1)
    per_block = [len(datasets.unpacked(text)) for text in ds.records.values.tolist()]
    assert per_block == [1] * ds.sizes["block"]


def test_own_dimensions_complex_values_and_words():
    ds = bp.sweep(plane, {"word": ["a", "bcd"], "value": [1, 2, 5]}, progress=False)
    assert ds.y.dims == ("word", "value", "x")
    np.testing.assert_array_equal(ds.x, [1.0, 2.0, 4.0])
    np.testing.assert_array_equal(ds.y.sel(word="a", value=5), [0.0, 5.0, 10.0])
    np.testing.assert_array_equal(ds.c, [[1 + 1j, 1 + 2j, 1 + 5j], [3 + 1j, 3 + 2j, 3 + 5j]])


def test_maps_are_reduced_by_the_question():
    """What is kept is what the question returns."""

    def largest(eta):
        p = bp.field(
            bp.Slab(bp.lmmd_cell(eta=eta), 5), bp.GaussianBeam(0.096), 2500.0, np.linspace(-1, 1, 101), [0.0, 0.1]
        )
        return abs(p.p).max("x").to_dataset(name="peak")

    ds = bp.sweep(largest, {"eta": ETA}, progress=False)
    assert ds.peak.dims == ("eta", "z")
    assert ds.peak.sel(eta=ETA[2]).identical(ds.peak[2])
    np.testing.assert_array_equal(ds.peak[2], largest(ETA[2]).peak)


# --- what goes wrong ----------------------------------------------------------------------------------------


def sometimes(value):
    if value == 2:
        raise ArithmeticError("two is no number")
    if value == 3:
        warnings.warn("three is odd", UserWarning, stacklevel=1)
    return plane(value)


def test_a_failed_point_is_nan_has_a_message_and_is_announced():
    """And a warning of the question is told, with its point."""
    with pytest.warns(RuntimeWarning) as told:
        ds = bp.sweep(sometimes, {"value": [1, 2, 3]}, progress=False)
    assert ds.status.values.tolist() == [1, 2, 1]
    assert ds.message.values.tolist() == ["", "ArithmeticError: two is no number", "UserWarning: three is odd"]
    assert np.isnan(ds.y[1]).all()
    assert np.isnan(ds.c[1])
    np.testing.assert_array_equal(ds.y[2], plane(3).y)
    assert [str(w.message)[:18] for w in told] == ["1 of 3 points fail", "1 of 3 points warn"]
    assert bp.provenance(ds.isel(value=1))["question"] == "sweep"


def test_a_point_of_another_form_has_failed():
    def other_form(value):
        return plane(value) if value != 2 else plane(value).isel(x=[0, 1])

    def other_places(value):
        return plane(value) if value != 2 else plane(value).assign_coords(x=[0.0, 1.0, 2.0])

    def other_names(value):
        return plane(value) if value != 2 else plane(value).rename(y="v")

    for question in (other_form, other_places, other_names):
        with pytest.warns(RuntimeWarning, match=r"^1 of 3 points failed.*as before|same values"):
            ds = bp.sweep(question, {"value": [1, 2, 3]}, progress=False)
        assert ds.status.values.tolist() == [1, 2, 1]
        assert np.isnan(ds.y[1]).all()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((3, {"value": [1]}), r"^question: expected a function"),
        ((plane, {}), r"^axes: expected a dict of at least one name"),
        ((plane, {"values": [1]}), r"^axes: expected the arguments of question\(value, word='a'\), got values"),
        ((plane, {"value": [1, 1]}), r"^axes\['value'\]: expected values that differ"),
        ((plane, {"value": [1, np.nan]}), r"^axes\['value'\]: expected finite"),
        ((plane, {"value": 1.0}), r"^axes\['value'\]: expected a 1-D array"),
        ((plane, {"value": [bp.AIR]}), r"^axes\['value'\]: expected a 1-D array"),
        ((lambda status: plane(1), {"status": [1]}), r"^axes: expected names of arguments other than status"),
        ((lambda value: 3.0, {"value": [1]}), r"^question: expected an answer at one of 1 points.*got float"),
        ((lambda x: plane(x), {"x": [1]}), r"^question: expected a Dataset without x"),
        ((lambda v: plane(v).assign(s="word"), {"v": [1]}), r"^question: expected variables of numbers, got s"),
    ],
)
def test_refusals(arguments, message):
    with pytest.raises(ValueError, match=message):
        bp.sweep(*arguments, progress=False)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("workers", 0),
        ("progress", 3),
        ("executor", 3),
        ("shard", (3, 2)),
        ("shard", 2),
        ("shard", (1, 2)),
        ("repair", 1),
    ],
)
def test_refused_options(name, value):
    with pytest.raises(ValueError, match=rf"^{name}: expected"):
        bp.sweep(plane, {"value": [1]}, **{"progress": False, name: value})


def test_what_does_not_fit_into_memory_is_refused_before_it_is_made(monkeypatch):
    monkeypatch.setenv("BEAMPROP_MEMORY", "1M")
    with pytest.raises(ValueError, match=r"^axes: expected a question that fits into 1.05 MB.*give a store"):
        bp.sweep(plane, {"value": np.arange(100_000)}, progress=False)


# --- engines ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", [ProcessPoolExecutor, ThreadPoolExecutor])
def test_any_executor_answers(kind, widths):
    """The executor stays open for its owner."""
    with kind(1) as executor:
        ds = bp.sweep(width, {"eta": ETA, "frequency": F}, executor=executor, progress=False)
        assert executor.submit(int, 3).result() == 3
    for name in widths.data_vars:
        np.testing.assert_array_equal(ds[name], widths[name])


def test_processes_take_lambdas_closures_and_partials(monkeypatch):
    """Started afresh, with the same values as this process."""
    monkeypatch.setattr(sweep, "START", 0.0)
    factor = 3.0
    question = functools.partial(lambda value, shift: plane(factor * value + shift), shift=1.0)
    ds = bp.sweep(question, {"value": np.arange(50.0)}, workers=2, progress=False)
    for value in (0.0, 49.0):
        np.testing.assert_array_equal(ds.y.sel(value=value), plane(factor * value + 1.0).y)
    assert (ds.status == 1).all()


def blas_threads():
    return max(library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas")


def test_workers_have_one_blas_thread(monkeypatch):
    """And so has this process while it answers, and not longer."""
    monkeypatch.setattr(sweep, "START", 0.0)
    with threadpool_limits(2):
        before = blas_threads()
        for workers in (1, 2):
            ds = bp.sweep(
                lambda v: xr.Dataset({"n": blas_threads()}), {"v": np.arange(40)}, workers=workers, progress=False
            )
            assert (ds.n == 1).all()
        assert blas_threads() == before


def test_progress_counts_points():
    seen = []
    bp.sweep(plane, {"value": np.arange(7)}, workers=1, progress=lambda items: (seen.append(k) or k for k in items))
    assert seen == list(range(7))


# --- blocks -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("shape", "points"), [((3, 5, 7), 1), ((3, 5, 7), 4), ((3, 5, 7), 20), ((3, 5, 7), 1000), ((11,), 4)]
)
def test_blocks_cover_every_point_once(shape, points):
    grid = blocks.grid_of(shape, points)
    flat = np.concatenate([grid.points(b) for b in range(grid.size)])
    assert sorted(flat.tolist()) == list(range(np.prod(shape)))
    numbers = np.arange(np.prod(shape)).reshape(shape)
    for b in range(grid.size):
        np.testing.assert_array_equal(numbers[grid.where(b)].ravel(), grid.points(b))
        assert grid.points(b).size <= points


def test_blocks_are_worth_their_overhead():
    """Twenty times what a block costs, unless it would be too large."""
    assert blocks.points_of_a_block(1e-3, 100) * 1e-3 >= 20 * blocks.OVERHEAD
    assert blocks.points_of_a_block(100.0, 100) == 1
    assert blocks.points_of_a_block(1e-6, 2**25) == 2


def test_points_are_plain_numbers():
    """As a loop over lists gives them."""
    study = study_of(plane, {"word": ["a", "b"], "value": np.arange(3)})
    assert study.points(np.array([0, 4])) == [("a", 0), ("b", 1)]
    assert all(type(v) is int for _, v in study.points(np.arange(6)))
    assert run.DEATHS == 2


def test_the_overhead_of_a_block_is_what_the_benchmark_measures():
    """Of a block of 500 points: kept in a store and sent, in less than `OVERHEAD`; a point in less than 0.1 ms."""
    (text,) = benchmark.own_costs()
    point, _, stored, sent = (float(number) for number in re.findall(r"([\d.]+) (?:µs|ms)", text)[:4])
    assert 1e-3 * (stored + sent) < 2 * blocks.OVERHEAD, text
    assert point < 100, text


def test_records_are_short_and_bounded(monkeypatch):
    """A hundred slabs of 20 layers take less than a third of their text; what would unfold to more than a limit is cut off."""
    slabs = [bp.Slab(bp.lmmd_cell(eta=1 / (60 + k), n_layers=20)) for k in range(100)]
    records = [bp.scattering(slab, 2500.0, kx=0.0).attrs["provenance"] for slab in slabs]
    text = datasets.packed(records)
    assert datasets.unpacked(text) == records
    assert len(text) < 0.3 * sum(map(len, records))
    monkeypatch.setattr(datasets, "MOST_RECORDS", 1000)
    with pytest.raises(ValueError, match="Unterminated"):
        datasets.unpacked(text)


def test_plane_waves_at_several_angles_fit_together_with_the_normal_among_them():
    slab = bp.Slab(bp.lmmd_cell(), periods=4)

    def question(angle):
        return bp.scattering(slab, [2000.0, 2500.0], angle=angle)

    ds = bp.sweep(question, {"angle": [0.0, 10.0]}, workers=1, progress=False)
    assert ds.kx.dims == ("angle", "frequency")
    assert not ds.kx.values[0].any()
