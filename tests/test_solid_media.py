"""Solids as media: what is refused, names, words and tables, records, Bloch waves, copies with errors."""

import numpy as np
import pytest

import beamprop as bp
from beamprop import parameters
from beamprop.response.sampled_slab import sample

WATER = bp.Fluid.from_speed(1000.0, 1480.0)
STEEL = bp.Solid(7900.0, 5900.0, 3200.0)
ALUMINIUM = bp.Solid(2700.0, 6320.0, 3130.0)
PLATE = bp.Slab(bp.Layer(STEEL, 1e-3), background=WATER)


# --- what is refused -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: bp.Solid(-7900, 5900, 3200), "density: expected a value above zero, got -7900; active=True allows it"),
        (lambda: bp.Solid(7900, 3200, 3200), "longitudinal_speed: expected a stable solid"),
        (lambda: bp.Solid(7900, 5900 + 1j, 3200), r"longitudinal_speed: expected a passive solid, Im\(bulk modulus\) <= 0"),
        (lambda: bp.Solid(7900, 5900, 3200 + 1j), r"shear_speed: expected a passive solid, Im\(shear modulus\) <= 0"),
        (lambda: bp.Solid(7900, 5900, 0), "shear_speed: expected a value other than zero"),
        (lambda: bp.Solid(np.nan, 5900, 3200), "density: expected finite values"),
        (lambda: bp.Solid.from_moduli(7900, 1e9, -1e9), "shear_modulus: expected a stable solid, with a shear modulus above zero, got -1e"),
        (lambda: bp.Solid(7900, 5900, 100j), "shear_speed: expected a stable solid, with a shear modulus above zero"),
        (lambda: bp.Slab.interface(STEEL, bp.AIR), "before: expected a Fluid"),
        (lambda: bp.Solid.from_moduli(7900, 0, 1e9), "bulk_modulus: expected a number other than zero"),
        (lambda: bp.Slab(bp.Layer(STEEL, 1e-3), before=STEEL), "before: expected a Fluid"),
        (lambda: bp.Slab([bp.Layer(STEEL, 1e-3), bp.Membrane(1.0), bp.Layer(STEEL, 1e-3)]), "layers: expected a membrane beside a fluid"),
        (lambda: bp.Slab([bp.Layer(STEEL, 1e-3), bp.Membrane(1.0)], after=STEEL), "layers: expected a membrane beside a fluid"),
        (lambda: bp.Slab(bp.Layer(STEEL, 1e-3), background=STEEL), "background: expected a Fluid"),
        (lambda: bp.Slab([bp.Layer(STEEL, 1e-3), bp.Membrane(1.0)], 2), "layers: expected a membrane beside a fluid"),
        (lambda: bp.standard_emt(bp.Cell(bp.Layer(STEEL, 1e-3))).at(1e6), "cell: a layer: expected a Fluid"),
    ],
)  # fmt: skip
def test_what_is_no_passive_stable_solid_between_fluids_is_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_moduli_and_speeds_are_the_same_solid():
    rho, bulk, shear = 7900.0, 1.671e11, 8.09e10
    by_moduli = bp.Solid.from_moduli(rho, bulk, shear)
    dispersive = bp.Solid.from_moduli(rho, lambda f: bulk + 0 * f, lambda f: shear + 0 * f)
    values = [solid.at(np.array([1e6])) for solid in (by_moduli, dispersive)]
    for v in values:
        assert complex(v.longitudinal_modulus[0]) == pytest.approx(bulk + 4 / 3 * shear, rel=1e-14)
        assert complex(v.shear_modulus[0]) == pytest.approx(shear, rel=1e-14)
    assert dispersive.dispersive


# --- by name, in words, in tables ------------------------------------------------------------------------------


def test_solids_by_name_in_words_and_in_tables(tmp_path):
    steel = bp.Solid.from_material("steel")
    assert parameters.layer("solid steel 1mm") == bp.Layer(steel, 1e-3)
    assert parameters.layer("density=7850 speed=5960 shear_speed=3235 1mm") == bp.Layer(steel, 1e-3)
    table = tmp_path / "layers.csv"
    table.write_text("thickness_mm,density,speed,shear_speed\n1,7850,5960,3235\n2,1000,1480,\n")
    assert bp.Slab.from_table(table).cell.layers == (
        bp.Layer(steel, 1e-3),
        bp.Layer(bp.Fluid.from_speed(1000, 1480), 2e-3),
    )
    with pytest.raises(ValueError, match=r"name: expected a material with a shear speed \(acrylic, .*got 'water'"):
        bp.Solid.from_material("water")


def test_datasets_tell_the_solids_they_are_of():
    dispersive = bp.Solid.from_moduli(1200.0, 5e9 - 1e8j, lambda f: 1.5e9 * (1 - 1e-8j * f))
    for solid in (STEEL, bp.Solid.from_moduli(1200.0, 5e9, 1.5e9)):
        slab = bp.Slab(bp.Layer(solid, 1e-3), background=WATER)
        assert bp.provenance(bp.scattering(slab, 1e6, angle=[0.0, 20.0]))["slab"] == slab
    slab = bp.Slab(bp.Layer(dispersive, 1e-3), background=WATER)
    again = bp.provenance(bp.scattering(slab, 1e6, angle=20.0))["slab"]
    assert complex(bp.scattering(again, 1e6, angle=20.0).t) == pytest.approx(
        complex(bp.scattering(slab, 1e6, angle=20.0).t), rel=1e-12
    )


def test_bloch_waves_of_a_cell_do_not_depend_on_where_it_begins():
    layers = [bp.Layer(STEEL, 1e-3), bp.Layer(WATER, 1e-3), bp.Layer(ALUMINIUM, 5e-4)]
    kx = np.linspace(0, 1.2, 25)
    kz = [bp.bloch(bp.Cell(layers[i:] + layers[:i]), 3e5, kx_over_k0=kx, background=WATER).kz.values for i in range(3)]
    for other in kz[1:]:
        assert abs(other - kz[0]).max() < 1e-9 * abs(kz[0]).max()
    # of many periods what passes decays by the imaginary part of kz
    t = [abs(complex(bp.scattering(bp.Slab(layers, n, background=WATER), 3e5, kx_over_k0=1.2).t)) for n in (40, 41)]
    assert np.log(t[0] / t[1]) == pytest.approx(kz[0][-1].imag * 2.5e-3, rel=1e-6)
    with pytest.raises(ValueError, match="cell: expected a fluid beside the solids of a cell"):
        bp.bloch(bp.Cell(layers[:1]), 3e5, kx=0.0)


def test_copies_with_errors_keep_the_moduli():
    copies = bp.tolerance(PLATE, density=0.1, count=2, seed=1)
    solid = copies[0].cell.layers[0].fluid
    ratio = solid.density.real / 7900
    assert ratio != 1
    assert solid.density * solid.shear_speed**2 == pytest.approx(7900 * 3200.0**2)


def test_finite_elements_refuse_solids():
    pytest.importorskip("skfem")
    with pytest.raises(ValueError, match="slab: finite elements take layers of fluid, got Solid"):
        bp.fem.field(PLATE, bp.GaussianBeam(0.01), 3e6, [0.0], [0.0], period=0.1)


def test_means_over_a_cell_with_solids():
    """Against 400 planes, whose rule is of second order at the kinks of p on faces."""
    slab = bp.Slab([bp.Layer(STEEL, 1e-3), bp.Layer(WATER, 2e-3)], 6, background=WATER)
    beam, x = bp.GaussianBeam(0.01, z0=-1e-3), np.linspace(-0.01, 0.01, 5)
    mean = bp.field(slab, beam, 3e5, x, [9e-3], average="cell").p.values[0]
    around = 7.5e-3 + (np.arange(400) + 0.5) * 3e-3 / 400
    assert abs(bp.field(slab, beam, 3e5, x, around).p.values.mean(axis=0) - mean).max() < 1e-5 * abs(mean).max()
    with pytest.warns(bp.HintWarning, match="steps of 0.0008 m skip through cells of 0.003 m"):
        bp.field(slab, beam, 3e5, x, 0.8e-3 * np.arange(22))
    with pytest.warns(bp.HintWarning, match=r"take z=bp.faces\(slab, ...\), or average='cell'$"):
        bp.field(slab, beam, 3e5, x, 0.8e-3 * np.arange(22), y=0.0, rtol=1e-4)


@pytest.mark.parametrize("after", [WATER, STEEL])
def test_added_loss_is_that_of_lossy_solids(after):
    """rho (1 + i loss), and moduli over 1 + i loss: what shows the direction of a mode takes energy away."""
    loss, kx = 0.03, 2 * np.pi * 1e6 / 1480 * np.linspace(0.05, 0.95, 10)

    def lossy(solid):
        rho, c_l, c_t = solid.density, solid.longitudinal_speed, solid.shear_speed
        speed = 1 / (1 + 1j * loss)  # sqrt of modulus over density
        return bp.Solid(rho * (1 + 1j * loss), c_l * speed, c_t * speed)

    water = bp.Fluid(1000.0 * (1 + 1j * loss), 1000.0 * 1480.0**2 / (1 + 1j * loss))
    plain = bp.Slab([bp.Layer(STEEL, 1e-3), bp.Layer(ALUMINIUM, 5e-4)], before=WATER, after=after)
    behind = water if after is WATER else lossy(STEEL)
    made = bp.Slab([bp.Layer(lossy(STEEL), 1e-3), bp.Layer(lossy(ALUMINIUM), 5e-4)], before=water, after=behind)
    added, given = (s.response(kx) for s in (sample(plain, 1e6).with_loss(loss), sample(made, 1e6)))
    assert abs(added.r - given.r).max() < 1e-12
    assert abs(added.t - given.t).max() < 1e-12
