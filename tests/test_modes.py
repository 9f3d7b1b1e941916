"""Guided modes against closed forms and against the field; backward modes; beam measures."""

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
    assert mode == pytest.approx(1.598146, abs=1e-6)
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
    found = misplaced.misplaced(s, 0.3 * K0, 10 * K0, 1e-3 * K0)
    assert len(found.poles) == len(set(found.poles))
    assert any(abs(k - K0 * np.sqrt((1 - 4.5 / 0.88) / (1 - 1 / 0.88**2))) < 1e-6 * K0 for k in found.poles)


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
    found = misplaced.misplaced(sampled_slab.sample(slab, frequency), 0.1 * k0, 3 * k0, 1e-3 * k0)
    assert any(abs(k) < 0.9 * k0 for k in found.poles)
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


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("near", [None, 3.0])
def test_turns_about_zeros_that_are_known(seed, near):
    """Rational functions with up to 12 zeros and poles, in boxes of all shapes: zeros less poles inside."""
    rng = np.random.default_rng(seed)
    box = argument_principle.Box(-rng.random(), 4 + 40 * rng.random(), -rng.random(), 20 * rng.random() ** 3)
    zeros, poles = (
        rng.uniform(box.left - 1, box.right + 1, n) + 1j * rng.uniform(box.low - 1, box.high + 1, n)
        for n in rng.integers(0, 12, 2)
    )

    def f(k):
        value = np.prod(k[..., None] - zeros, axis=-1) / np.prod(k[..., None] - poles, axis=-1)
        return value, np.zeros(k.shape)

    wanted = sum(box.holds(k, 0.0) for k in zeros) - sum(box.holds(k, 0.0) for k in poles)
    path = box.outline(48, near)
    assert argument_principle.winding(f, path, 1e-9) == wanted
    several = np.stack([path, path + 1.0, path - 100.0])
    assert argument_principle.windings(
        lambda k, owner: f(k - np.array([0.0, 1.0, 0.0])[owner][:, None]), several, 1e-9
    )[:2].tolist() == [wanted, wanted]


def test_turns_about_pairs_of_zeros_beside_the_outline():
    """Zeros at distances of 1e-4 to 10 rad/m from the long sides of a box of the search, two of them close together."""
    for seed in range(200):
        rng = np.random.default_rng(seed)
        width, depth, m = rng.uniform(80, 250), rng.uniform(3, 12), int(rng.integers(2, 12))
        box = argument_principle.Box(0.05, width, -depth, 0.0)
        beside = 10 ** rng.uniform(-4, 1, m) * rng.choice([-1, 1], m)
        zeros = rng.uniform(0, width, m) + 1j * (rng.choice([0, -depth], m) + beside)
        zeros[1] = zeros[0] + 10 ** rng.uniform(-4, 0.5) * np.exp(2j * np.pi * rng.random())

        def f(k, zeros=zeros):
            return np.prod(k[..., None] - zeros, axis=-1), np.zeros(k.shape)

        wanted = sum(box.holds(k, 0.0) for k in zeros)
        assert argument_principle.winding(f, box.outline(48, K0), 1e-9 * width) == wanted, seed


@pytest.mark.parametrize("nodes", [1, 5, 24])
def test_outlines_go_around_once(nodes):
    """Corners in turn, counter-clockwise, each side from corner to corner; more nodes beside a branch point."""
    left, right, low, high = np.array([1.0, 2.0]), np.array([9.0, 4.0]), np.array([-1.0, -3.0]), np.array([0.0, 0.5])
    for near in (None, np.array([3.0, 30.0])):
        paths = argument_principle.outlines(left, right, low, high, nodes, near)
        for path, a, b, c, d in zip(paths, left, right, low, high, strict=True):
            corners = [a + 1j * c, b + 1j * c, b + 1j * d, a + 1j * d]
            assert [int(np.argmax(path == k)) for k in corners] == sorted(int(np.argmax(path == k)) for k in corners)
            assert all(np.any(path == k) for k in corners)
            step = np.diff(np.append(path, path[0]))
            assert np.all((step.real == 0) | (step.imag == 0))
            assert np.sum(np.conj(path - corners[0]) * step).imag / 2 == pytest.approx((b - a) * (d - c))
            assert np.abs(step).sum() == pytest.approx(2 * (b - a + d - c))


@pytest.mark.parametrize("loss", [0.0, 1e-3, 1e-2])
def test_modes_on_the_wrong_side_at_many_frequencies_at_once(loss):
    """As `misplaced` finds them one by one; of a lossless slab forward ones may be counted too."""
    from beamprop.response.sampled_slab import sample_all

    f, slab = np.linspace(1500, 4500, 9), thin(-0.6, 0.01, loss)
    depth, band = np.linspace(2, 12, 9), np.linspace(100, 400, 9)
    found = misplaced.any_misplaced(sample_all(slab, f), depth, band)
    each = [
        bool(misplaced.misplaced(sampled_slab.sample(slab, a), b, c, 1e-3 * K0).poles)
        for a, b, c in zip(f, depth, band, strict=True)
    ]
    assert np.all(found >= each)
    assert loss == 0 or found.tolist() == each
    assert any(each)


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


# --- beam measures ----------------------------------------------------------------------------------------


def test_a_wide_gaussian_in_air():
    """2 a, 2/(k a), all of the power, no shift."""
    beam = bp.GaussianBeam(0.5, angle=20.0)
    a = beam.radius
    with pytest.warns(RuntimeWarning, match="no beam on a side"):
        both = bp.beam_measures(bp.Slab.uniform(bp.AIR, 0.05), beam, 4000.0)
    ds = both.sel(side="transmitted")
    k = 2 * np.pi * 4000 / 343
    assert ds.fwhm == pytest.approx(0.5, rel=2e-3)
    assert ds.width_1e2 == pytest.approx(2 * a, rel=2e-3)
    assert ds.width_second_moment == pytest.approx(2 * a, rel=3e-3)
    assert ds.power == pytest.approx(1.0, abs=1e-9)
    assert ds.far_angle == pytest.approx(20.0, abs=0.1)
    assert ds.divergence == pytest.approx(np.degrees(2 / (k * a)) / np.cos(np.radians(20)), rel=5e-3)
    assert abs(ds.lateral_shift) < 2e-3 * 0.5
    assert ds.crossings == 2


def test_power_is_conserved_without_loss():
    """Reflected and transmitted shares add up, with water behind too."""
    for after in (bp.AIR, bp.Fluid.from_speed(400.0, 500.0)):
        slab = bp.Slab(bp.Cell([bp.Layer(bp.Fluid(3.0, BULK), 0.03), bp.Layer(bp.Fluid(0.4, BULK), 0.05)]), after=after)
        ds = bp.beam_measures(slab, bp.GaussianBeam(0.4), F)
        assert float(ds.power.sum()) == pytest.approx(1.0, abs=1e-6)


def test_goos_haenchen_shift_is_the_phase_slope():
    """Total reflection at 60 degrees of a wide beam: shift = -d(arg r)/dkx (Artmann)."""
    fast = bp.Fluid.from_speed(1.0, 600.0)
    slab = bp.Slab.uniform(fast, 0.5, after=fast)
    k = K0 * np.sin(np.radians(60))
    r = bp.scattering(slab, F, kx=np.array([k - 1e-3, k, k + 1e-3])).r.values
    assert abs(r[1]) == pytest.approx(1.0, abs=1e-9)
    artmann = -np.imag((r[2] - r[0]) / (2e-3 * r[1]))
    with pytest.warns(RuntimeWarning, match="far_angle"):  # nothing radiates behind
        both = bp.beam_measures(slab, bp.GaussianBeam(8.0, angle=60.0), F)
    ds = both.sel(side="reflected")
    assert ds.lateral_shift == pytest.approx(artmann, rel=2e-3)


def test_several_crossings_are_said():
    """Two slits: the half level is met four times."""
    slab = bp.Slab.uniform(bp.Fluid.from_speed(1.5, 343.0), 0.01)
    x = np.linspace(-0.3, 0.3, 601)
    two = np.exp(-(((x - 0.12) / 0.03) ** 2)) + np.exp(-(((x + 0.12) / 0.03) ** 2))
    with pytest.warns(RuntimeWarning, match="half level is met"):
        ds = bp.beam_measures(slab, bp.Profile(x, two), 8000.0)
    assert ds.crossings.sel(side="transmitted") == 4


def two_humps():
    x = np.linspace(-0.3, 0.3, 601)
    return bp.Profile(x, np.exp(-(((x - 0.12) / 0.03) ** 2)) + np.exp(-(((x + 0.12) / 0.03) ** 2)))


@pytest.mark.parametrize("beam", [two_humps(), bp.Slits(0.08, 0.3, z0=-0.02)])  # slits: one frequency at a time
def test_widths_of_two_humps_say_so(beam):
    """As often as a field on a fine grid crosses it; all four planes are named."""
    slab = bp.Slab.uniform(bp.Fluid.from_speed(1.3, 343.0), 0.01)
    with pytest.warns(RuntimeWarning, match="half level is met up to") as said:
        ds = bp.beam_width(slab, beam, [8000.0, 9000.0], rtol=1e-5)
    (message,) = [str(w.message) for w in said]
    x = np.linspace(-0.4, 0.4, 4001)
    planes = {"fwhm_launch": beam.z0, "fwhm_in": 0.0, "fwhm_out": 0.01}
    met = []
    for name, z in planes.items():
        free = bp.Slab.uniform(bp.AIR, 0.01) if name == "fwhm_in" else slab
        for f in ds.frequency.values:
            p = beam.profile(x, K0) if z == beam.z0 else bp.field(free, beam, f, x, z, rtol=1e-5).p.values
            met.append(np.count_nonzero(np.diff(np.abs(p) > np.abs(p).max() / 2)))
    assert max(met) > 2
    assert f"up to {max(met)} times" in message
    assert message.endswith(": fwhm_launch, fwhm_in, fwhm_out, fwhm_air")


def test_a_plain_beam_says_nothing():
    """The paper's lossy slab and one without loss meet the half level twice (a warning is an error here)."""
    for cell in (bp.lmmd_cell(), bp.lmmd_cell(0.05, 0.0)):
        bp.beam_width(bp.Slab(cell, 450), bp.GaussianBeam(0.096), [2300.0, 2500.0, 2700.0])


def test_crossings_alone_and_together():
    """Sampled on one window at once, and in a window that grows: the same number."""
    from beamprop.profiles import one_frequency, routes, sections
    from beamprop.response import transfer_function
    from beamprop.response.sampled_slab import sample_all

    slab, beam = bp.Slab.uniform(bp.Fluid.from_speed(1.3, 343.0), 0.01), two_humps()
    s = sample_all(slab, np.array([2000.0, 8000.0, 12_000.0]))
    face = np.full(3, slab.thickness)
    route = routes.Route(
        s,
        lambda slab, _: routes.far_face(slab, 0.0),
        lambda one: transfer_function.through(one, 0.0),
        face,
        face,
        True,
    )
    together = sections.measure(route, beam, 1e-6)
    for i in range(3):
        one = s.take(i)
        alone = one_frequency.measured_alone(
            one, beam, transfer_function.through(one, 0.0), (slab.thickness, slab.thickness), 1e-6, 0.5, True
        )
        assert alone[3] == together.crossings[i] == 4
        assert alone[0] == pytest.approx(together.width[i], rel=1e-5)


# --- measured profiles ------------------------------------------------------------------------------------


@pytest.mark.parametrize("separator", [" ", ", ", ";\t"])
def test_a_profile_from_a_file(tmp_path, separator):
    """Rows in any order, comments, both conventions; the field is that of the samples."""
    x = np.linspace(-0.2, 0.2, 161)
    p = np.exp(-((x / 0.05) ** 2) + 3j * x)
    rows = [separator.join(f"{v:.17g}" for v in row) for row in zip(x, p.real, -p.imag, strict=True)]
    path = tmp_path / "measured.txt"
    path.write_text("\n".join(["% x Re Im", *rows[::-1], ""]))
    beam = bp.Profile.from_file(path, z0=-0.02, conjugate=True)
    assert beam == bp.Profile(x, p, -0.02)


def test_a_profile_from_a_field():
    """What leaves one slab is launched into the next: equal to the two in a row where nothing comes back."""
    air = bp.Slab.uniform(bp.AIR, 0.1)
    x = np.linspace(-0.6, 0.6, 481)
    first = bp.field(air, bp.GaussianBeam(0.1), F, x, 0.1)
    again = bp.field(air, bp.Profile.from_data(first.p), F, [0.0, 0.05], 0.1)
    whole = bp.field(air, bp.GaussianBeam(0.1), F, [0.0, 0.05], 0.2)
    np.testing.assert_allclose(again.p, whole.p, atol=2e-3)  # the window of the samples cuts the tails


@pytest.mark.parametrize(
    ("text", "said"), [("0 1 2\n1 2\n", "line 2"), ("0 1\nabc 2\n", "line 2"), ("% only\n", "2 rows")]
)
def test_files_that_are_no_profile(tmp_path, text, said):
    """The file and the line are named."""
    path = tmp_path / "p.txt"
    path.write_text(text)
    with pytest.raises(ValueError, match=said):
        bp.Profile.from_file(path)


@pytest.mark.parametrize("z0", [0.0, -0.02])
def test_slits_on_their_own_launch_plane_are_refused_with_the_reason(z0):
    """The spectrum of a sharp edge does not end there; a centimetre behind it, it does."""
    slab = bp.Slab(bp.lmmd_cell(), 20)
    with pytest.raises(ValueError, match="sharp edge"):
        bp.field(slab, bp.Slits(0.02, 0.05, z0=z0), F, 0.0, z0, rtol=1e-3)
    assert bp.field(slab, bp.Slits(0.02, 0.05, z0=-0.02), F, 0.0, -0.01).error_estimate < 1e-8
