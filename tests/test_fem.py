"""Full-wave finite elements against exact per-order solutions at the same period, and against themselves."""

import ast
import dataclasses
import os
import pathlib
import sys
import warnings

import numpy as np
import pytest
from fem_reference import periodic_field, relative_error

from beamprop import fem
from beamprop.fem import solvers, strip
from beamprop.io.datasets import provenance
from beamprop.media.fluids import AIR, Fluid
from beamprop.media.lmmd import lmmd_cell
from beamprop.media.structures import Cell, Layer, Membrane, Slab
from beamprop.sources.gaussian import GaussianBeam
from beamprop.sources.profile import Profile
from beamprop.sources.slits import Slits

FREQUENCY = 2500.0
WAVELENGTH = 343.0 / FREQUENCY
PERIOD = 6.3 * WAVELENGTH
BEAM = GaussianBeam(0.096, angle=45, z0=-0.1)
WATER = Fluid.from_speed(1000.0, 1480.0)
K_AIR = AIR.bulk_modulus


def grid(slab, beam, period=PERIOD, n_x=301, n_z=41):
    """Positions that share no step with the mesh, from the launch plane to behind the slab."""
    return np.linspace(-period / 2, period / 2, n_x), np.linspace(beam.z0, slab.thickness + 0.1, n_z)


def error(slab, beam, period=PERIOD, frequency=FREQUENCY, **settings):
    """Relative L2 error over all three regions, and the dataset."""
    x, z = grid(slab, beam, period)
    ds = fem.field(slab, beam, frequency, x, z, period, **settings)
    exact = periodic_field(slab, beam, frequency, x, z, period, 80)
    assert ds.residual < 1e-10
    return relative_error(ds.p.values, exact), ds


# --- against the exact solution ---------------------------------------------------------------------------


@pytest.mark.parametrize(("cell", "angle"), [(lmmd_cell(0.05, 0), 45), (lmmd_cell(), 0), (lmmd_cell(), 85)])
def test_twenty_periods_of_the_papers_slab(cell, angle):
    found, ds = error(Slab(cell, 20), GaussianBeam(0.096, angle=angle, z0=-0.1), elements_x=32)
    assert found < 3e-4
    assert ds.p.dims == ("z", "x")
    assert ds.dofs == (3 * 200 + 1) * 96


CASES = [(lossless, angle) for lossless in (True, False) for angle in (0, 45, 85)]


@pytest.mark.parametrize(("lossless", "angle"), CASES if os.environ.get("BEAMPROP_FULL") else [(True, 85)])
def test_the_papers_slab_in_full(lossless, angle):
    """450 periods; one of the six cases, or all with BEAMPROP_FULL=1 in the environment (half a minute)."""
    slab = Slab(lmmd_cell(0.05, 0) if lossless else lmmd_cell(), 450)
    beam, period = GaussianBeam(0.096, angle=angle, z0=-0.1), 16.3 * WAVELENGTH
    assert fem.plan(slab, beam, FREQUENCY, period).memory < 1e9
    found, ds = error(slab, beam, period)
    assert found < 1e-3
    if os.environ.get("BEAMPROP_FULL"):  # a time says something on an idle machine only
        assert ds.seconds < 20


def slabs_off_the_paper():
    anisotropic = Layer(Fluid(3.0 + 0.1j, K_AIR, density_x=0.7 + 0.02j), 0.03)
    no_motion_along_x = Layer(Fluid(0.7 + 0.05j, K_AIR, density_x=np.inf), 0.1)
    dispersive = Layer(Fluid(lambda f: 1.25 * (1 - (2000 / f) ** 2) + 0.2j, lambda f: K_AIR * (f / 2000)), 0.08)
    membrane = Cell((Membrane(0.02 + 0.001j), Layer(Fluid(2.0, K_AIR), 0.02), Membrane(0.05)))
    antisymmetric = Cell((Membrane(-0.01), Layer(Fluid(0.7, K_AIR, density_x=np.inf), 0.1), Membrane(0.01)))
    return {
        "N = 6": Slab(lmmd_cell(n_layers=6), 10),
        "N = 14": Slab(lmmd_cell(n_layers=14), 10),
        "eta = 1/40": Slab(lmmd_cell(eta=1 / 40), 10),
        "water behind": Slab(lmmd_cell(), 10, after=WATER),
        "stack of two cells": Slab(lmmd_cell(), 7) + Slab(lmmd_cell(n_layers=6, eta=1 / 40), 5, after=WATER),
        "anisotropic": Slab([anisotropic], 2),
        "no motion along x": Slab([no_motion_along_x]),
        "dispersive": Slab([dispersive]),
        "one thick layer": Slab.uniform(Fluid.from_speed(2.0, 500.0), 0.4),
        "a wavelength of air": Slab.uniform(AIR, WAVELENGTH),
        "opaque": Slab.uniform(Fluid(-6.0, K_AIR), 0.15),
        "thirty different layers": Slab([Layer(Fluid(5 * np.cos(j) + 0.2j, K_AIR), 0.002) for j in range(30)]),
        "membranes": Slab(membrane, 3),
        "a membrane of negative mass": Slab(antisymmetric),
        "lossy half-space in front": Slab([anisotropic], before=Fluid(1.25 + 0.05j, K_AIR)),
    }


@pytest.mark.parametrize("name", slabs_off_the_paper())
def test_any_slab(name):
    found, _ = error(slabs_off_the_paper()[name], BEAM)
    assert found < 5e-4


def test_one_row_of_a_membrane_without_mass_is_nothing():
    bare, x, z = Slab.uniform(Fluid(2.0, K_AIR), 0.02), np.linspace(-0.3, 0.3, 7), np.linspace(-0.05, 0.05, 5)
    clad = Slab(Cell((Membrane(0.0), *bare.cell.layers)))
    a, b = (fem.field(s, BEAM, FREQUENCY, x, z, PERIOD, order=2).p.values for s in (bare, clad))
    np.testing.assert_array_equal(a, b)


def oblique_profile():
    x = np.linspace(-0.3, 0.3, 121) + 0.05
    return Profile(x, np.exp(-(((x - 0.05) / 0.08) ** 2)) * (1 + 0.5 * np.sin(20 * x)), z0=-0.05, angle=30)


@pytest.mark.parametrize(
    "beam",
    [
        oblique_profile(),
        GaussianBeam(0.096, angle=-30, x0=0.31, z0=-0.02),
        GaussianBeam(0.096, angle=30, z0=-0.05, form="rotated"),
    ],
)
def test_any_beam(beam):
    found, _ = error(Slab(lmmd_cell(), 10), beam)
    assert found < 5e-4


def test_order_four_and_another_angle_and_frequency():
    found, ds = error(Slab(lmmd_cell(), 10), BEAM.at_angle(0), frequency=2200.0, order=4)
    assert found < 5e-4
    x, z = grid(Slab(lmmd_cell(), 10), BEAM)
    again = fem.field(Slab(lmmd_cell(), 10), BEAM, 2200.0, x, z, PERIOD, angle=0, order=4)
    np.testing.assert_array_equal(again.p, ds.p)
    assert (float(again.angle), float(again.frequency)) == (0.0, 2200.0)


@pytest.mark.parametrize(("order", "elements_x"), [(1, (126, 252)), (2, (63, 126)), (3, (32, 64))])
def test_the_error_falls_with_order_plus_one(order, elements_x):
    """Layers as thick as the elements, densities of both signs; both sizes halved."""
    slab = Slab([Layer(Fluid(2.5 + 0.1j, K_AIR), 0.02), Layer(Fluid(-1.0 + 0.1j, K_AIR), 0.02)])
    beam = GaussianBeam(0.096, angle=20, z0=-0.1)
    rows = {1: (8, 16), 2: (4, 8), 3: (2, 4)}[order]
    coarse, fine = (
        error(slab, beam, order=order, elements_x=n, layer_rows=m)[0] for n, m in zip(elements_x, rows, strict=True)
    )
    assert np.log2(coarse / fine) == pytest.approx(order + 1, abs=0.3)


# --- against itself ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "slab",
    [
        Slab(lmmd_cell(0.05, 0), 20),
        Slab(lmmd_cell(), 3) + Slab(Cell((Membrane(0.05), Layer(Fluid(2.0, K_AIR), 0.02))), 2, after=WATER),
    ],
)
def test_both_solvers_agree(slab):
    x, z = grid(slab, BEAM)
    a, b = (fem.field(slab, BEAM, FREQUENCY, x, z, PERIOD, method=m) for m in ("superelement", "sparse"))
    assert max(a.residual, b.residual) < 1e-10
    assert relative_error(a.p.values, b.p.values) < 1e-10
    assert a.dofs == b.dofs


def test_the_residual_sees_a_wrong_solution():
    mesh = strip.make_strip(PERIOD, 0.0, 2, 16)
    segments = strip.slab_rows(Slab(lmmd_cell(), 3), FREQUENCY, 50.0, 2)
    rows = strip.layout(segments, 2)
    n = mesh.n
    from beamprop.fem.boundary import Ends

    ends = Ends(1j * np.eye(n), 1j * np.eye(n), np.ones(n, complex), np.eye(n), 1.0)
    p = solvers.superelement(mesh, segments, rows, ends, 1.0, lambda steps: None)
    assert solvers.residual(mesh, rows, ends, 1.0, p) < 1e-10
    p[rows.lines // 2, 5] *= 1 + 1e-6
    assert solvers.residual(mesh, rows, ends, 1.0, p) > 1e-9


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_a_rows_matrices_integrate_a_plane(order):
    """u = 1 + z on [0, 3] x [0, 1]: integral of u^2 = 7, of u_x^2 = 0, of u_z^2 = 3."""
    mesh = strip.make_strip(3.0, 0.0, order, 5)
    vertex = np.arange(mesh.n) % order == 0
    one = np.ones(mesh.n) if order == 2 else vertex.astype(float)  # order 2 has nodes, orders 3 and 4 have bubbles
    u = np.concatenate([one, *([1.5 * one] if order == 2 else [0 * one] * (order - 1)), 2 * one])
    assert u @ mesh.mass @ u == pytest.approx(7)
    assert u @ mesh.stiffness_x @ u == pytest.approx(0, abs=1e-12)
    assert u @ mesh.stiffness_z @ u == pytest.approx(3)
    assert one @ mesh.line_mass @ one == pytest.approx(3)


def test_every_layer_face_is_a_mesh_line():
    slab = Slab(lmmd_cell(), 3) + Slab.uniform(Fluid(2.0, K_AIR), 0.3) + Slab(lmmd_cell(n_layers=6), 2)
    rows = strip.layout(strip.slab_rows(slab, FREQUENCY, 50.0, 3), 3)
    faces = np.cumsum([layer.thickness for cell, n in slab.segments for _ in range(n) for layer in cell.layers])
    lines = np.append(rows.near, slab.thickness)
    assert np.abs(lines[:, None] - faces).min(axis=0).max() < 1e-15
    assert len(lines) > len(faces) + 5  # the thick layer is divided


def test_the_field_repeats_and_is_continuous_at_the_faces():
    slab = Slab(lmmd_cell(), 5)
    x = np.linspace(-0.2, 0.2, 5)
    faces = np.array([0.0, slab.thickness])
    z = np.sort(np.concatenate([faces, faces + 1e-9, faces - 1e-9]))
    ds = fem.field(slab, BEAM, FREQUENCY, np.concatenate([x, x + 3 * PERIOD]), z, PERIOD)
    p = ds.p.values
    np.testing.assert_allclose(p[:, :5], p[:, 5:], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(p[:3], p[:3].mean(0) * np.ones((3, 1)), atol=1e-4)
    np.testing.assert_allclose(p[3:], p[3:].mean(0) * np.ones((3, 1)), atol=1e-4)


def test_the_dataset_records_its_making():
    slab = Slab(lmmd_cell(), 2)
    ds = fem.field(slab, BEAM, FREQUENCY, np.array([0.0]), np.array([0.0]), PERIOD, progress=True)
    record = provenance(ds)
    assert (record["question"], record["slab"], record["beam"]) == ("fem.field", slab, BEAM)
    assert (ds.boundary, ds.period, ds.order, ds.method) == ("periodic", PERIOD, 3, "superelement")
    assert (ds.elements_x, ds.elements_z) == (32, 20)
    assert ds.p.units == "Pa"
    assert ds.seconds > 0


# --- warnings and refusals --------------------------------------------------------------------------------

ONE = (np.array([0.0]), np.array([0.0]))


def test_an_order_on_kz_0_is_warned_about():
    with pytest.warns(UserWarning, match=r"6 wavelengths of the medium before .* order -6 at \|kz\|"):
        fem.field(Slab(lmmd_cell(), 2, after=WATER), BEAM, FREQUENCY, *ONE, 6 * WAVELENGTH)
    water = 1480.0 / FREQUENCY
    with pytest.warns(UserWarning, match=r"medium after"):
        fem.field(Slab(lmmd_cell(), 2, after=WATER), BEAM, FREQUENCY, *ONE, 2 * water)


def test_an_order_beside_a_guided_mode_is_warned_about():
    # orders +10 and -10 are alike; rounding, and with it the version of the solver, says which is the larger
    with pytest.warns(UserWarning, match=r"order [-+]10 at kx = -?1\.59.* k0 lies beside a guided mode"):
        fem.field(Slab(lmmd_cell(0.05, 0), 20), BEAM, FREQUENCY, *ONE, 6.258 * WAVELENGTH)


def test_a_narrow_window_is_warned_about_and_a_narrower_one_refused():
    slab = Slab(lmmd_cell(), 2)
    with pytest.warns(UserWarning, match=r"period: the beam has 0\.0\d+ of its largest pressure"):
        fem.field(slab, BEAM, FREQUENCY, *ONE, 1.7 * WAVELENGTH)
    with pytest.raises(ValueError, match=r"period: expected a window that holds the beam; the beam has 0\.\d+"):
        fem.field(slab, BEAM, FREQUENCY, *ONE, 0.7 * WAVELENGTH)


def test_a_mesh_that_leaves_out_much_of_the_beam_is_warned_about():
    with pytest.warns(UserWarning, match=r"elements_x: 12 elements of order 1 leave out .* of the beam"):
        fem.field(Slab(lmmd_cell(), 2), Slits(0.03, 0.08), FREQUENCY, *ONE, PERIOD, order=1, elements_x=12)


def test_the_default_mesh_follows_wavelength_order_and_beam():
    slab = Slab(lmmd_cell(), 2)
    sizes = [fem.plan(slab, BEAM, FREQUENCY, PERIOD, order=p).elements_x for p in (1, 2, 3, 4)]
    assert sizes == [126, 63, 32, 22]
    narrow = GaussianBeam(0.02)
    assert 32 < fem.plan(slab, narrow, FREQUENCY, PERIOD).elements_x <= 64


def test_too_large_a_problem_is_refused_with_its_numbers():
    slab = Slab(lmmd_cell(), 450)
    found = fem.plan(slab, BEAM, FREQUENCY, PERIOD, method="sparse")
    assert found.dofs == 96 * (3 * 4500 + 1)
    assert found.elements_z == 4500
    assert fem.plan(slab, BEAM, FREQUENCY, PERIOD).memory < found.memory
    with pytest.raises(dataclasses.FrozenInstanceError):
        found.dofs = 1
    with pytest.raises(ValueError, match=rf"memory_limit: expected at least .* bytes for {found.dofs} unknowns"):
        fem.field(slab, BEAM, FREQUENCY, *ONE, PERIOD, method="sparse", memory_limit=found.memory - 1)


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("slab", {"slab": lmmd_cell()}),
        ("slab", {"slab": Slab([Layer(Fluid(0.0, K_AIR), 0.01)])}),
        ("slab", {"slab": Slab([Layer(Fluid(0.0, K_AIR, density_x=1.0), 0.01)])}),
        ("slab", {"slab": Slab(lmmd_cell(), before=Fluid(1.25, K_AIR, density_x=np.inf))}),
        ("beam", {"beam": 0.096}),
        ("frequency", {"frequency": 0.0}),
        ("frequency", {"frequency": np.array([1.0, 2.0])}),
        ("x", {"x": 0.0}),
        ("x", {"x": np.array([np.nan])}),
        ("z", {"z": np.array([])}),
        ("z", {"z": np.array([-0.2])}),
        ("period", {"period": -1.0}),
        ("angle", {"angle": 90.0}),
        ("order", {"order": 5}),
        ("elements_x", {"elements_x": 2.5}),
        ("layer_rows", {"layer_rows": 0}),
        ("method", {"method": "magic"}),
        ("memory_limit", {"memory_limit": np.nan}),
    ],
)
def test_refusals_name_the_argument(name, change):
    arguments = {
        "slab": Slab(lmmd_cell(), 2),
        "beam": BEAM,
        "frequency": FREQUENCY,
        "x": ONE[0],
        "z": ONE[1],
        "period": PERIOD,
    }
    with pytest.raises(ValueError, match=rf"^{name}: .*"):
        fem.field(**{**arguments, **change})


def test_without_the_library_the_message_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "skfem", None)
    with pytest.raises(ImportError, match=r'pip install -e "\.\[fem\]" in the checkout'):
        fem.field(Slab(lmmd_cell(), 2), BEAM, FREQUENCY, *ONE, PERIOD)


# --- the wall ---------------------------------------------------------------------------------------------


def _imports(path):
    """Modules of the package that a file of beamprop/fem imports, as names below beamprop."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.level == 1:
            yield "fem"
        elif isinstance(node, ast.ImportFrom) and node.level == 2:
            yield from [node.module.split(".")[0]] if node.module else [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith("beamprop"):
            yield node.module
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name.startswith("beamprop"))


def test_the_witness_is_independent_of_the_plane_wave_code():
    allowed = {"fem", "conventions", "memory", "validate", "progress", "media", "sources", "io"}
    files = sorted(pathlib.Path(fem.__file__).parent.glob("*.py"))
    assert len(files) >= 4
    for path in files:
        assert set(_imports(path)) <= allowed, path.name


def test_the_paper_case_raises_no_warning():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        fem.field(Slab(lmmd_cell(0.05, 0), 20), BEAM, FREQUENCY, *ONE, PERIOD)
