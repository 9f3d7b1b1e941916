"""Guided modes against closed forms and against the field; backward modes."""

import numpy as np
import oracles
import pytest

import beamprop as bp
from beamprop.modes import argument_principle, misplaced
from beamprop.modes import guided as guided_modes
from beamprop.response import sampled_slab

F = 2500.0
K0 = 2 * np.pi * F / 343
BULK = bp.AIR.bulk_modulus


def thin(density, thickness, loss=0.0):
    """A uniform slab of relative density, with a relative loss of density and modulus."""
    fluid = bp.Fluid(1.25 * (density + 1j * loss * abs(density)), BULK / (1 + 1j * loss))
    return bp.Slab.uniform(fluid, thickness)


@pytest.mark.parametrize("density", [5.0, 3.0, 12.0])
@pytest.mark.parametrize("thickness", [0.02, 0.1, 0.3])
def test_modes_of_a_dense_slab_are_the_textbook_ones(density, thickness):
    """Even and odd modes: tan(k d/2) = rho kappa/k, -cot(k d/2) = rho kappa/k, counted by their phase."""
    ds = bp.guided_modes(bp.Slab.uniform(bp.Fluid(1.25 * density, BULK), thickness), F, kx_over_k0_max=5)
    kx = ds.kx.values
    assert np.all(np.abs(kx.imag) < 1e-12 * kx.real)
    assert np.all(ds.direction == 1)
    kz, kappa = np.sqrt(density * K0**2 - kx.real**2), np.sqrt(kx.real**2 - K0**2)
    # kz d = m pi + 2 atan(rho kappa / kz), m = 0, 1, ... downwards in kx
    order = (kz * thickness - 2 * np.arctan(density * kappa / kz)) / np.pi
    np.testing.assert_allclose(order[::-1], np.arange(kx.size), atol=1e-7)
    assert kx.size == 1 + int(np.sqrt(density - 1) * K0 * thickness / np.pi)
    assert ds["count"] == kx.size


def test_twenty_lossless_periods_guide_a_mode():
    """Where |t| on the real axis has its pole."""
    slab = bp.Slab(bp.lmmd_cell(0.05, 0.0), 20)
    (mode,) = bp.guided_modes(slab, F).kx_over_k0.values
    with pytest.warns(bp.AccuracyWarning, match="1 of 3 places"):  # on the pole itself rounding decides
        near = bp.scattering(slab, F, kx_over_k0=np.array([mode.real - 1e-5, mode.real, mode.real + 1e-5])).t.values
    assert abs(near[1]) > 1e3 * abs(near[0])
    assert near[0].real * near[2].real < 0 or near[0].imag * near[2].imag < 0


def test_loss_tells_forward_from_backward():
    """A thin layer of relative density -0.6 guides a forward and a backward mode; loss moves them up and down."""
    lossless = bp.guided_modes(thin(-0.6, 0.01), F)
    assert lossless.direction.values.tolist() == [1, -1]
    lossy = bp.guided_modes(thin(-0.6, 0.01, 1e-3), F)
    assert lossy.kx.values[0].imag > 0 > lossy.kx.values[1].imag
    assert lossy.direction.values.tolist() == [1, -1]
    np.testing.assert_allclose(lossy.kx.values.real, lossless.kx.values.real, rtol=1e-3)


@pytest.mark.parametrize("loss", [0.0, 1e-3])
@pytest.mark.parametrize("thickness", [0.13, 0.3])
@pytest.mark.parametrize(("rho", "slowness", "direction"), [(-2.0, 3.0, 1), (-0.88, -4.5, -1)])
def test_modes_of_two_faces_that_do_not_feel_each_other(rho, slowness, direction, thickness, loss):
    """Each face of a negative density carries a wave, kappa + kappa_1/rho = 0; in a thick slab both are one zero, twice."""
    r, s = rho + 1j * loss * abs(rho), slowness + 1j * loss * abs(slowness)
    face = K0 * np.sqrt((1 - s / r) / (1 - 1 / r**2))
    slab = bp.Slab.uniform(bp.Fluid(1.25 * r, BULK / s), thickness)
    ds = bp.guided_modes(slab, F)
    assert ds["count"] == ds.sizes["mode"]
    near = np.abs(ds.kx.values - face) < 1e-5 * abs(face)
    assert near.sum() == 2
    assert np.all(ds.direction.values[near] == direction)


def test_a_cluster_whose_direction_cannot_be_told_is_refused(monkeypatch):
    """By name, as every refusal is."""

    def undecided(*_):
        raise argument_principle.TooManyModes

    monkeypatch.setattr(guided_modes, "_direction", undecided)
    with pytest.raises(ValueError, match="slab: two of its modes"):
        bp.guided_modes(thin(-2.0, 0.3), F)


def test_a_cluster_of_backward_modes_gets_one_circle():
    """The field beside two backward modes that are one zero is the limit of small losses; the search misses neither."""
    beam, x = bp.GaussianBeam(0.02, 20.0), np.linspace(-0.1, 0.1, 21)

    def field(loss):
        fluid = bp.Fluid(1.25 * (-0.88 + 0.88j * loss), BULK / (-4.5 + 4.5j * loss))
        return bp.field(bp.Slab.uniform(fluid, 0.13), beam, F, x, [0.0, 0.05, 0.13, 0.2], rtol=1e-9).p

    limit = field(0.0)
    apart = [float(np.abs(field(loss) - limit).max() / np.abs(limit).max()) for loss in (1e-4, 1e-5, 1e-6)]
    assert apart[0] / apart[1] == pytest.approx(10, rel=0.05)
    assert apart[1] / apart[2] == pytest.approx(10, rel=0.05)
    s = sampled_slab.sample(bp.Slab.uniform(bp.Fluid(1.25 * -0.88, BULK / -4.5), 0.13), F)
    search = misplaced.misplaced(s, 0.3 * K0, 10 * K0, 1e-3 * K0)
    assert len(search.poles) == len(set(search.poles))
    assert any(abs(k - K0 * np.sqrt((1 - 4.5 / 0.88) / (1 - 1 / 0.88**2))) < 1e-6 * K0 for k in search.poles)


def test_frequencies_are_padded():
    """Fewer modes at one frequency than at another: nan, direction 0."""
    slab = bp.Slab.uniform(bp.Fluid(5 * 1.25, BULK), 0.1)
    ds = bp.guided_modes(slab, [500.0, 4000.0])
    assert ds["count"].values[0] < ds["count"].values[1] == ds.sizes["mode"]
    missing = np.isnan(ds.kx.values[0].real)
    assert missing.sum() == ds.sizes["mode"] - ds["count"].values[0]
    assert np.all(ds.direction.values[0][missing] == 0)


@pytest.mark.parametrize(("density", "thickness"), [(-0.6, 0.01), (-0.3, 0.005)])
def test_field_beside_a_backward_mode(density, thickness):
    """Linear convergence of small losses to the lossless field; one lossy field against a path beside the real axis."""
    x, z = np.linspace(-0.6, 0.8, 29), np.array([-0.05, 0.0, thickness / 2, thickness, 0.03])
    beam = bp.GaussianBeam(0.02, angle=30, z0=-0.05)
    limit = bp.field(thin(density, thickness), beam, F, x, z).p.values
    largest = np.abs(limit).max()
    apart = [
        np.abs(bp.field(thin(density, thickness, loss), beam, F, x, z).p.values - limit).max() / largest
        for loss in (1e-4, 1e-5, 1e-6)
    ]
    assert apart[0] > 1e-5  # the modes matter
    assert apart[0] / apart[1] == pytest.approx(10, rel=0.02)
    assert apart[1] / apart[2] == pytest.approx(10, rel=0.02)
    lossy = thin(density, thickness, 1e-2)
    a = 0.02 / (2 * np.sqrt(np.log(2)))
    want = oracles.open_field(
        lossy,
        F,
        lambda k: a * np.sqrt(np.pi) * np.exp(-((a * (k - K0 / 2) / 2) ** 2)),
        -0.05,
        x,
        z,
        bend=0.02,
        band=900,
        count=200001,
    )
    got = bp.field(lossy, beam, F, x, z).p.values
    assert np.abs(got - want).max() < 2e-8 * largest


def test_field_far_from_a_slab_with_backward_modes():
    """A backward mode below k0: its circle is small enough for waves that travel a hundred times its radius along z."""
    frequency, cell = (
        1117.0,
        bp.Cell(
            tuple(
                bp.Layer(bp.Fluid(rho + 5e-4j, BULK), 1.1675e-3)
                for rho in (18.3, 12.9, -0.06, -13.04, -18.42, -13.04, -0.06, 12.9)
            )
        ),
    )
    slab, beam = bp.Slab(cell, 12), bp.GaussianBeam(0.11, x0=0.18, z0=-4.0)
    a, k0 = 0.11 / (2 * np.sqrt(np.log(2))), 2 * np.pi * frequency / 343
    search = misplaced.misplaced(sampled_slab.sample(slab, frequency), 0.1 * k0, 3 * k0, 1e-3 * k0)
    assert any(abs(k) < 0.9 * k0 for k in search.poles)
    x, z = np.linspace(0, 0.4, 7), np.array([-3.9, -1.0, 0.02, 0.08, 0.4])
    want = oracles.open_field(
        slab,
        frequency,
        lambda k: a * np.sqrt(np.pi) * np.exp(-((a * k / 2) ** 2) - 0.18j * k),
        -4.0,
        x,
        z,
        bend=0.05,
        band=160,
        count=30001,
    )
    got = bp.field(slab, beam, frequency, x, z).p.values
    assert np.all(np.abs(got - want).max(axis=1) < 2e-8 * np.abs(want).max(axis=1))


def test_wrong_side_would_be_seen():
    """The circles are what puts a backward mode right: without them the field is far off."""
    from beamprop.contour import choose
    from beamprop.fields import evaluate
    from beamprop.response import transfer_function
    from beamprop.sources.angles import single

    s = sampled_slab.sample(thin(-0.6, 0.01), F)
    assert len(misplaced.misplaced(s, 0.2 * K0, 5 * K0, 1e-3 * K0).poles) == 1
    beam = bp.GaussianBeam(0.02)
    x, z = np.linspace(-0.3, 0.3, 13), np.array([0.01])
    transfer = transfer_function.through(s, 0.0)
    with_them, without = (
        evaluate.evaluator(s, beam, chosen, transfer(chosen.contour.k, z))(x)
        for chosen in (choose.choose_contour(s, single(beam), transfer, x, z, 1e-8, guided) for guided in (True, False))
    )
    assert np.abs(with_them - without).max() > 0.05 * np.abs(with_them).max()


@pytest.mark.parametrize("loss", [0.0, 1e-3, 1e-2])
def test_modes_on_the_wrong_side_at_many_frequencies_at_once(loss):
    """As `misplaced` finds them one by one."""
    from beamprop.response.sampled_slab import sample_all

    f, slab = np.linspace(1500, 4500, 9), thin(-0.6, 0.01, loss)
    depth, band = np.linspace(2, 12, 9), np.linspace(100, 400, 9)
    at_once = misplaced.any_misplaced(sample_all(slab, f), depth, band)
    each = [
        bool(misplaced.misplaced(sampled_slab.sample(slab, a), b, c, 1e-3 * K0).poles)
        for a, b, c in zip(f, depth, band, strict=True)
    ]
    assert at_once.tolist() == each
    assert any(each)


def test_forward_modes_of_a_lossless_slab_are_on_the_right_side():
    """The LMMD slab guides many modes, all of them forward: none is misplaced, however near to the axis the contour runs."""
    from beamprop.response.sampled_slab import sample_all

    f, slab = np.linspace(2000, 3000, 9), bp.Slab(bp.lmmd_cell(lossless=True), 100)
    s = sample_all(slab, f)
    assert s.may_guide_backward
    assert all(np.all(bp.guided_modes(slab, a, kx_over_k0_max=2.0).direction == 1) for a in f[::4])
    for depth in (1e-3, 0.1):
        assert not np.any(misplaced.any_misplaced(s, depth * s.k0, 2 * s.k0))


@pytest.mark.parametrize(
    "wrong",
    [
        {"kx_over_k0_max": 0.5},
        {"kx_over_k0_max": np.nan},
        {"strip_over_k0": 0},
        {"frequency": -1.0},
        {"slab": 3},
    ],
)
def test_wrong_arguments_of_guided_modes(wrong):
    """ValueErrors name the argument."""
    arguments = {"slab": thin(5.0, 0.1), "frequency": F} | wrong
    with pytest.raises(ValueError, match=next(iter(wrong))):
        bp.guided_modes(**arguments)
