"""Studies of the gallery in three dimensions against independent quadratures."""

import csv
import io
import sys
from itertools import product

import numpy as np
import pytest
from conformance.formulas import transducers
from gallery_results import GALLERY, result_of
from scipy.optimize import brentq
from space_oracles import polar_field, round_profile

import beamprop as bp


def table_of(text):
    """Values of the transcranial benchmarks' table by benchmark and source, then by quantity, x and z."""
    table = {}
    for row in csv.DictReader(io.StringIO(text)):
        place = row["quantity"], float(row["x [m]"] or "nan"), float(row["z [m]"] or "nan")
        table.setdefault((row["benchmark"], row["source"]), {})[str(place)] = float(row["value"])
    return table


def shipped_table():
    return table_of((GALLERY / "transcranial_table.csv").read_text(encoding="utf-8"))


def test_the_shipped_table_is_the_study_of_the_transcranial_benchmarks():
    """To a unit of the tenth digit, of points of the largest p among them."""
    shipped, ours = shipped_table(), table_of(result_of("transcranial")["table"])
    assert {case: set(values) for case, values in shipped.items()} == {c: set(v) for c, v in ours.items()}
    assert [len(values) for values in shipped.values()] == 3 * [34] + 3 * [32]
    for case, values in shipped.items():
        largest = max(abs(value) for key, value in values.items() if " p'" in key)
        for key, value in values.items():
            assert abs(ours[case][key] - value) <= 1e-9 * (largest if " p'" in key else value), (case, key)


@pytest.mark.parametrize("case", shipped_table(), ids=" ".join)
def test_ten_digits_of_the_transcranial_benchmarks(case):
    """Against panels of Gauss nodes over the radial wavenumber, admittances of the layers and bisection: nothing of the package."""
    import transcranial as study

    (name, source), tissues = case, study.TISSUES
    spectrum = transducers.piston_spectrum(0.01) if source == "piston" else transducers.bowl_spectrum(0.064, 0.064)
    layers = tuple((tissues[tissue], thickness) for tissue, thickness in study.LAYERS[name])
    half_spaces = tissues["water"], tissues["brain" if name == "BM4" else "water"]
    exact = transducers.Layered(np.pi * 1e6, study.START[name], layers, *half_spaces, spectrum)
    table = shipped_table()[case]

    def value(quantity):
        return table[str((quantity, np.nan, np.nan))]

    middle = exact.peak(0.05, 0.07) if source == "bowl" else 0.06
    level = abs(exact.fields(np.zeros(1), middle)[0][0])
    width = 2 * exact.half(level / 2, (0.001, 0.01), middle)
    known = {"pressure": 60e3 * level, "width": width}
    if source == "bowl":
        ends = [exact.half(level / 2, window) for window in ((0.038, middle), (middle, 0.085))]
        known |= {"position": middle, "length": ends[1] - ends[0]}
    assert {quantity: value(quantity) for quantity in known} == pytest.approx(known, rel=5.1e-10)
    p = 60e3 * np.array([exact.fields(study.X, z)[0] for z in study.Z])
    for (i, z), (j, x) in product(enumerate(study.Z), enumerate(study.X)):
        parts = [table[str((part, float(x), float(z)))] for part in ("Re p", "Im p")]
        assert abs(complex(*parts) - p[i, j]) < 1e-9 * np.abs(p).max()


@pytest.mark.parametrize("name", ["lossless", "lossy", "air"])
def test_round_beams_have_the_widths_of_a_quadrature(name):
    """At the design frequency, by bisection on Gauss panels over the radial wavenumber."""
    import round_beams as study

    slab = study.MEDIA.get(name, bp.Slab.uniform(bp.AIR, 2 * study.WAVELENGTH))
    beam = bp.GaussianBeam((study.FWHM, study.FWHM))

    def above_half(x):
        p = np.abs(round_profile(slab, study.DESIGN, beam, np.array([0.0, x]), [slab.thickness])[0])
        return p[1] / p[0] - 0.5

    widths = result_of("round_beams")["widths"].sel(frequency=study.DESIGN)
    assert float(widths[f"{name}_round" if name != "air" else "air"]) == pytest.approx(
        2 * brentq(above_half, 0.02, 0.3), rel=1e-4
    )


def test_without_loss_round_beams_trail_guided_waves():
    """Where the study has the widest, at 45 degrees: the quadrature's |p| is half its largest value over as many centimetres, to its step."""
    import round_beams as study

    widths = result_of("round_beams")["widths"].lossless_x
    x = np.linspace(-0.1, 0.5, 61)
    slab, beam = study.MEDIA["lossless"], bp.GaussianBeam((study.FWHM, study.FWHM), 45.0)
    p = np.abs(polar_field(slab, float(widths.idxmax()), beam, (x, 0 * x), [slab.thickness], directions=200)[0])
    assert np.ptp(x[p > p.max() / 2]) == pytest.approx(float(widths.max()), abs=0.02)


def test_the_peer_of_the_transcranial_benchmarks_says_what_to_install(monkeypatch):
    import transcranial_peer

    monkeypatch.setitem(sys.modules, "kwave", None)
    with pytest.raises(SystemExit, match=r"pip install k-wave-python"):
        transcranial_peer.k_wave()
