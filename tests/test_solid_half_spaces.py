"""A half-space of solid behind: against Brekhovskikh's formula, many digits, energy, limits, and published poles."""

import numpy as np
import pytest
import solid_oracles
from test_solids import ALUMINIUM, EPOXY, IN_WATER, STEEL, WATER, random_layers

import beamprop as bp
from beamprop.response import solid_half_space
from beamprop.response.sampled_slab import sample

BRASS = bp.Solid(8400.0, 4400.0, 2200.0)
K = np.array([0.0, 0.1, 0.24, 0.3, 0.45, 0.49, 0.6, 0.9, 1.3, 4.0])


def brekhovskikh(solid, frequency, kx):
    """r of water in front of a solid: (Z_L cos^2 2g + Z_T sin^2 2g - Z)/(... + Z), g the angle of the S wave."""
    w = 2 * np.pi * frequency
    rho, c_l, c_t = (complex(v) for v in (solid.density, solid.longitudinal_speed, solid.shear_speed))
    kz, a, b = (np.sqrt((w / c) ** 2 - kx**2 + 0j) for c in (1480.0, c_l, c_t))
    cos = 1 - 2 * kx**2 * c_t**2 / w**2
    sin = 2 * kx * b * c_t**2 / w**2
    behind, front = rho * w / a * cos**2 + rho * w / b * sin**2, 1000.0 * w / kz
    return (behind - front) / (behind + front)


@pytest.mark.parametrize("solid", [STEEL, ALUMINIUM, EPOXY])
def test_r_of_a_half_space_is_brekhovskikhs(solid):
    ds = bp.scattering(bp.Slab.interface(WATER, solid), 3e6, kx_over_k0=K)
    assert abs(ds.r - brekhovskikh(solid, 3e6, ds.kx.values)).max() < 1e-13


@pytest.mark.parametrize("seed", range(12))
def test_stacks_in_front_of_solids_agree_with_many_digits(seed):
    """With none, one or several solids in contact with the half-space, in one cell or in a repeated one."""
    rng = np.random.default_rng(300 + seed)
    frequency, layers, kx = random_layers(rng, seed % 4)
    periods = 1 + seed % 3
    behind = (4500.0, 5000.0 * (1 - 0.01j * (seed % 2)), 2500.0)
    media = (bp.Fluid(rho, K) if not rest else bp.Solid(rho, K, rest[0]) for rho, K, *rest, _ in layers)
    made = [bp.Layer(medium, layer[-1]) for medium, layer in zip(media, layers, strict=True)]
    slab = bp.Slab(made or [bp.Membrane(0.0)], periods, before=WATER, after=bp.Solid(*behind))
    r, t = solid_oracles.response(layers, periods, IN_WATER, behind, frequency, kx)
    ds = bp.scattering(slab, frequency, kx=kx)
    assert max(abs(complex(ds.r) - r), abs(complex(ds.t) / t - 1)) < max(1e-10, 100 * float(ds.error_estimate))


LAYERED = bp.Slab(
    [bp.Layer(ALUMINIUM, 3e-4), bp.Layer(WATER, 1e-3), bp.Layer(bp.Solid(1200.0, 2600.0, 1150.0), 2e-4), bp.Layer(STEEL, 1e-3)],
    3, before=WATER, after=ALUMINIUM,
)  # fmt: skip


def test_without_loss_p_and_s_waves_carry_what_is_not_reflected():
    ds = bp.scattering(LAYERED, [0.3e6, 1e6, 3e6], angle=np.linspace(0, 89, 90))
    assert abs(ds.absorption).max() < 1e-12
    # by the two waves themselves: each carries its |amplitude|^2 Re(kz)/rho
    w, kx = 2 * np.pi * ds.frequency, ds.kx
    a, b, kz = (np.sqrt((w / c) ** 2 - kx**2 + 0j) for c in (6320.0, 3130.0, 1480.0))
    carried = (abs(ds.t_p) ** 2 * a.real + abs(ds.t_s) ** 2 * b.real) / 2700.0 / (kz.real / 1000.0)
    assert abs(carried - ds.energy_transmission).max() < 1e-11


def test_potentials_behind_give_the_displacement_at_the_face():
    """u_z of the water and of the solid at their face: i kz (1 - r)/(rho w^2) = (i a t_p + i kx t_s)/(rho_s w^2); no shear stress."""
    ds = bp.scattering(bp.Slab.interface(WATER, STEEL), 3e6, kx_over_k0=K)
    w, kx = 2 * np.pi * 3e6, ds.kx.values
    kz, a, b = (np.sqrt((w / c) ** 2 - kx**2 + 0j) for c in (1480.0, 5900.0, 3200.0))
    front, behind = 1j * kz * (1 - ds.r.values) / 1000.0, 1j * (a * ds.t_p.values + kx * ds.t_s.values) / 7900.0
    assert abs(front - behind).max() < 1e-12 * abs(front).max()
    shear = -2 * kx * a * ds.t_p.values + (b**2 - kx**2) * ds.t_s.values
    assert abs(shear).max() < 1e-12 * abs(kx * a * ds.t_p.values).max()


def test_with_little_shear_the_half_space_is_a_fluid():
    fluid = bp.scattering(bp.Slab.interface(WATER, bp.Fluid.from_speed(1200.0, 1600 - 16j)), 1e6, angle=[10.0, 40.0])
    solid = bp.scattering(bp.Slab.interface(WATER, bp.Solid(1200.0, 1600 - 16j, 1e-6 - 5e-7j)), 1e6, angle=[10.0, 40.0])
    for name in ("r", "t", "energy_transmission"):
        assert abs(solid[name] - fluid[name]).max() < 1e-12
    assert abs(solid.t_p - fluid.t).max() < 1e-12


@pytest.mark.parametrize(
    ("solid", "rayleigh", "scholte"),
    [(STEEL, 0.499147 + 0.005282j, 1479.606), (ALUMINIUM, 0.504532 + 0.014691j, 1476.765), (BRASS, 0.720243 + 0.012026j, 1477.496)],
)  # fmt: skip
def test_leaky_rayleigh_and_scholte_waves(solid, rayleigh, scholte):
    """Figures computed elsewhere by bisection of the Scholte and the leaky Rayleigh equation."""
    ds = bp.guided_modes(bp.Slab.interface(WATER, solid), 3e6, strip_over_k0=0.02, leaky=True)
    k = ds.kx_over_k0.values
    assert k.size == int(ds["count"]) == 2
    assert abs(k[0] - rayleigh) < 1e-6
    assert 1480.0 / k[1].real == pytest.approx(scholte, abs=1e-3)
    assert list(ds.direction.values) == [1, 1]


def test_acrylic_has_no_leaky_rayleigh_wave():
    ds = bp.guided_modes(
        bp.Slab.interface(WATER, bp.Solid(1180.0, 2700.0, 1340.0)), 3e6, strip_over_k0=0.02, leaky=True
    )
    assert 1480.0 / ds.kx_over_k0.values.real == pytest.approx([1029.366], abs=1e-3)


COATED = bp.Slab([bp.Layer(WATER, 1e-3), bp.Layer(ALUMINIUM, 3e-4)], before=WATER, after=STEEL)


def test_rounding_errors_are_sought_in_solids_in_contact_too():
    """A slab moved by little to show its error moves the solids that belong to the half-space."""
    s = sample(COATED, 1e6)
    densities = [v.after.run[0].layers.density for v in (s, s.perturbed(1e-9), s.rounded())]
    densities.append(solid_half_space.moved(s.after, 1e-9).run[0].layers.density)
    apart = [float(abs(v / densities[0] - 1).max()) for v in densities[1:]]
    assert 0 < min(apart) <= max(apart) < 1e-8


# --- beams -----------------------------------------------------------------------------------------------------

BEAM = bp.GaussianBeam(8e-3, angle=20.0, z0=-2e-3)


def test_the_same_power_passes_through_all_planes_in_layers_and_behind():
    """In solids it is Re(p v_z* - s_xz v_x*)/2: without the shear stress it would differ from plane to plane."""
    z = [-1e-3, 0.0, 1.5e-4, 1e-3, 1.4e-3, 2e-3, 6.5e-3, LAYERED.thickness, 9e-3]
    ds = bp.field(LAYERED, BEAM, 1e6, 0.0, z, variables=["power_through"])
    assert np.ptp(ds.power_through.values) < 1e-9 * float(ds.power_through.max())
    power = bp.beam_measures(COATED, bp.GaussianBeam(8e-3, angle=5.0), 1e6).power
    assert float(power.sum()) == pytest.approx(1, abs=1e-9)


def test_a_last_layer_of_the_half_spaces_solid_changes_nothing():
    x, z = np.linspace(-0.02, 0.02, 21), np.linspace(-1e-3, 12e-3, 27)
    longer = LAYERED + bp.Slab(bp.Layer(ALUMINIUM, 3e-3), before=WATER, after=ALUMINIUM)
    fields = [bp.field(slab, BEAM, 1e6, x, z, variables=["p", "v_x", "v_z"]) for slab in (LAYERED, longer)]
    for name in ("p", "v_x", "v_z"):
        assert float(abs(fields[0][name] - fields[1][name]).max()) < 1e-9 * float(abs(fields[0][name]).max())


def test_fields_behind_obey_the_equations_of_elasticity():
    """-s_zz by differences of displacements, behind the far face."""
    w, h, z = 2 * np.pi * 1e6, 1e-6, LAYERED.thickness + 1e-3
    L, lam = 2700 * 6320.0**2, 2700 * (6320.0**2 - 2 * 3130.0**2)
    ds = bp.field(
        LAYERED, BEAM, 1e6, [1e-3 - h, 1e-3, 1e-3 + h], [z - h, z, z + h], rtol=1e-10, variables=["p", "v_x", "v_z"]
    )
    p, v_x, v_z = (ds[name].values for name in ("p", "v_x", "v_z"))
    stretched = L * (v_z[2, 1] - v_z[0, 1]) + lam * (v_x[1, 2] - v_x[1, 0])
    assert -p[1, 1] == pytest.approx(1j / w * stretched / (2 * h), rel=1e-4)


def test_datasets_and_questions_of_many_frequencies_take_half_spaces():
    ds = bp.scattering(LAYERED, 1e6, angle=[0.0, 20.0])
    assert bp.provenance(ds)["slab"] == LAYERED
    f, beam = [0.9e6, 1e6, 1.1e6], bp.GaussianBeam(8e-3, angle=5.0)
    widths = bp.beam_width(COATED, beam, f).fwhm_out.values
    assert widths == pytest.approx([float(bp.beam_width(COATED, beam, g).fwhm_out) for g in f], rel=1e-6)


def test_finite_elements_refuse_a_solid_behind():
    pytest.importorskip("skfem")
    slab = bp.Slab(bp.Layer(WATER, 1e-3), before=WATER, after=STEEL)
    with pytest.raises(ValueError, match="slab: finite elements take a fluid behind, got Solid"):
        bp.fem.field(slab, BEAM, 1e6, [0.0], [0.0], period=0.1)


def test_displacements_and_shear_stress_obey_the_equations_of_elasticity():
    """s_xz = mu (du_x/dz + du_z/dx) by differences in a layer and behind; 0 in the water and on its faces."""
    h, mu, w = 1e-6, 2700 * 3130.0**2, 2 * np.pi * 1e6
    for z in (1.5e-4, LAYERED.thickness + 1e-3):
        around = [z - h, z, z + h]
        ds = bp.field(
            LAYERED, BEAM, 1e6, [1e-3 - h, 1e-3, 1e-3 + h], around, rtol=1e-10, variables=["v_x", "u_x", "u_z", "s_xz"]
        )
        u_x, u_z, s_xz, v_x = (ds[name].values for name in ("u_x", "u_z", "s_xz", "v_x"))
        sheared = u_x[2, 1] - u_x[0, 1] + u_z[1, 2] - u_z[1, 0]
        assert s_xz[1, 1] == pytest.approx(mu * sheared / (2 * h), rel=1e-4)
        assert v_x == pytest.approx(-1j * w * u_x)
    s_xz = bp.field(LAYERED, BEAM, 1e6, 1e-3, [-1e-3, 0.0, 1e-4, 3e-4, 1e-3], variables="s_xz").s_xz.values
    assert abs(s_xz[[0, 1, 3, 4]]).max() < 1e-9 * abs(s_xz[2])
    fluids = bp.field(bp.Slab(bp.Layer(WATER, 1e-3), background=WATER), BEAM, 1e5, 0.0, [0.0, 1e-3], variables="s_xz")
    assert not fluids.s_xz.any()
    assert not fluids.error_estimate_s_xz.any()


def test_the_angle_of_leaky_rayleigh_waves():
    """Angles of the poles computed elsewhere; a shear wave slower than sound has none."""
    for solid, angle in ((STEEL, 29.94), (bp.Solid(7900.0, 5790.0, 3100.0), 30.97), (ALUMINIUM, 30.30)):
        assert bp.rayleigh_angle(WATER, solid) == pytest.approx(angle, abs=6e-3)
    with pytest.raises(ValueError, match="solid: expected one with a leaky Rayleigh wave"):
        bp.rayleigh_angle(WATER, bp.Solid(1180.0, 2700.0, 1340.0))


def test_the_rayleigh_angle_of_a_gas_too_light_to_load_the_face():
    """The pole lies on the real axis to rounding: the root of Rayleigh's cubic in (c/cT)^2, x^3 - 8 x^2 + (24 - 16 q) x - 16 (1 - q)."""
    c_l, c_t, c = 5960.0, 3235.0, 343.0
    q = (c_t / c_l) ** 2
    roots = np.roots([1, -8, 24 - 16 * q, -16 * (1 - q)])
    x = next(r.real for r in roots if abs(r.imag) < 1e-9 and 0 < r.real < 1)
    gas = bp.Fluid.from_speed(1e-5, c)
    assert bp.rayleigh_angle(gas, bp.Solid(7850.0, c_l, c_t)) == pytest.approx(
        np.degrees(np.arcsin(c / (c_t * np.sqrt(x)))), rel=1e-9
    )


def test_intensity_is_refused_in_solids():
    """p v lacks the part of the shear stress."""
    said = r"variables: expected an intensity at z in fluids .*got z = 0.0001 in a solid; power_through is"
    with pytest.raises(ValueError, match=said):
        bp.field(LAYERED, BEAM, 1e6, 0.0, [-1e-3, 1e-4], variables="intensity")
    with pytest.raises(ValueError, match="variables: expected an intensity at z in fluids"):
        bp.field(LAYERED, BEAM, 1e6, 0.0, LAYERED.thickness + 1e-3, variables="intensity")
    water = bp.field(LAYERED, BEAM, 1e6, 0.0, [1e-3, 3e-3], variables="intensity")
    assert float(water.intensity_z.min()) != 0


@pytest.mark.parametrize("y", [None, 0.0], ids=["2-D", "3-D"])
@pytest.mark.parametrize("in_front", [[], [bp.Layer(bp.Fluid.from_speed(900.0, 1400.0), 2.1e-3)]], ids=["none", "oil"])
def test_a_face_to_a_fluid_has_no_shear_stress(in_front, y):
    """Exactly none, as on faces of plates, of an estimate that keeps rtol; behind the face s_xz is not small."""
    slab = bp.Slab(in_front, before=WATER, after=STEEL) if in_front else bp.Slab.interface(WATER, STEEL)
    beam = bp.GaussianBeam(0.006 if y is None else (0.006, 0.006), angle=30.39, z0=-0.005)
    asked = {"variables": ["u_z", "s_xz"], "rtol": 1e-7, "y": y}
    ds = bp.field(slab, beam, 1e6, [0.0, 0.004], [slab.thickness, slab.thickness + 1e-3], **asked)
    assert not ds.s_xz[0].any()
    assert abs(ds.s_xz[1]).min() > 0.01
    alone = bp.field(slab, beam, 1e6, [0.0, 0.004], slab.thickness, **asked)
    for estimate in (ds.error_estimate_s_xz, alone.error_estimate_s_xz):
        assert float(estimate) < 1e-7


def test_a_face_to_a_solid_in_contact_has_shear_stress():
    """Continuous with that in front of it."""
    slab = bp.Slab(bp.Layer(ALUMINIUM, 2e-3), before=WATER, after=STEEL)
    z = slab.thickness + np.array([-1e-9, 0.0, 1e-9])
    s_xz = bp.field(slab, bp.GaussianBeam(0.006, 20.0, z0=-0.005), 1e6, 0.001, z, variables="s_xz").s_xz.values
    assert s_xz == pytest.approx(np.full(3, s_xz[1]), rel=1e-4)
    assert abs(s_xz[1]) > 0.01
