"""Particle velocity and intensity: against an independent oracle, against slopes of p, and by what physics asks of them."""

import warnings

import numpy as np
import pytest
from oracles import open_flow, plane_wave_flow

import beamprop as bp

F = 2500.0
W = 2 * np.pi * F
FLOW = ("p", "v_x", "v_z", "intensity", "power_through")
LIGHT, HEAVY = bp.Fluid(1.25, 1.25 * 343.0**2), bp.Fluid(3.0, 3.0 * 250.0**2)
LOSSY = bp.Fluid(2.0 + 0.3j, (1.1 - 0.2j) * 1e5)
LATERAL = bp.Fluid(2.0, 1.5e5, density_x=5.0 + 0.5j)
STIFF = bp.Fluid(0.7, 1.5e5, density_x=np.inf)
WATER = bp.Fluid(1000.0, 2.19e9)


def layers(*pairs, **half_spaces):
    return bp.Slab([bp.Layer(fluid, d) for fluid, d in pairs], **half_spaces)


SLABS = {
    "lossless layers": layers((HEAVY, 0.021), (LIGHT, 0.013), (HEAVY, 0.034)),
    "periods": bp.Slab([bp.Layer(HEAVY, 0.007), bp.Layer(LIGHT, 0.004)], periods=6),
    "the paper's cell": bp.Slab(bp.lmmd_cell(), periods=5),
    "the paper's cell, lossless": bp.Slab(bp.lmmd_cell(rho_m=0.05, delta_rho=0.0), periods=4),
    "loss, and another density along x": layers((LOSSY, 0.02), (LATERAL, 0.03)),
    "no motion along x": bp.Slab.uniform(STIFF, 0.06),
    "water behind": layers((HEAVY, 0.02), after=WATER),
    "nothing moves along x behind": layers((HEAVY, 0.02), after=STIFF),
    "a membrane between layers": bp.Slab(
        [bp.Layer(HEAVY, 0.02), bp.Membrane(0.05), bp.Layer(LIGHT, 0.01), bp.Membrane(0.02 + 0.01j)]
    ),
}


def depths(slab):
    """In front, on the faces, in each layer, and behind."""
    L = slab.thickness
    return np.array([-0.06, -0.01, 0.0, *(L * np.array([0.03, 0.31, 0.47, 0.77, 0.96])), L, L + 0.03])


@pytest.mark.parametrize("name", SLABS)
def test_against_matrices_from_face_to_face(name):
    """p, v_x and v_z of a narrow oblique beam, everywhere: 2 x 2 matrices and the trapezoid rule on a bent contour."""
    slab, beam = SLABS[name], bp.GaussianBeam(0.12, angle=25, z0=-0.07)
    x, z = np.linspace(-0.3, 0.35, 14), depths(slab)
    ds = bp.field(slab, beam, F, x, z, rtol=1e-10, variables=FLOW)
    k0 = W / 343.0
    expected = open_flow(slab, F, lambda k: beam.spectrum(k, k0), beam.z0, x, z)
    for variable, wanted in zip(("p", "v_x", "v_z"), expected, strict=True):
        largest = np.abs(wanted).max(axis=1, keepdims=True)
        wrong = np.abs(ds[variable].values - wanted) / np.where(largest > 0, largest, 1)
        assert np.max(wrong) < 1e-9, (variable, wrong.max(axis=1))
    p, v_x, v_z = expected
    for variable, v in (("intensity_x", v_x), ("intensity_z", v_z)):
        scale = np.abs(p).max(axis=1, keepdims=True) * np.abs(v).max(axis=1, keepdims=True) / 2
        wrong = np.abs(ds[variable].values - (p * v.conj()).real / 2)
        assert np.max(wrong / np.where(scale > 0, scale, 1)) < 2e-9, variable
    for name in ("v_x", "v_z", "intensity_x", "intensity_z", "power_through"):
        assert float(ds[f"error_estimate_{name}"]) <= 1e-10


SAMPLES = np.linspace(-0.2, 0.2, 41)
SOURCES = {
    "rotated": bp.GaussianBeam(0.15, angle=30, z0=-0.05, form="rotated"),
    "slits": bp.Slits(0.03, 0.09, z0=-0.02),
    "a profile": bp.Profile(SAMPLES, np.exp(-((SAMPLES / 0.06) ** 2) + 20j * SAMPLES), z0=-0.03),
    "off the axis": bp.GaussianBeam(0.1, angle=-15, x0=3.0, z0=-0.05),
}
#: A layer of negative density guides a backward wave, whose pole lies on the other side of the contour.
BACKWARD = layers((bp.Fluid(-0.5 * 1.25, 1.25 * 343.0**2), 0.01))


def slopes(slab, beam, x, z, step=2e-4, **more):
    """v_x and v_z by six-point differences of p at places whose fluid has density 1.25, and those of the dataset."""
    weights = np.array([-1, 9, -45, 45, -9, 1]) / (60 * step)
    off = step * np.array([-3, -2, -1, 1, 2, 3])
    by_x = bp.field(slab, beam, F, np.add.outer(x, off).ravel(), z, rtol=1e-12, **more).p
    by_z = bp.field(slab, beam, F, x, np.add.outer(z, off).ravel(), rtol=1e-12, **more).p
    lead = by_x.shape[:-2]
    v_x = by_x.values.reshape(*lead, z.size, x.size, 6) @ weights / (1j * W * 1.25)
    v_z = np.moveaxis(by_z.values.reshape(*lead, z.size, 6, x.size), -2, -1) @ weights / (1j * W * 1.25)
    ds = bp.field(slab, beam, F, x, z, rtol=1e-10, variables=("v_x", "v_z"), **more)
    return (v_x, ds.v_x.values), (v_z, ds.v_z.values)


def held(pairs):
    for wanted, got in pairs:
        assert np.max(np.abs(got - wanted)) < 1e-7 * np.max(np.abs(wanted))


@pytest.mark.parametrize("name", SOURCES)
@pytest.mark.filterwarnings("ignore::beamprop.AccuracyWarning")  # of p at rtol 1e-12
def test_slopes_of_the_pressure(name):
    """Every kind of source, one of them far from x = 0, in front of layers and behind them."""
    beam = SOURCES[name]
    x, z = beam.centre + np.linspace(-0.2, 0.25, 9), np.array([-0.005, 0.09])
    held(slopes(SLABS["lossless layers"], beam, x, z))


@pytest.mark.filterwarnings("ignore::beamprop.AccuracyWarning")
def test_slopes_beside_a_backward_mode():
    """Its residue belongs to the velocity too; without it the field is percents off."""
    held(slopes(BACKWARD, bp.GaussianBeam(0.03, z0=-0.01), np.linspace(-0.1, 0.13, 9), np.array([-0.003, 0.015])))


@pytest.mark.filterwarnings("ignore::beamprop.AccuracyWarning")
def test_slopes_of_many_angles_and_of_a_period():
    """Angles that are interpolated, and the plain sum of a periodic array of beams."""
    x, z = np.linspace(-0.2, 0.25, 6), np.array([-0.005, 0.09])
    beam = bp.GaussianBeam(0.1, z0=-0.05)
    held(slopes(SLABS["lossless layers"], beam, x, z, angle=np.linspace(-25, 25, 60)))
    held(slopes(SLABS["lossless layers"], beam, x, z, boundary="periodic", period=2.0))


def test_interfaces():
    """v_z is continuous; v_x jumps by the ratio of densities, and on the interface itself is that of the medium behind it."""
    slab = SLABS["periods"]
    cell = slab.cell.thickness
    for face, rho in (
        (0.0, (1.25, 3.0)),
        (2 * cell, (1.25, 3.0)),
        (3 * cell + 0.007, (3.0, 1.25)),
        (6 * cell, (1.25, 1.25)),
    ):
        z = face + 1e-9 * np.array([-1, 0, 1])
        ds = bp.field(slab, bp.GaussianBeam(0.1, angle=20, z0=-0.02), F, [0.01, 0.02], z, variables=("v_x", "v_z"))
        np.testing.assert_allclose(np.diff(ds.v_z.values, axis=0), 0, atol=1e-6 * np.abs(ds.v_z).max())
        np.testing.assert_allclose(ds.v_x[0] * rho[0], ds.v_x[2] * rho[1], rtol=1e-6)
        np.testing.assert_allclose(ds.v_x[1], ds.v_x[2], rtol=1e-6)


def test_a_membrane_and_a_wall():
    """v_z passes a membrane while p jumps by i w mass v_z; fluid without mass flows where p is zero, and nothing flows behind it."""
    slab = bp.Slab([bp.Layer(HEAVY, 0.02), bp.Membrane(0.05), bp.Layer(LIGHT, 0.01)])
    beam, x = bp.GaussianBeam(0.1, angle=20, z0=-0.02), np.array([0.01, 0.02])
    ds = bp.field(slab, beam, F, x, [0.02 - 1e-10, 0.02 + 1e-10], variables=("p", "v_z"))
    np.testing.assert_allclose(ds.v_z[0], ds.v_z[1], rtol=1e-6)
    np.testing.assert_allclose(ds.p[1] - ds.p[0], 1j * W * 0.05 * ds.v_z[0], rtol=1e-6)
    wall = layers((HEAVY, 0.02), (bp.Fluid(0.0, 1e5), 0.03), (HEAVY, 0.02))
    # the last place of a depth 1e-12 before a face changes v_z there by 2e-5
    ds = bp.field(wall, beam, F, x, [0.02, 0.03, 0.04, 0.05 - 1e-12, 0.06], variables=FLOW, rtol=1e-4)
    assert np.all(ds.p == 0)
    assert np.all(ds.intensity_z == 0)
    assert np.abs(ds.power_through).max() == 0
    size = np.abs(ds.v_z).max("x").values
    assert np.all(size[:3] > 0)
    assert size[3] < 1e-9 * size[2]
    assert size[4] == 0
    # potential flow between a driven face and a rigid one: v_z is sinh, v_x = -i kx/|kx| cosh of what is left to the far face
    z = np.linspace(0.02, 0.05, 7)[1:-1]
    h = 1e-5
    around = bp.field(
        wall, beam, F, np.concatenate([x - h, x + h]), np.add.outer(z, [-h, 0, h]).ravel(), variables=("v_x", "v_z")
    )
    v_x, v_z = (around[n].values.reshape(z.size, 3, 2, 2) for n in ("v_x", "v_z"))
    divergence = (v_x[:, 1, 1] - v_x[:, 1, 0] + (v_z[:, 2] - v_z[:, 0]).mean(axis=1)) / (2 * h)
    assert np.abs(divergence).max() < 1e-4 * np.abs(v_x[:, 1, 1] - v_x[:, 1, 0]).max() / (2 * h)


# --- intensity and power ----------------------------------------------------------------------------------

G, V = np.polynomial.legendre.leggauss(24)


def gauss(edges):
    """Nodes and weights of Gauss panels."""
    half = np.diff(edges)[:, None] / 2
    return (np.asarray(edges)[:-1, None] + half * (1 + G)).ravel(), (half * V).ravel()


def flux_out_of_box(slab, beam, x, z_edges):
    """The integral of the intensity over the rim of a box, whose sides pass interfaces at z_edges, and the sum of its sizes."""
    x_nodes, x_weights = gauss(np.linspace(*x, 5))
    z_nodes, z_weights = gauss(z_edges)
    ends = bp.field(slab, beam, F, x_nodes, [z_edges[0], z_edges[-1]], rtol=1e-12, variables="intensity_z")
    sides = bp.field(slab, beam, F, list(x), z_nodes, rtol=1e-12, variables="intensity_x")
    parts = [*(ends.intensity_z.values @ x_weights), *(z_weights @ sides.intensity_x.values)]
    return parts[1] - parts[0] + parts[3] - parts[2], np.sum(np.abs(parts))


BOXES = {
    "lossless layers": (SLABS["lossless layers"], [-0.01, 0.0, 0.021, 0.034, 0.05]),
    "periods": (SLABS["periods"], [0.011, 0.018, 0.022, 0.029, 0.033]),
    "behind and in water": (SLABS["water behind"], [0.01, 0.02, 0.05]),
    "negative density": (BACKWARD, [-0.004, 0.0, 0.01, 0.02]),
}


@pytest.mark.parametrize("name", BOXES)
@pytest.mark.filterwarnings("ignore::beamprop.AccuracyWarning")  # rtol 1e-12 asks for the last bits
def test_intensity_has_no_sources(name):
    """Without loss what flows into a box across interfaces flows out of it, to rounding."""
    slab, edges = BOXES[name]
    net, size = flux_out_of_box(slab, bp.GaussianBeam(0.1, angle=20, z0=-0.02), (-0.05, 0.09), edges)
    assert abs(net) < 1e-12 * size


@pytest.mark.filterwarnings("ignore::beamprop.AccuracyWarning")
def test_intensity_ends_where_it_is_absorbed():
    """With loss a box takes in w/2 (Im rho_x |v_x|^2 + Im rho_z |v_z|^2 + Im(1/K) |p|^2) of its area."""
    slab, beam, x = SLABS["loss, and another density along x"], bp.GaussianBeam(0.1, angle=20, z0=-0.02), (-0.05, 0.09)
    edges = [0.004, 0.02, 0.041]
    net, size = flux_out_of_box(slab, beam, x, edges)
    x_nodes, x_weights = gauss(np.linspace(*x, 5))
    absorbed = 0.0
    for fluid, part in ((LOSSY, edges[:2]), (LATERAL, edges[1:])):
        z_nodes, z_weights = gauss(part)
        ds = bp.field(slab, beam, F, x_nodes, z_nodes, rtol=1e-12, variables=("p", "v_x", "v_z"))
        rho_z, rho_x, K = (complex(v) for v in fluid.at(F))
        losses = ((rho_x, ds.v_x), (rho_z, ds.v_z), (1 / K, ds.p))
        density = W / 2 * sum(value.imag * np.abs(of.values) ** 2 for value, of in losses)
        absorbed += z_weights @ density @ x_weights
    assert absorbed > 0.05 * size
    assert abs(net + absorbed) < 1e-12 * size


@pytest.mark.parametrize(
    "beam", [bp.GaussianBeam(0.1, angle=35, z0=-0.03), SOURCES["rotated"], SOURCES["slits"]], ids=repr
)
@pytest.mark.parametrize("name", ["lossless layers", "periods", "the paper's cell, lossless", "water behind"])
def test_power_is_the_same_through_all_planes(name, beam):
    """Without loss; to rounding."""
    slab = SLABS[name]
    z = [beam.z0, *depths(slab)[1:]]
    ds = bp.field(slab, beam, F, 0.0, z, variables="power_through")
    np.testing.assert_allclose(ds.power_through, ds.power_through[-1], rtol=1e-12)
    assert float(ds.error_estimate_power_through) < 1e-12


@pytest.mark.parametrize(
    "name", ["the paper's cell", "lossless layers", "loss, and another density along x", "water behind"]
)
def test_power_is_the_share_of_beam_measures(name):
    """Behind the slab, over what the beam carries where there is no slab."""
    slab = SLABS[name]
    beam = bp.GaussianBeam(0.3, angle=[0, 30][name != "water behind"], z0=-0.03)
    through = float(bp.field(slab, beam, F, 0.0, slab.thickness + 0.2, variables="power_through").power_through)
    alone = float(bp.field(bp.Slab.uniform(bp.AIR, 0.01), beam, F, 0.0, 0.1, variables="power_through").power_through)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # of windows
        share = bp.beam_measures(slab, beam, F).power.sel(side="transmitted")
    np.testing.assert_allclose(through / alone, float(share), rtol=1e-9)
    # of an incident Gaussian on paper: (1/4 pi) integral |S|^2 cos/(rho c) dkx
    k0 = W / 343.0
    alpha, weight = gauss(np.linspace(-np.pi / 2, np.pi / 2, 80))
    spectrum = np.abs(beam.spectrum(k0 * np.sin(alpha), k0)) ** 2
    on_paper = spectrum @ (weight * k0 * np.cos(alpha) ** 2) / (4 * np.pi * 1.25 * 343.0)
    np.testing.assert_allclose(alone, on_paper, rtol=1e-12)


def test_power_is_the_integral_of_the_intensity():
    """Of an array of beams over its period to rounding, with and without loss; of a single beam over a wide window."""
    slab, z = SLABS["the paper's cell"], [-0.02, 0.0, 0.004, 0.03]
    x = np.linspace(-1, 1, 256, endpoint=False)
    beam = bp.GaussianBeam(0.1, angle=20, z0=-0.02)
    ds = bp.field(slab, beam, F, x, z, boundary="periodic", variables=("intensity_z", "power_through"))
    np.testing.assert_allclose(ds.intensity_z.sum("x") * (x[1] - x[0]), ds.power_through, rtol=1e-12)
    wide = np.linspace(
        -4, 4, 1601
    )  # of a beam so broad that little of it is near grazing, where the slab guides a mode for a hundred metres
    ds = bp.field(
        slab, bp.GaussianBeam(0.4, angle=20, z0=-0.02), F, wide, z, variables=("intensity_z", "power_through")
    )
    np.testing.assert_allclose(ds.intensity_z.integrate("x"), ds.power_through, rtol=1e-8)


def test_evanescent_waves_count_near_a_source_in_a_medium_with_loss():
    """As far out as they have not decayed on the plane, a fifth of a millimetre behind a slit."""
    lossy = bp.Fluid(1000.0, 1000.0 * 1500.0**2 * (1 - 0.1j))
    slab, source = bp.Slab.uniform(lossy, 0.01, background=lossy), bp.Slits(0.004, 0.02, 1, z0=-0.03)
    omega, z = 2 * np.pi * 0.2e6, [-0.0298, -0.0295, -0.02, 0.03]
    square = omega**2 * 1000.0 / lossy.bulk_modulus
    k, weight = gauss(np.concatenate([np.linspace(0, 3000, 200), 3000 + np.geomspace(1, 2e5, 400)]))
    kz = np.sqrt(square - k**2)
    launched = 2 * (2 * np.sin(k * 0.002) / k) ** 2 * (kz / (omega * 1000.0)).real / (4 * np.pi)
    known = [launched * np.exp(-2 * kz.imag * (v + 0.03)) @ weight for v in z]
    ds = bp.field(slab, source, 0.2e6, 0.0, z, variables="power_through")
    np.testing.assert_allclose(ds.power_through, known, rtol=1e-8)


def test_what_a_lossy_slab_absorbs_is_missing_behind_it():
    """Evanescent waves that it draws from a source nearby count: power in front exceeds the incident one less the reflected one."""
    slab, source = SLABS["the paper's cell"], bp.Slits(0.02, 0.05, z0=-0.005)
    front, behind = bp.field(slab, source, F, 0.0, [-0.001, 0.1], variables="power_through").power_through.values
    k0 = W / 343.0
    # panels graded towards grazing and towards the mode that the slab guides; evanescent waves die by exp(-0.01 kx)
    mode = float(bp.guided_modes(slab, F).kx[0].real)
    off = np.geomspace(1e-9, 0.9, 60)
    around = [at + sign * size * off for at, size in ((k0, k0), (mode, mode - k0)) for sign in (1, -1)]
    k, weight = gauss(np.unique(np.concatenate([[0.0, k0, mode], *around, np.linspace(2 * k0, 6000, 60)])))
    p, _, v_z = plane_wave_flow(slab, F, k, source.z0, [-0.001])[:, 0]
    launched = np.abs(source.spectrum(k + 0j, k0)) ** 2 + np.abs(source.spectrum(-k + 0j, k0)) ** 2
    np.testing.assert_allclose(front, launched * (p * v_z.conj()).real @ weight / (4 * np.pi), rtol=1e-9)
    assert 0 < behind < front
