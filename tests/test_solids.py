"""Solid layers: plane waves against many digits, against stiffnesses, and against what physics demands."""

import mpmath as mp
import numpy as np
import oracles
import pytest
import solid_oracles

import beamprop as bp

WATER = bp.Fluid.from_speed(1000.0, 1480.0)
IN_WATER = (1000.0, 1000.0 * 1480.0**2)
STEEL = bp.Solid(7900.0, 5900.0, 3200.0)
ALUMINIUM = bp.Solid(2700.0, 6320.0, 3130.0)
EPOXY = bp.Solid(1200.0, 2600 - 20j, 1150 - 15j)


def stack(layers, periods=1):
    """A slab in water of an oracle's layers."""
    media = (bp.Fluid(rho, K) if not rest else bp.Solid(rho, K, rest[0]) for rho, K, *rest, _ in layers)
    return bp.Slab(
        [bp.Layer(medium, layer[-1]) for medium, layer in zip(media, layers, strict=True)], periods, background=WATER
    )


def random_layers(rng, count, fluids=True):
    """Layers of 1 um to 1 mm between 10 kHz and 30 MHz, and a kx of up to 4 k0."""
    frequency = 10 ** rng.uniform(4, 7.5)
    layers = []
    for _ in range(count):
        rho, d = rng.uniform(900, 8000), 10 ** rng.uniform(-6, -3)
        c = rng.uniform(1500, 6500) * (1 - 0.01j * rng.integers(0, 2))
        if fluids and rng.random() < 0.4:
            layers.append((rho, rho * c * c, d))
        else:
            layers.append((rho, c, c * rng.uniform(0.02, 0.7), d))
    kx = 2 * np.pi * frequency / 1480 * rng.uniform(0.01, 4)
    return frequency, layers, kx * (1 - 0.02j * (rng.random() < 0.3))


def worst(ds, r, t):
    """The larger relative error of r and t."""
    got_r, got_t = complex(ds.r), complex(ds.t)
    return max(abs(got_r - r) / abs(r), abs(got_t - t) / abs(t) if abs(t) > 1e-280 else 0.0)


@pytest.mark.parametrize("seed", range(24))
def test_stacks_agree_with_many_digits(seed):
    rng = np.random.default_rng(seed)
    frequency, layers, kx = random_layers(rng, int(rng.integers(1, 6)))
    ds = bp.scattering(stack(layers), frequency, kx=kx)
    assert worst(ds, *solid_oracles.response(layers, 1, IN_WATER, IN_WATER, frequency, kx)) < max(
        1e-9, 100 * ds.error_estimate
    )


@pytest.mark.parametrize("fd", [1e-5, 3e-3, 0.1, 3.0, 30.0, 300.0, 3000.0])
@pytest.mark.parametrize("kx_over_k0", [0.05, 0.9, 3.0, 10.0])
def test_a_steel_plate_from_thin_to_thick(fd, kx_over_k0):
    """fd in MHz mm."""
    layers, kx = [(7900.0, 5900.0, 3200.0, 1e-3)], 2 * np.pi * fd * 1e6 / 1480 * kx_over_k0
    ds = bp.scattering(stack(layers), fd * 1e6, kx=kx)
    if fd * kx_over_k0 < 500:
        r, t = solid_oracles.response(layers, 1, IN_WATER, IN_WATER, fd * 1e6, kx)
    else:  # nothing comes back from the far face: 1e5 digits would show it, too
        r, t = solid_oracles.by_stiffness(layers, (1000.0, 1480.0), fd * 1e6, kx)
    assert abs(complex(ds.r) - r) < 1e-13
    assert abs(t) < 1e-280 or abs(complex(ds.t) / t - 1) < 1e-11


@pytest.mark.parametrize("kx_over_k0", [0.3, 1.5, 3 - 0.1j])
@pytest.mark.parametrize(("thickness", "unlike"), [(1e-5, 0.0), (1e-5, 0.05), (1e-4, 0.05)])
def test_many_layers_in_contact_agree_with_many_digits(thickness, unlike, kx_over_k0):
    """Like layers, made once, and unlike ones; those of 0.1 mm grow by e^50 and more together, each by little."""
    layers = [
        (*((7900.0, 5900.0, 3200.0), (1200.0, 2600.0, 1150.0))[j % 2], thickness * (1 + unlike * j)) for j in range(21)
    ]
    kx = 2 * np.pi * 1e6 / 1480 * kx_over_k0
    ds = bp.scattering(stack(layers), 1e6, kx=kx)
    assert worst(ds, *solid_oracles.response(layers, 1, IN_WATER, IN_WATER, 1e6, kx)) < 1e-12


def test_a_few_kx_among_many_are_as_alone():
    """An array in which some are thin and others thick, also where kx is 20 kT; and kx of grazing P and S waves."""
    slab = stack([(7900.0, 5900.0, 3200.0, 4e-4), (1200.0, 2600.0, 1150.0, 3e-4)])
    for frequency, largest in ((1e6, 6), (1e4, 300)):
        kx = np.r_[np.linspace(0, largest, 301), 1480 / 5900, 1480 / 3200] * 2 * np.pi * frequency / 1480
        together = bp.scattering(slab, frequency, kx=kx)
        for j in (0, 10, 30, 60, 100, 200, 300, 301, 302):
            alone = bp.scattering(slab, frequency, kx=kx[j])
            assert complex(alone.r) == pytest.approx(together.r.values[j], rel=1e-12)
            assert complex(alone.t) == pytest.approx(together.t.values[j], rel=1e-10, abs=1e-290)


def test_hundreds_of_layers_that_grow_by_little_each_do_not_overflow():
    """e^760 together, each below 2 nepers: their reflection is that of the first ones."""
    kx = 1.9 / 1e-4
    r = [
        complex(
            bp.scattering(stack([(7900.0, 5900.0, 3200.0, 1e-4), (1200.0, 2600.0, 1150.0, 1e-4)] * n), 1e6, kx=kx).r
        )
        for n in (20, 200)
    ]
    assert r[0] == pytest.approx(r[1], rel=1e-12)


def test_p_and_s_waves_alike_are_the_limit_of_nearly_alike_ones():
    """An unstable solid, for which active=True is asked."""
    alike, nearly = (
        bp.scattering(
            bp.Slab([bp.Layer(bp.Solid(2000.0, c, 2000.0, active=True), d) for d in (4e-4, 6e-4)], background=WATER),
            1e6,
            angle=[20.0, 60.0],
        )
        for c in (2000.0, 2000.1)
    )
    assert np.isfinite(alike.t.values).all()
    assert float(abs(alike.t - nearly.t).max()) < 2e-4


@pytest.mark.parametrize("periods", [2, 7, 40])
@pytest.mark.parametrize("seed", range(4))
def test_periods_agree_with_many_digits(seed, periods):
    """Cells that begin or end in a solid, in both, and of solids alone."""
    rng = np.random.default_rng(100 + seed)
    kinds = [(4, 3), (3, 4), (4, 3, 4), (4, 4)][seed]
    layers = []
    for kind in kinds:
        rho, c, d = rng.uniform(900, 8000), rng.uniform(1500, 6500), 10 ** rng.uniform(-5, -4)
        layers.append((rho, rho * c * c, d) if kind == 3 else (rho, c, 0.5 * c, d))
    frequency = 2e6
    for kx_over_k0 in (0.2, 0.97, 1.5):
        kx = 2 * np.pi * frequency / 1480 * kx_over_k0
        ds = bp.scattering(stack(layers, periods), frequency, kx=kx)
        exact = solid_oracles.response(layers, periods, IN_WATER, IN_WATER, frequency, kx)
        assert worst(ds, *exact) < max(1e-9, 100 * ds.error_estimate)


@pytest.mark.parametrize("seed", range(12))
def test_solids_agree_with_stiffnesses(seed):
    rng = np.random.default_rng(200 + seed)
    _, layers, _ = random_layers(rng, 3, fluids=False)
    layers = [(rho, c, c_t, 10 ** rng.uniform(-4, -3)) for rho, c, c_t, _ in layers]
    frequency = rng.uniform(0.3e6, 3e6)
    kx = 2 * np.pi * frequency / 1480 * rng.uniform(0.05, 0.95)
    r, t = solid_oracles.by_stiffness(layers, (1000.0, 1480.0), frequency, kx)
    ds = bp.scattering(stack(layers), frequency, kx=kx)
    assert max(abs(complex(ds.r) - r), abs(complex(ds.t) - t)) < 1e-8


def test_without_loss_energy_is_kept_and_with_loss_absorbed():
    lossless = bp.Slab([bp.Layer(STEEL, 1e-3), bp.Layer(WATER, 2e-3), bp.Layer(ALUMINIUM, 5e-4)], 5, background=WATER)
    ds = bp.scattering(lossless, [0.2e6, 1e6, 3e6], angle=np.linspace(0, 89, 90))
    assert abs(ds.absorption).max() < 1e-12
    lossy = bp.Slab([bp.Layer(EPOXY, 1e-3), bp.Layer(WATER, 2e-3)], 5, background=WATER)
    assert bp.scattering(lossy, 1e6, angle=np.linspace(0, 89, 90)).absorption.min() > 0


def test_transmission_is_the_same_from_behind():
    layers = [bp.Layer(STEEL, 1e-3), bp.Layer(EPOXY, 3e-4), bp.Layer(WATER, 2e-3), bp.Layer(ALUMINIUM, 5e-4)]
    there, back = (bp.scattering(bp.Slab(order, 3, background=WATER), 1e6, kx_over_k0=np.linspace(0, 3, 61)).t
                   for order in (layers, layers[::-1]))  # fmt: skip
    assert float((abs(there - back) / abs(there)).max()) < 1e-10


def test_at_normal_incidence_a_plate_is_a_fluid():
    fluid = bp.Fluid.from_speed(7900.0, 5900.0)
    f = np.linspace(0.1e6, 6e6, 60)
    plate, layer = (bp.scattering(bp.Slab(bp.Layer(m, 1e-3), background=WATER), f, angle=0.0) for m in (STEEL, fluid))
    assert float(abs(plate.t - layer.t).max()) < 1e-12
    assert abs(
        complex(bp.scattering(bp.Slab(bp.Layer(STEEL, 1e-3), background=WATER), 2.95e6, angle=0.0).t)
    ) == pytest.approx(1, abs=1e-12)


def test_with_little_shear_a_solid_tends_to_a_fluid():
    """Linearly in the square of the shear speed, with loss, down to 1e-6 m/s."""
    c = 1600 - 16j
    fluid = bp.scattering(
        bp.Slab(bp.Layer(bp.Fluid.from_speed(1200.0, c), 1e-3), background=WATER), 1e6, angle=[10.0, 40.0]
    )
    apart = []
    for c_t in (0.4, 0.2, 1e-6):
        solid = bp.Solid(1200.0, c, c_t * (1 - 0.5j))
        ds = bp.scattering(bp.Slab(bp.Layer(solid, 1e-3), background=WATER), 1e6, angle=[10.0, 40.0])
        apart.append(float(abs(ds.t - fluid.t).max()))
    assert apart[0] / apart[1] == pytest.approx(4, rel=0.05)
    assert apart[2] < 1e-13


def test_cutting_a_layer_changes_nothing():
    kx = np.linspace(0, 4, 161)
    whole, cut, periods = (
        bp.scattering(bp.Slab([bp.Layer(STEEL, d) for d in ds], n, background=WATER), 3e6, kx_over_k0=kx)
        for ds, n in (((1e-3,), 1), ((3e-4, 5e-4, 2e-4), 1), ((2.5e-4,), 4))
    )
    for other in (cut, periods):
        assert float(abs(whole.r - other.r).max()) < 1e-11
        assert float((abs(whole.t - other.t) / abs(whole.t)).max()) < 1e-9


def test_full_transmission_of_a_steel_plate_where_it_was_computed_elsewhere():
    """|t| = 1 at kx/k0 = 0.22354, 0.24041, 0.43785 and 0.51913: 1 mm of steel in water at 3 MHz."""
    ds = bp.scattering(
        bp.Slab(bp.Layer(STEEL, 1e-3), background=WATER), 3e6, kx_over_k0=[0.22354, 0.24041, 0.43785, 0.51913]
    )
    assert abs(ds.t).min() > 1 - 1e-5


@pytest.mark.parametrize(
    ("fd", "backward"),
    [(2.75, 0.1180 - 0.0365j), (2.80, 0.0869 - 0.0227j), (2.85, 0.0613 - 0.0197j), (2.90, 0.0402 - 0.0202j), (3.0, 0.0131 - 0.0297j)],
)  # fmt: skip
def test_backward_leaky_modes_of_a_steel_plate_lie_below_the_axis(fd, backward):
    """Next to the S1 zero-group-velocity point, fd in MHz mm; forward ones above the axis, and the count is whole."""
    ds = bp.guided_modes(PLATE, fd * 1e6, strip_over_k0=0.12, leaky=True)
    k, direction = ds.kx_over_k0.values, ds.direction.values
    assert int(ds["count"]) == k.size
    assert abs(k[direction < 0] - backward) == pytest.approx([0], abs=1e-4)
    leaky = k[(direction > 0) & (k.real < 1)]
    assert leaky.imag.min() > 0
    if fd == 3.0:
        assert sorted(leaky.real) == pytest.approx([0.22344, 0.24048, 0.43741, 0.51971], abs=1e-5)


def test_leaky_modes_far_from_the_axis_are_zeros_of_the_matrices():
    """A strip of k0/2: (i kz + rho_z d/dz) of the near face, kz continued from the physical sheet, by a secant's step from each mode."""
    w, k0 = 2 * mp.pi * 3e6, 2 * mp.pi * 3e6 / 1480

    def dispersion(k):
        kz = mp.sqrt(k0**2 - k**2)
        near = solid_oracles.plate_back(7900.0, 5900.0, 3200.0, 1e-3, w, k) * mp.matrix([1, 1j * kz / 1000])
        return 1j * kz * near[0] + 1000 * near[1]

    modes = bp.guided_modes(PLATE, 3e6, strip_over_k0=0.5, leaky=True).kx_over_k0.values
    far = modes[abs(modes.imag) > 0.1]
    assert far.size == 2
    with mp.workdps(40):
        for k in (mp.mpc(complex(v)) * k0 for v in far):
            value, beside = dispersion(k), dispersion(k * (1 + mp.mpf(10) ** -12))
            assert abs(value / (beside - value) * mp.mpf(10) ** -12) < 1e-10


# --- beams -----------------------------------------------------------------------------------------------------

PLATE = bp.Slab(bp.Layer(STEEL, 1e-3), background=WATER)
BEAM = bp.GaussianBeam(fwhm=2 * np.sqrt(np.log(2)) * 8e-3, angle=13.91, z0=-2e-3)


def test_a_beam_loses_most_of_its_power_where_a_plane_wave_passes():
    """|t| = 0.999 at 13.91 degrees; of a beam of a = 8 mm the peak is 0.383 and less than a third of the power passes."""
    beam = bp.GaussianBeam(BEAM.fwhm, angle=13.91)
    measures = bp.beam_measures(PLATE, beam, 3e6)
    assert float(bp.beam_width(PLATE, beam, 3e6).peak_out) == pytest.approx(0.383, abs=5e-4)
    # the same share by stiffnesses and the trapezoid rule over real kx; the admittance of both half-spaces is kz
    k0 = 2 * np.pi * 3e6 / 1480
    kx = k0 * np.linspace(-0.1, 0.6, 1401)
    weight = np.exp(-((kx - k0 * np.sin(np.radians(13.91))) ** 2) * 8e-3**2 / 2) * np.sqrt(k0**2 - kx**2)
    t = np.array(
        [solid_oracles.by_stiffness([(7900.0, 5900.0, 3200.0, 1e-3)], (1000.0, 1480.0), 3e6, k)[1] for k in kx]
    )
    assert measures.power.values[1] == pytest.approx(float((weight * abs(t) ** 2).sum() / weight.sum()), abs=1e-9)
    assert float(measures.power.sum()) == pytest.approx(1, abs=1e-9)


@pytest.mark.parametrize(
    ("frequency", "fd_note"), [(3e6, "backward mode beside kx = 0"), (1.5e6, "forward modes only")]
)
def test_a_beam_behind_a_plate_agrees_with_an_independent_quadrature(frequency, fd_note):
    """The trapezoid rule on a contour between the axis and the backward modes, with the response by stiffnesses."""
    k0 = 2 * np.pi * frequency / 1480
    beam = bp.GaussianBeam(3e-3, angle=12.0)
    kx, weight = oracles.bent_contour(k0, bend=60.0, band=1.6 * k0, count=6001)
    t = np.array(
        [solid_oracles.by_stiffness([(7900.0, 5900.0, 3200.0, 1e-3)], (1000.0, 1480.0), frequency, k)[1] for k in kx]
    )
    x = np.linspace(-8e-3, 12e-3, 81)
    right, left = (
        np.exp(sign * 1j * np.multiply.outer(x, kx)) @ (weight * t * beam.spectrum(sign * kx, k0)) for sign in (1, -1)
    )
    p = bp.field(PLATE, beam, frequency, x, 1e-3, rtol=1e-9)
    assert abs(p.p.values - (right + left) / (2 * np.pi)).max() < 3e-9 * abs(p.p.values).max()
    assert float(p.error_estimate) < 1e-9


def test_fields_in_solids_obey_the_equations_of_elasticity():
    """-s_zz = -(L du_z/dz + lambda du_x/dx) by differences inside a plate, of a cell too; p and v_z are continuous at its faces."""
    w, h = 2 * np.pi * 3e6, 1e-6
    L, lam = 7900 * 5900.0**2, 7900 * (5900.0**2 - 2 * 3200.0**2)
    lattice = bp.Slab([bp.Layer(WATER, 1e-3), bp.Layer(ALUMINIUM, 2e-4), bp.Layer(STEEL, 1e-3)], 3, background=WATER)
    for slab, z in ((PLATE, 5e-4), (lattice, 4.1e-3)):
        ds = bp.field(
            slab, BEAM, 3e6, [1e-3 - h, 1e-3, 1e-3 + h], [z - h, z, z + h], rtol=1e-9, variables=["p", "v_x", "v_z"]
        )
        p, v_x, v_z = (ds[name].values for name in ("p", "v_x", "v_z"))
        stretched = L * (v_z[2, 1] - v_z[0, 1]) + lam * (v_x[1, 2] - v_x[1, 0])
        assert -p[1, 1] == pytest.approx(1j / w * stretched / (2 * h), rel=1e-4)
    sides = bp.field(
        PLATE, BEAM, 3e6, np.linspace(-0.01, 0.03, 41), [0.0, 1e-12, 1e-3 - 1e-12, 1e-3], variables=["p", "v_z"]
    )
    for v in (sides.p.values, sides.v_z.values):
        assert abs(v[0] - v[1]).max() < 1e-7 * abs(v).max()
        assert abs(v[2] - v[3]).max() < 1e-7 * abs(v).max()


def test_the_same_power_passes_through_all_planes_in_front_and_behind():
    ds = bp.field(PLATE, BEAM, 3e6, 0.0, [-1e-3, 0.0, 1e-3, 5e-3], variables=["power_through"])
    assert np.ptp(ds.power_through.values) < 1e-9 * float(ds.power_through.max())


def test_a_field_of_a_cell_is_that_of_its_layers_one_by_one():
    layers = [bp.Layer(STEEL, 1e-3), bp.Layer(WATER, 2e-3), bp.Layer(ALUMINIUM, 1e-3)]
    x, z = np.linspace(-0.02, 0.04, 61), np.linspace(-1e-3, 29e-3, 61)
    cell, one_by_one = (bp.field(slab, BEAM, 3e5, x, z).p for slab in
                        (bp.Slab(layers, 7, background=WATER), bp.Slab(layers * 7, background=WATER)))  # fmt: skip
    assert float(abs(cell - one_by_one).max()) < 1e-9


def test_in_three_dimensions_a_wide_beam_on_a_plate_tends_to_that_of_two():
    """By 4 a doubling of its width along y."""
    x, z = np.linspace(-5e-3, 10e-3, 16), [-1e-3, 5e-4, 1e-3, 4e-3]
    flat = bp.field(PLATE, bp.GaussianBeam(6e-3, angle=12, z0=-2e-3), 3e6, x, z).p.values
    apart = []
    for width in (24e-3, 48e-3):
        beam = bp.GaussianBeam((6e-3, width), angle=12, z0=-2e-3)
        apart.append(abs(bp.field(PLATE, beam, 3e6, x, z, y=0.0).p.values - flat).max())
    assert apart[0] / apart[1] == pytest.approx(4, rel=0.05)


# --- components ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["p", "u_x", "u_z", "s_xz", "v_x", "v_z"])
def test_a_component_is_the_variable_of_its_name(name):
    """In front of, inside and behind the plate; u is defined in fluids, and s_xz is 0 there."""
    z = [-1e-3, 5e-4, 2e-3]
    ds = bp.field(PLATE, BEAM, 3e6, [0.0, 1e-3], z, component=name)
    same = bp.field(PLATE, BEAM, 3e6, [0.0, 1e-3], z, variables=[name])
    assert set(ds) == {name, "error_estimate" if name == "p" else f"error_estimate_{name}"}
    np.testing.assert_array_equal(ds[name], same[name])
    assert (abs(ds[name]).max("x").values > 0).tolist() == [name != "s_xz", True, name != "s_xz"]


def test_components_are_refused_by_name():
    with pytest.raises(ValueError, match=r"component: expected 'p', .* or 'u_z', got 'power_through'"):
        bp.field(PLATE, BEAM, 3e6, 0.0, 0.0, component="power_through")
    with pytest.raises(ValueError, match=r"component: expected none beside variables, .*got 'u_x'"):
        bp.field(PLATE, BEAM, 3e6, 0.0, 0.0, component="u_x", variables=["v_x"])
