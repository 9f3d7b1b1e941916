"""Attenuation, models of fluids and membranes, hints: what is refused or hinted at, and what a file brings back."""

import dataclasses

import numpy as np
import pytest

import beamprop as bp

F = 2500.0
WATER = bp.Fluid.from_speed(1000.0, 1480.0)
CELL = bp.lmmd_cell()


# --- attenuation ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: bp.power_law(-1, 1e6), "^db_per_cm: expected a number of at least 0, got -1"),
        (lambda: bp.power_law(1, 0), "^reference_frequency: expected a finite number above zero"),
        (lambda: bp.power_law(1, 1e6, 5), "^exponent: expected a number from 0 to 4, got 5"),
        (lambda: bp.power_law(1, 1e6, 3, dispersion=True), "^exponent: expected a number above 0, of at most 2, with"),
        (lambda: bp.power_law(1, 1e6, dispersion=1), "^dispersion: expected True or False, got 1"),
        (lambda: bp.Fluid.from_speed(1e3, 1500, -1.0), "^attenuation: expected at least 0 Np/m .*, got -1"),
        (lambda: bp.Fluid.from_speed(1e3, 1500, 1j), "^attenuation: expected a real number"),
        (lambda: bp.Fluid.from_speed(1e3, 1500 - 1j, 1.0), "^sound_speed: expected a real number above zero beside an"),
        (lambda: bp.Fluid.from_speed(-1e3, 1500, 1.0), "^density: expected a real number above zero beside an atten"),
        (
            lambda: bp.Fluid.from_speed(1e3, 1500, lambda f: -f).at(1e6),
            "^attenuation: expected values of at least 0 Np/m, got -1e",
        ),
        (lambda: bp.Fluid.from_speed(1e3, 1500, lambda f: 1.0).at(np.ones(2)), "^attenuation: expected a function"),
        (
            lambda: bp.Fluid.from_speed(1e3, 1500, bp.power_law(100, 1e6, 1.0, dispersion=True)).at(
                np.array([1e6, 1e12])
            ),
            r"^attenuation: expected a dispersion that leaves a phase velocity above zero, got PowerLaw.* at 1e\+12 Hz",
        ),
        (lambda: bp.Tabulated([2.0, 1.0], [1, 1]), "^frequency: expected a 1-D array of finite, strictly increasing"),
        (lambda: bp.Tabulated([-2.0, 1.0], [1, 1]), "^frequency: expected frequencies above zero, got -2"),
        (lambda: bp.Tabulated([1.0, 2.0], [1, 1, 1]), "^values: expected one for each of 2 frequencies, got shape"),
        (lambda: bp.Tabulated([1.0, 2.0], [1, np.nan]), "^values: expected finite values"),
        (lambda: bp.Tabulated([1.0, 2.0], [1, 2])(3.0), "^frequency: this medium is known from 1.0 to 2.0 Hz only"),
    ],
)
def test_wrong_attenuations(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_gain_by_negative_attenuation():
    """Where it is asked for, as a number and as a function."""
    for attenuation in (-1.0, lambda f: -1.0 + 0 * f):
        fluid = bp.Fluid.from_speed(1e3, 1500.0, attenuation, active=True)
        assert fluid.at(1e6).bulk_modulus.imag > 0


def test_energies_in_a_material():
    """Half-spaces by name are lossless unless asked for, so that shares of energy have a meaning."""
    slab = bp.Slab.uniform(bp.material("liver", attenuation=True), 0.01, background=bp.material("water"))
    ds = bp.scattering(slab, 1e6, angle=[0, 30])
    assert np.all(ds.absorption > 0.05)


# --- models -----------------------------------------------------------------------------------------------


def jca(**changed):
    usual = {
        "flow_resistivity": 1e4,
        "porosity": 0.97,
        "tortuosity": 1.1,
        "viscous_length": 1e-4,
        "thermal_length": 2e-4,
    }
    return bp.johnson_champoux_allard(**(usual | changed))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        *[(lambda n=n: jca(**{n: 0}), f"^{n}: expected ") for n in ("flow_resistivity", "porosity", "viscous_length")],
        (lambda: jca(porosity=1.2), "^porosity: expected a number above 0, of at most 1, got 1.2"),
        (lambda: jca(tortuosity=0.5), "^tortuosity: expected a number of at least 1, got 0.5"),
        (lambda: jca(gas="air"), "^gas: expected a Gas, got 'air'"),
        (lambda: bp.Gas(viscosity=0), "^viscosity: expected a finite number above zero"),
        (lambda: bp.Gas(heat_capacity_ratio=0.5), "^heat_capacity_ratio: expected a number of at least 1"),
        (lambda: bp.delany_bazley_miki(-1), "^flow_resistivity: expected a finite number above zero"),
        (
            lambda: bp.delany_bazley_miki(1e4).at(99.0),
            "^frequency: expected 100 to 10000 Hz, where delany_bazley.* got 99",
        ),
        (
            lambda: bp.delany_bazley_miki(1e4).at(np.array([500, 2e4])),
            "^frequency: expected 100 to 10000 Hz, .* got 20000",
        ),
        (lambda: bp.narrow_slits(0), "^width: expected a finite number above zero"),
        (lambda: bp.narrow_slits(1e-3, 2.0), "^porosity: expected a number above 0, of at most 1, got 2"),
        (lambda: bp.narrow_tubes("a"), "^radius: expected a real number, got 'a'"),
        (lambda: bp.narrow_tubes(1e-3, gas=bp.AIR), "^gas: expected a Gas"),
        (lambda: bp.wood_mixture((WATER, 0.5)), "^parts: expected shares of the volume that add up to 1, got 0.5"),
        (lambda: bp.wood_mixture(WATER, 0.5), r"^parts: expected pairs \(Fluid, share of the volume\)"),
        (lambda: bp.wood_mixture((3, 1.0)), "^parts: expected a Fluid, got 3"),
        (lambda: bp.wood_mixture((bp.Fluid(1, 1e5, 2), 1.0)), "^parts: expected isotropic fluids, got Fluid"),
        (
            lambda: bp.wood_mixture((WATER, 1.1), (bp.AIR, -0.1)),
            "^parts: expected a finite number above zero, got -0.1",
        ),
        (lambda: bp.Membrane.drude(0, 1.0), "^areal_density: expected a finite number above zero"),
        (lambda: bp.Membrane.drude(1.0, 700.0, -1.0), "^linewidth: expected a number of at least 0, got -1"),
        (lambda: bp.Membrane.lorentz(1.0, -5.0, 1.0), "^resonance_frequency: expected a finite number above zero"),
        (lambda: bp.Membrane.lorentz(1.0, 5.0, 1.0).at(np.array([5.0])), "^areal_density: expected finite values"),
    ],
)
def test_wrong_models(make, message):
    with pytest.raises(ValueError, match=message):
        make()


# --- hints ------------------------------------------------------------------------------------------------

ULTRASOUND = 1e6
PLATE = bp.Slab.uniform(bp.material("water"), 1e-3)
WIDE = bp.GaussianBeam(9.6, z0=-0.1)


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (
            lambda: bp.Fluid(1.25, 343.0),
            r"^bulk_modulus: 343 Pa looks like a sound speed, which Fluid.from_speed\(1.25, 343",
        ),
        (lambda: bp.Fluid(1000, 1500), "^bulk_modulus: 1500 Pa looks like a sound speed"),
        (lambda: bp.Fluid(7850, 5960), "^bulk_modulus: 5960 Pa looks like a sound speed"),
        (lambda: bp.lmmd_cell(eta=60), "^eta: 60 wavelengths a period; for 60 periods a wavelength give eta=1/60"),
        (
            lambda: bp.scattering(PLATE, ULTRASOUND, angle=0),
            "^before, after: air, for none was given, around layers like",
        ),
        (lambda: bp.beam_width(PLATE, bp.GaussianBeam(0.01), ULTRASOUND, rtol=1e-3), "^before, after: air"),
        (lambda: bp.beam_measures(PLATE, bp.GaussianBeam(0.01), ULTRASOUND, rtol=1e-3), "^before, after: air"),
        (lambda: bp.field(PLATE, bp.GaussianBeam(0.01), ULTRASOUND, 0.0, 0.0, rtol=1e-3), "^before, after: air"),
        (
            lambda: bp.field(bp.Slab(CELL, 20), WIDE, F, np.linspace(-1.4, 1.4, 101), 0.1),
            "^fwhm: 9.6 m is 70 wavelengths, and x spans 2.8 m: is it in metres",
        ),
        (
            lambda: bp.beam_width(bp.Slab(CELL, 450), WIDE, F),
            r"^fwhm: 9.6 m is 70 wavelengths, and the slab is 1\.\d+ m thick: is",
        ),
    ],
)
@pytest.mark.filterwarnings("ignore::RuntimeWarning", "ignore::beamprop.AccuracyWarning")
def test_a_likely_slip_is_hinted_at(ask, message):
    """One hint, at the line that the user wrote; the answer is given all the same."""
    with pytest.warns(bp.HintWarning, match=message) as caught:
        assert ask() is not None
    hints = [w for w in caught if w.category is bp.HintWarning]
    assert [w.filename for w in hints] == [__file__]


def test_what_is_meant_is_not_hinted_at():
    """Warnings are errors here: half-spaces that are given, audible frequencies, plates, soft media, gases of low pressure."""
    water = bp.material("water")
    for sides in ({"background": bp.AIR}, {"background": water}, {"before": bp.AIR}, {"after": water}):
        bp.scattering(bp.Slab.uniform(water, 1e-3, **sides), ULTRASOUND, angle=0)
    bp.scattering(bp.Slab.uniform(water, 0.05), F, angle=0)
    bp.scattering(bp.Slab([bp.Layer(bp.AIR, 1e-3), bp.Layer(water, 1e-3)]), ULTRASOUND, angle=0)
    bp.scattering(bp.Slab.uniform(bp.material("steel"), 1e-3), ULTRASOUND, angle=0)
    for density, modulus in (
        (1.25, 1.4e5),
        (1.0, 1.0),
        (0.012, 1400.0),
        (1000.0, 1e5),
        (300.0, 3000.0),
        (1.2, 343 - 5j),
    ):
        bp.Fluid(density, modulus)
    bp.lmmd_cell(eta=0.5)
    bp.lmmd_cell(eta=1.5)
    bp.field(bp.Slab.uniform(bp.AIR, 0.1), WIDE, F, np.linspace(-10, 10, 101), 0.1, rtol=1e-4)
    bp.field(bp.Slab.uniform(bp.AIR, 0.1), WIDE, F, 0.0, 0.1, rtol=1e-4)
    closely = np.linspace(-1e-3, 1e-3, 101)  # into the middle of a beam of 34 wavelengths
    bp.field(bp.Slab.interface(water, water), bp.GaussianBeam(0.05), ULTRASOUND, closely, 0.0, rtol=1e-4)


# --- what files record ------------------------------------------------------------------------------------

RECORDED = {
    "power law": bp.Fluid.from_speed(1e3, 1500.0, bp.power_law(0.5, 1e6, 1.1, dispersion=True)),
    "constant attenuation": bp.Fluid.from_speed(1e3, 1500.0, 5.0),
    "tabulated attenuation": bp.Fluid.from_speed(1e3, 1500.0, bp.Tabulated([1e3, 1e4], [1.0, 2.0])),
    "water": bp.material("water", temperature=30, attenuation=True),
    "air": bp.material("air", humidity=20, attenuation=True),
    "liver": bp.material("liver", attenuation=True),
    "johnson_champoux_allard": jca(),
    "delany_bazley_miki": bp.delany_bazley_miki(2e4),
    "narrow_slits": bp.narrow_slits(1e-3, 0.5, bp.Gas(density=1.1)),
    "narrow_tubes": bp.narrow_tubes(1e-3),
    "wood_mixture": bp.wood_mixture((bp.material("water", attenuation=True), 0.9), (bp.AIR, 0.1)),
}


@pytest.mark.parametrize("name", RECORDED)
def test_provenance_rebuilds_the_medium(name):
    """The record makes an equal slab; a medium is hashable, and cannot be changed."""
    fluid = RECORDED[name]
    sheets = bp.Membrane.drude(0.1, 3000.0, 10.0), bp.Membrane.lorentz(0.1, 2000.0, 0.2, 10.0)
    slab = bp.Slab([bp.Layer(fluid, 0.1), *sheets], background=fluid)
    assert bp.provenance(bp.scattering(slab, [F, 2600.0], kx=1.0))["slab"] == slab
    assert len({fluid, RECORDED[name]}) == 1
    assert "object at 0x" not in repr(fluid)
    for part in (fluid.density, fluid.bulk_modulus):
        if dataclasses.is_dataclass(part):
            with pytest.raises(dataclasses.FrozenInstanceError):
                part.density = 1.0


@pytest.mark.parametrize("name", sorted(set(RECORDED) - {"tabulated attenuation"}))
def test_media_are_analytic_in_frequency(name):
    """The derivatives along the real and the imaginary axis agree, at a complex frequency: so do kernels take them."""
    fluid, f, step = RECORDED[name], 3000.0 + 200.0j, 0.5
    for prop in ("rho_z", "bulk_modulus"):
        at = {d: getattr(fluid.at(np.array(f + d)), prop) for d in (step, -step, 1j * step, -1j * step)}
        along, across = at[step] - at[-step], (at[1j * step] - at[-1j * step]) / 1j
        assert abs(along - across) <= 1e-4 * abs(along) + 1e-13 * abs(at[step])
