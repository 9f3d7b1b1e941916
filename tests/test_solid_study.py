"""The random study of fields with solids: its reference against many digits and stiffnesses, its modes, and some of its cases."""

import itertools

import accuracy
import mpmath as mp
import numpy as np
import pytest
import solid_oracles
from accuracy_study.cases.numbering import SOLIDS_FROM, make_case, numbers_of
from accuracy_study.cases.solid import SOLID
from accuracy_study.reference import misplaced, quadrature
from accuracy_study.reference.solid_medium import SolidMedium, medium_of
from accuracy_study.study import report

import beamprop as bp

#: Two cases of each class whose truth takes about a second.
QUICK = [SOLIDS_FROM + n for n in (0, 8, 1, 9, 2, 10, 11, 19, 4, 12, 5, 13, 6, 22, 7, 15)]


def layers_of(slab):
    """The oracle's layers of a slab of one segment, and its half-space behind."""

    def numbers(medium):
        rho, *moduli = (complex(v[0]) for v in medium.at(np.array([1e6])) if v is not None)
        if isinstance(medium, bp.Solid):
            return (rho, *(np.sqrt(v / rho) for v in moduli))
        return rho, moduli[-1]

    ((cell, periods),) = slab.segments
    return [(*numbers(v.fluid), v.thickness) for v in cell.layers], periods, numbers(slab.before), numbers(slab.after)


@pytest.mark.parametrize("kind", SOLID)
def test_reflected_and_transmitted_waves_agree_with_many_digits(kind):
    for number in itertools.islice(numbers_of(kind), 4):
        case = make_case(number)
        layers, periods, before, after = layers_of(case.slab)
        if periods * len(layers) > 40:
            continue
        m = SolidMedium(case.slab, case.frequency)
        k = m.k0 * np.array([0.01, 0.45, 0.97, 1.6, 0.4 - 0.1j])
        near, far = m.response(k, np.array([0.0, case.slab.thickness]), 0.0)
        for i, kx in enumerate(k):
            r, t = solid_oracles.response(layers, periods, before, after, case.frequency, kx)
            assert abs(near[i] - 1 - r) < 1e-10 * max(1, abs(r))
            assert abs(far[i] - t) < 1e-9 * abs(t) + 1e-13


@pytest.mark.parametrize("number", [SOLIDS_FROM, SOLIDS_FROM + 8, SOLIDS_FROM + 2, SOLIDS_FROM + 3])
def test_pressure_inside_a_plate_agrees_with_many_digits(number):
    """-s_zz at depths in the plate, from the state behind it: T = 0 on both faces gives X."""
    case = make_case(number)
    ((rho, c_l, c_t, d),), _, before, after = layers_of(case.slab)
    m = SolidMedium(case.slab, case.frequency)
    for kx in (0.2 * m.k0, 0.9 * m.k0, (0.3 - 0.1j) * m.k0):
        _, t = solid_oracles.response([(rho, c_l, c_t, d)], 1, before, after, case.frequency, kx)
        depths = d * np.array([0.1, 0.5, 0.93])
        with mp.workdps(60):
            w, k = mp.mpf(m.omega), mp.mpmathify(kx)
            p, q = mp.mpmathify(t), 1j * solid_oracles._outgoing(*after, w, k) / mp.mpmathify(after[0]) * t
            whole = solid_oracles._solid_back(rho, c_l, c_t, d, w, k)
            far = mp.matrix([p, -(whole[3, 0] * p + whole[3, 2] * q) / whole[3, 1], q, 0])
            exact = [complex((solid_oracles._solid_back(rho, c_l, c_t, d - z, w, k) * far)[0]) for z in depths]
        assert m.response(np.array([kx]), depths, 0.0)[:, 0] == pytest.approx(np.array(exact), rel=1e-9)


def test_two_waves_behind_a_coated_solid_are_continuous_and_decay():
    """p behind the far face is that at the face, and P and S waves leave it: both decay below a real kx beyond their wavenumbers."""
    case = make_case(next(numbers_of("half-space of solid, coated")))
    m = SolidMedium(case.slab, case.frequency)
    d = case.slab.thickness
    k = m.k0 * np.array([0.1, 0.4, 1.2])
    inside, face, behind = m.response(k, np.array([d * (1 - 1e-9), d, d * (1 + 1e-9)]), 0.0)
    assert abs(inside - face).max() < 1e-7 * abs(face).max()
    assert abs(behind - face).max() < 1e-7 * abs(face).max()
    far = m.response(k, np.array([d + 40 * 1480 / case.frequency]), 0.0)[0]
    assert abs(far[2]) < 1e-60


# --- modes ------------------------------------------------------------------------------------------------------


def test_the_backward_modes_of_a_plate_are_located():
    """By the study's own function and by the package's."""
    case = make_case(SOLIDS_FROM + 10)
    s = quadrature.setting(case, np.zeros(1) + case.beam.centre)
    (wrong,), _ = quadrature.misplaced_modes(s)
    ds = bp.guided_modes(case.slab, case.frequency, kx_over_k0_max=1.3, strip_over_k0=0.3, leaky=True)
    (backward,) = ds.kx.values[ds.direction.values < 0]
    assert abs(wrong - backward) < 1e-9 * abs(backward)


def test_modes_close_to_each_other_are_counted():
    """Two resonances of a cell and its copy, 2e-5 k0 apart and 1e-5 k0 above the axis: between samples they turn t by 2 pi."""
    water, steel = bp.Fluid.from_speed(1000.0, 1480.0), bp.Solid(7843.0, 5464.0, 2965.0)
    slab = bp.Slab(
        [bp.Layer(steel, 2.259e-5), bp.Layer(bp.Fluid(790.0, 1.429e9), 5.6548e-4)], 2, before=water, after=water
    )
    m = medium_of(slab, 192_928.0)
    modes = bp.guided_modes(slab, 192_928.0, strip_over_k0=0.05, leaky=True).kx_over_k0.values
    pair = modes[(modes.real < 0.9) & (modes.imag < 1e-3)]
    assert pair.size == 2
    box = [v * m.k0 for v in (0.1 - 0.2j, 0.9 - 0.2j, 0.9 + 0j, 0.1 + 0j)]
    assert misplaced._turns(m, box) == 0
    around = [v * m.k0 for v in (0.1 - 0.2j, 0.9 - 0.2j, 0.9 + 1e-3j, 0.1 + 1e-3j)]
    assert misplaced._turns(m, around) == -2


# --- cases ------------------------------------------------------------------------------------------------------


def test_every_class_is_drawn_and_fluids_keep_their_numbers():
    assert {make_case(SOLIDS_FROM + n).kind for n in range(len(SOLID))} == set(SOLID)
    assert make_case(SOLIDS_FROM - 1).kind not in SOLID
    media = [medium_of(make_case(SOLIDS_FROM + n).slab, 1e6) for n in range(24)]
    assert all(isinstance(m, SolidMedium) for m in media)
    assert {misplaced.is_lossless(m) for m in media} == {True, False}


#: Of lattices: one off by twice rtol on the first plane behind its face, and samples whose rounding passes a band beyond the contour's end.
ONCE_TOO_SURE = [SOLIDS_FROM + 565, SOLIDS_FROM + 45]


@pytest.mark.parametrize("number", [*QUICK, *ONCE_TOO_SURE])
def test_cases_keep_rtol(number):
    """No error above rtol without a warning; no estimate below a third of the error."""
    row = accuracy.compare_with_truth(number)
    assert row["status"] == "answered", row
    error = row["error"] - row["truth_error"]
    assert error <= row["rtol"] or row["warned"], row
    assert error <= 3 * row["estimate"], row
    assert not row["reason"]


def test_backward_poles_beside_the_normal_keep_rtol_without_a_warning():
    """A plate, whose contour ran by one at two steps of its nodes: off by 4e-7 at rtol 2e-10, however wide the window."""
    row = accuracy.compare_with_truth(SOLIDS_FROM + 1353)
    assert not row["warned"]
    assert row["error"] < row["rtol"]


def test_reports_have_a_line_for_each_class():
    text = report.class_table(accuracy_rows(QUICK[:2]))
    assert "| thin plate | 2 | 0 | 0 | 0 | 0 | 0 | 2 | 0 | 0 |" in text


def accuracy_rows(numbers):
    """The study's dataset of some cases, in this process."""
    import xarray as xr

    rows = [accuracy.compare_with_truth(n) for n in numbers]
    keys = [key for key in rows[0] if key != "number"]
    return xr.Dataset({key: ("case", np.array([r[key] for r in rows])) for key in keys}, {"case": numbers})
