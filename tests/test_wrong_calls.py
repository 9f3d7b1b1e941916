"""Wrong calls of Python, as a new user writes them, each with the whole message that it must give: one sentence, by the argument's own name."""

import os

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr

import beamprop as bp

#: What the calls name.
NAMES = {
    "bp": bp,
    "np": np,
    "xr": xr,
    "nan": float("nan"),
    "inf": float("inf"),
    "air": bp.AIR,
    "cell": bp.lmmd_cell(),
    "slab": bp.Slab(bp.lmmd_cell(), 20),
    "beam": bp.GaussianBeam(0.1, z0=-0.05),
    "x": np.linspace(-0.6, 0.6, 61),
    "z": [0.1],
}
FILES = {"letters.txt": "0 1\n0.1 a\n", "layers.csv": "thickness_mm,material\n2,water\n1,unobtainium\n"}

WRONG = [
    ('bp.Fluid("a", 1e5)', "density: expected a number or a function of frequency, got 'a'"),
    ("bp.Fluid(None, 1e5)", "density: expected a number or a function of frequency, got None"),
    ("bp.Fluid([1.0], 1e5)", "density: expected a number or a function of frequency, got [1.0]"),
    ("bp.Fluid(nan, 1e5)", "density: expected finite values, got nan"),
    (
        "bp.Fluid(1 - 1j, 1e5)",
        "density: expected a passive medium, Im(density) >= 0 with exp(-i w t), got (1-1j); pass active=True for a medium with gain",
    ),
    ("bp.Fluid(True, 1e5)", "density: expected a number or a function of frequency, got True"),
    ("bp.Fluid(1.2, 0)", "bulk_modulus: expected a value other than zero, got 0"),
    (
        "bp.Fluid(1.2, 1e5 + 1j)",
        "bulk_modulus: expected a passive medium, Im(bulk_modulus) <= 0 with exp(-i w t), got (100000+1j); pass active=True for a medium with gain",
    ),
    (
        "bp.Fluid(1.2, 1e5, 0)",
        "density_x: expected a value other than zero, which has no finite limit beside a density, got 0",
    ),
    ("bp.Fluid(1.2, 1e5, active=1)", "active: expected True or False, got 1"),
    (
        "bp.Fluid(1e80, 1e5)",
        "density: expected a magnitude of 1e-50 to 1e+50, which double precision can compute with, got 1e+80",
    ),
    ("bp.Fluid.from_speed(0, 343)", "density: expected a finite number other than zero beside a speed, got 0"),
    ("bp.Fluid.from_speed(1.2, 0)", "sound_speed: expected a finite number other than zero, got 0"),
    ('bp.Fluid.from_speed(1.2, "fast")', "sound_speed: expected a number, got 'fast'"),
    ("bp.Fluid.from_speed(1.2, inf)", "sound_speed: expected a finite number other than zero, got inf"),
    (
        "bp.Fluid.from_speed(1.2, 343, attenuation=-1)",
        "attenuation: expected at least 0 Np/m (active=True allows gain), got -1.0",
    ),
    (
        "bp.Fluid.from_speed(1.2, 343 + 1j, attenuation=1)",
        "sound_speed: expected a real number above zero beside an attenuation, got (343+1j)",
    ),
    ("bp.power_law(-1, 1e6)", "db_per_cm: expected a number of at least 0, got -1"),
    ("bp.power_law(1, 0)", "reference_frequency: expected a finite number above zero, got 0.0"),
    ('bp.power_law("a", 1e6)', "db_per_cm: expected a real number, got 'a'"),
    (
        'bp.material("unobtainium")',
        "name: expected a material of beamprop.materials(), such as 'titanium', got 'unobtainium'",
    ),
    ('bp.material("stel")', "name: expected a material of beamprop.materials(), such as 'steel', got 'stel'"),
    ("bp.material(3)", "name: expected the name of a material, got 3"),
    ('bp.material("water", temperature=200)', "temperature: expected 0 to 95 Celsius, where the fits hold, got 200.0"),
    (
        'bp.material("steel", temperature=20)',
        "temperature: expected nothing, for steel is known at room temperature only, got 20",
    ),
    (
        "bp.Tabulated([1, 1], [2, 3])",
        "frequency: expected a 1-D array of finite, strictly increasing positions, got [1, 1]",
    ),
    ("bp.Tabulated([1, 2], [2, 3, 4])", "values: expected one for each of 2 frequencies, got shape (3,)"),
    ("bp.Layer(1.2, 0.1)", "fluid: expected a Fluid or a Solid, got 1.2"),
    ("bp.Layer(air, 0)", "thickness: expected a finite number above zero, got 0.0"),
    ("bp.Layer(air, -0.1)", "thickness: expected a finite number above zero, got -0.1"),
    ('bp.Layer(air, "2mm")', "thickness: expected a real number, got '2mm'"),
    ("bp.Layer(air, [0.1])", "thickness: expected a real number, got [0.1]"),
    ("bp.Layer(air, nan)", "thickness: expected a finite number above zero, got nan"),
    ('bp.Membrane("a")', "areal_density: expected a number or a function of frequency, got 'a'"),
    (
        "bp.Membrane(-1j)",
        "areal_density: expected a passive medium, Im(areal_density) >= 0 with exp(-i w t), got (-0-1j); pass active=True for a medium with gain",
    ),
    ("bp.Cell([])", "layers: expected at least one Layer or Membrane, got none"),
    ("bp.Cell(3)", "layers: expected a sequence of Layer, got 3"),
    ("bp.Cell([air])", "layers: expected Layer objects, got Fluid(density=1.25, bulk_modulus=147061)"),
    ("bp.Slab(3)", "cell: expected a Cell, got 3"),
    ("bp.Slab(air)", "cell: expected a Cell, got Fluid(density=1.25, bulk_modulus=147061)"),
    ("bp.Slab(cell, 0)", "periods: expected a whole number of at least 1, got 0"),
    ("bp.Slab(cell, 1.5)", "periods: expected a whole number of at least 1, got 1.5"),
    ('bp.Slab(cell, "many")', "periods: expected a whole number of at least 1, got 'many'"),
    ("bp.Slab(cell, True)", "periods: expected a whole number of at least 1, got True"),
    ("bp.Slab(cell, before=1.2)", "before: expected a Fluid, got 1.2"),
    ('bp.Slab(cell, background="water")', "background: expected a Fluid, got 'water'"),
    (
        "bp.Slab(cell, after=bp.Fluid(0, 1e5))",
        "after: expected a half-space of a density other than zero, got Fluid(density=0, bulk_modulus=100000)",
    ),
    ("bp.Slab.uniform(air, 0)", "thickness: expected a finite number above zero, got 0.0"),
    ("bp.Slab.stack([])", "segments: expected at least one (cell, periods) pair, got none"),
    ("bp.Slab.stack([cell])", "segments: expected (Cell, periods) pairs, got [Cell(10 layers, 0.00228667 m)]"),
    ("bp.Slab.stack([(cell, 0)])", "periods: expected a whole number of at least 1, got 0"),
    (
        'bp.Slab.from_table("layers.csv")',
        "material, row 2: expected a material of beamprop.materials(), such as 'titanium', got 'unobtainium'",
    ),
    ("bp.Slab.from_table(3)", "table: expected the path of a file, got 3"),
    ('bp.lmmd_cell(rho_m="a")', "rho_m: expected a number, got 'a'"),
    ("bp.lmmd_cell(rho_m=nan)", "rho_m: expected a finite number, got nan"),
    (
        "bp.lmmd_cell(0.05 - 0.05j)",
        "rho_m, delta_rho: expected a passive medium, Im(density) >= 0 in every layer and so Im(rho_m) >= |delta_rho|, got 0.05-0.05j and 0.025; lossless=True drops both losses",
    ),
    (
        "bp.lmmd_cell(0.05)",
        "rho_m, delta_rho: expected a passive medium, Im(density) >= 0 in every layer and so Im(rho_m) >= |delta_rho|, got 0.05 and 0.025; lossless=True drops both losses",
    ),
    ("bp.lmmd_cell(delta_rho=0.1j)", "delta_rho: expected a real number, got 0.1j"),
    ("bp.lmmd_cell(n_layers=0)", "n_layers: expected a whole number of at least 1, got 0"),
    ("bp.lmmd_cell(n_layers=2.5)", "n_layers: expected a whole number of at least 1, got 2.5"),
    ("bp.lmmd_cell(eta=0)", "eta: expected a finite number above zero, got 0.0"),
    ('bp.lmmd_cell(eta="1/60")', "eta: expected a real number, got '1/60'"),
    ("bp.lmmd_cell(design_frequency=-1)", "design_frequency: expected a finite number above zero, got -1.0"),
    ('bp.lmmd_cell(background="air")', "background: expected a Fluid, got 'air'"),
    ('bp.lmmd_cell(lossless="no")', "lossless: expected True or False, got 'no'"),
    (
        "bp.standard_emt(slab)",
        "cell: expected a Cell, got Slab(20 x Cell(10 layers, 0.00228667 m), before=Fluid(density=1.25, bulk_modulus=147061), after=Fluid(density=1.25, b...",
    ),
    ("bp.lmmd_emt(3)", "cell: expected a Cell, got 3"),
    ("bp.lmmd_emt_slab(cell)", "slab: expected a Slab, got Cell(10 layers, 0.00228667 m)"),
    ('bp.GaussianBeam("wide")', "fwhm: expected a real number, got 'wide'"),
    ("bp.GaussianBeam(0)", "fwhm: expected a finite number above zero, got 0.0"),
    ("bp.GaussianBeam(-0.1)", "fwhm: expected a finite number above zero, got -0.1"),
    ("bp.GaussianBeam([0.1, 0.2, 0.3])", "fwhm: expected a width, or two widths along x and y, got [0.1, 0.2, 0.3]"),
    ("bp.Piston(-1)", "radius: expected a finite number above zero, got -1.0"),
    (
        "bp.Solid(7900, 3200, 5900)",
        "longitudinal_speed: expected a stable solid, longitudinal_speed^2 > 4/3 shear_speed^2, got a bulk modulus of -2.85769e+11 Pa; active=True allows it",
    ),
    ("bp.GaussianBeam(0.1, angle=90)", "angle: expected degrees from the normal, between -90 and 90, got 90.0"),
    ("bp.GaussianBeam(0.1, angle=nan)", "angle: expected a finite number, got nan"),
    ("bp.GaussianBeam(0.1, z0=0.1)", "z0: expected a launch plane in front of the slab, z0 <= 0, got 0.1"),
    ("bp.GaussianBeam(0.1, x0=inf)", "x0: expected a finite number, got inf"),
    ('bp.GaussianBeam(0.1, width_of="power")', "width_of: expected 'pressure' or 'intensity', got 'power'"),
    ('bp.GaussianBeam(0.1, form="tilted")', "form: expected 'launch' or 'rotated', got 'tilted'"),
    ("bp.Profile([0, 1], [1])", "p: expected an array of x's shape (2,), got (1,)"),
    ("bp.Profile([1, 0], [1, 1])", "x: expected a 1-D array of finite, strictly increasing positions, got [1, 0]"),
    ("bp.Profile([0], [1])", "x: expected a 1-D array of at least 2 positions, got shape (1,)"),
    ("bp.Profile([0, 1], [0, 0])", "p: expected a profile that is not zero everywhere, got zeros"),
    ("bp.Profile([0, 1], [1, nan])", "p: expected finite values, got NaN or infinity"),
    ('bp.Profile("a", [1, 1])', "x: expected a 1-D array of finite, strictly increasing positions, got 'a'"),
    ("bp.Profile.from_file(3)", "path: expected the path of a file, got 3"),
    (
        'bp.Profile.from_file("letters.txt")',
        "letters.txt, line 2: expected 2 or 3 numbers (x, Re p, Im p), got '0.1 a'",
    ),
    ("bp.Profile.from_data([1, 2])", "profile: expected a DataArray along x, got list"),
    ("bp.Slits(0, 1)", "width: expected a finite number above zero, got 0.0"),
    ("bp.Slits(0.1, 0.05)", "separation: expected at least the slits' width 0.1, got 0.05"),
    ("bp.Slits(0.1, 0.2, 0)", "count: expected a whole number of at least 1, got 0"),
    ("bp.scattering(cell, 2500, angle=0)", "slab: expected a Slab, got Cell(10 layers, 0.00228667 m)"),
    ("bp.scattering(slab, 0, angle=0)", "frequency: expected values above zero, got 0.0"),
    ("bp.scattering(slab, -1, angle=0)", "frequency: expected values above zero, got -1.0"),
    ('bp.scattering(slab, "2500", angle=0)', "frequency: expected a number or a 1-D array of numbers, got '2500'"),
    ("bp.scattering(slab, [], angle=0)", "frequency: expected a number or a 1-D array of at least one, got shape (0,)"),
    (
        "bp.scattering(slab, [[1.0]], angle=0)",
        "frequency: expected a number or a 1-D array of at least one, got shape (1, 1)",
    ),
    ("bp.scattering(slab, 2500)", "kx, kx_over_k0, angle: expected exactly one of them, got none"),
    ("bp.scattering(slab, 2500, kx=0, angle=0)", "kx, kx_over_k0, angle: expected exactly one of them, got kx, angle"),
    ("bp.scattering(slab, 2500, angle=95)", "angle: expected degrees from -90 to 90, got 95.0"),
    ("bp.scattering(slab, 2500, angle=[0, nan])", "angle: expected finite values, got nan"),
    ("bp.scattering(slab, 2500, kx=[0, inf])", "kx: expected finite values, got inf"),
    ("bp.scattering(slab, 1j, kx=0)", "frequency: expected real numbers, got complex ones"),
    (
        "bp.bloch(slab, 2500, kx=0)",
        "cell: expected a Cell, got Slab(20 x Cell(10 layers, 0.00228667 m), before=Fluid(density=1.25, bulk_modulus=147061), after=Fluid(density=1.25, b...",
    ),
    ("bp.bloch(cell, 2500, kx=1j)", "kx: expected real values, got complex ones"),
    ("bp.bloch(cell, 2500)", "kx, kx_over_k0: expected exactly one of them, got none"),
    ("bp.bloch(cell, 2500, kx_over_k0=0, background=3)", "background: expected a Fluid, got 3"),
    ("bp.field(cell, beam, 2500, x, z)", "slab: expected a Slab, got Cell(10 layers, 0.00228667 m)"),
    ("bp.field(slab, 0.1, 2500, x, z)", "beam: expected a Beam (GaussianBeam, Profile, Slits), got 0.1"),
    (
        "bp.field(slab, bp.GaussianBeam, 2500, x, z)",
        "beam: expected a Beam (GaussianBeam, Profile, Slits), got <class 'beamprop.sources.gaussian.GaussianBeam'>",
    ),
    ("bp.field(slab, beam, nan, x, z)", "frequency: expected finite values, got nan"),
    ("bp.field(slab, beam, 2500, [], z)", "x: expected a number or a 1-D array of at least one, got shape (0,)"),
    ("bp.field(slab, beam, 2500, [[0.0]], z)", "x: expected a number or a 1-D array of at least one, got shape (1, 1)"),
    ('bp.field(slab, beam, 2500, "x", z)', "x: expected a number or a 1-D array of numbers, got 'x'"),
    (
        "bp.field(slab, beam, 2500, x, -1)",
        "z: expected positions not in front of the launch plane z0 = -0.05, got -1.0",
    ),
    ("bp.field(slab, beam, 2500, x, [0.1, nan])", "z: expected finite values, got nan"),
    (
        "bp.field(slab, beam, 2500, x, z, angle=90)",
        "angle: expected degrees from the normal, between -90 and 90, got 90.0",
    ),
    ('bp.field(slab, beam, 2500, x, z, boundary="closed")', "boundary: expected 'open' or 'periodic', got 'closed'"),
    ("bp.field(slab, beam, 2500, x, z, period=1)", "period: expected none with boundary='open', got 1"),
    (
        'bp.field(slab, beam, 2500, x, z, boundary="periodic", period=0.05)',
        "period: expected a grid wide enough for the beam, got 0.05 m, at whose ends the launched |p| is still 0.84 of its largest",
    ),
    (
        'bp.field(slab, beam, 2500, [0, 0.1, 0.7], z, boundary="periodic")',
        "period: expected a length [m] with boundary='periodic' and an uneven x, got None",
    ),
    ("bp.field(slab, beam, 2500, x, z, rtol=0)", "rtol: expected a finite number above zero, got 0.0"),
    ("bp.field(slab, beam, 2500, x, z, rtol=1)", "rtol: expected a value from 1e-12 to 0.1, got 1"),
    (
        'bp.field(slab, beam, 2500, x, z, variables="q")',
        "variables: expected some of p, v_x, v_z, u_x, u_z, s_xz, intensity_x, intensity_z, power_through, intensity, got 'q'",
    ),
    (
        "bp.field(slab, beam, 2500, x, z, variables=[])",
        "variables: expected some of p, v_x, v_z, u_x, u_z, s_xz, intensity_x, intensity_z, power_through, intensity, got []",
    ),
    ('bp.field(slab, beam, 2500, x, z, progress="yes")', "progress: expected True, False or a function, got 'yes'"),
    (
        "bp.field(slab, beam, 2500, np.zeros(10**6), np.zeros(10**6))",
        "x: expected a question that fits into 1.07 GB of memory, got one that takes about 16 TB for 1e+12 values of p; ask for fewer points, or write the map to a file with save_field",
    ),
    (
        'bp.save_field("a.txt", slab, beam, 2500, x, z)',
        "path: expected an ending of .nc, .nc4, .netcdf, .h5, .zarr, got 'a.txt'",
    ),
    ('bp.save_field("a.nc", slab, beam, 2500, x, z, memory=0)', "memory: expected a finite number above zero, got 0.0"),
    (
        'bp.save_field("none/a.nc", slab, beam, 2500, x, z)',
        "path: expected a file in an existing folder, got 'none/a.nc'",
    ),
    ("bp.beam_width(slab, None, 2500)", "beam: expected a Beam (GaussianBeam, Profile, Slits), got None"),
    ("bp.beam_width(slab, beam, 2500, air_distance=-1)", "air_distance: expected a finite number above zero, got -1.0"),
    ('bp.beam_width(slab, beam, 2500, rtol="small")', "rtol: expected a real number, got 'small'"),
    ("bp.beam_measures(slab, beam, 2500, window=0)", "window: expected a finite number above zero, got 0.0"),
    ("bp.beam_measures(cell, beam, 2500)", "slab: expected a Slab, got Cell(10 layers, 0.00228667 m)"),
    ("bp.guided_modes(cell, 2500)", "slab: expected a Slab, got Cell(10 layers, 0.00228667 m)"),
    ("bp.guided_modes(slab, 2500, kx_over_k0_max=0)", "kx_over_k0_max: expected a finite number above zero, got 0.0"),
    ('bp.guided_modes(slab, 2500, 10, "wide")', "strip_over_k0: expected a real number, got 'wide'"),
    ("bp.fwhm([1, 2, 3])", "profile: expected a DataArray, got [1, 2, 3]"),
    ('bp.fwhm(xr.DataArray([1.0, 2.0], dims="y"))', "dim: expected one of y, got 'x'"),
    (
        'bp.fwhm(xr.DataArray([1.0, 2.0, 1.0], dims="x", coords={"x": [0, 1, 2]}), width_of="power")',
        "width_of: expected 'pressure' or 'intensity', got 'power'",
    ),
    ("bp.compare(1, 2)", "a: expected a dataset with the pressure p, got int"),
    ("bp.compare(field, 3)", "b: expected a dataset with the pressure p, got int"),
    ("bp.compare(field, field, rescale=2)", "rescale: expected True or False, got 2"),
    ('bp.load("none.nc")', "path: expected an existing file, got 'none.nc'"),
    ('bp.load("letters.txt")', "path: expected an ending of .nc, .nc4, .netcdf, .h5, .zarr, .mat, got 'letters.txt'"),
    ("bp.load(3)", "path: expected the path of a file, got 3"),
    ('bp.save(3, "a.nc")', "ds: expected a Dataset, got int"),
    ('bp.save(field, "a.xyz")', "path: expected an ending of .nc, .nc4, .netcdf, .h5, .zarr, .mat, got 'a.xyz'"),
    ('bp.save(field, "none/a.nc")', "path: expected a file in an existing folder, got 'none/a.nc'"),
    ("bp.save(field, 3)", "path: expected the path of a file, got 3"),
    (
        'bp.export(field, "a.csv")',
        "ds: expected one dimension, which a table has, got z 2, x 61: take one value by ds.isel(z=0), or write .nc or .mat",
    ),
    ('bp.export(field, "a.nc")', "path: expected an ending of .mat, .vti, .vtr, .csv, got 'a.nc'"),
    (
        'bp.read_comsol("letters.txt")',
        "letters.txt: expected a line that names the columns above the numbers, got none",
    ),
    ("bp.to_grid(field, [0, 1], [0, 1])", "ds: expected a dataset with the dim 'node', got z, x"),
    ("bp.provenance(3)", "ds: expected a Dataset, got 3"),
    ("bp.plot.field(3)", "ds: expected a Dataset, got 3"),
    (
        'bp.plot.field(field, quantity="angle")',
        "quantity: expected 'abs', 'real', 'phase', 'dB' or 'intensity', got 'angle'",
    ),
    ("bp.plot.field(field, floor=3)", "floor: expected a level below zero [dB], got 3.0"),
    ("bp.plot.field(field, width=3)", "width: expected at least 40 mm, got 3: 88 is one column, 180 is two"),
    ("bp.plot.field(field, limit=-1)", "limit: expected a finite number above zero, got -1.0"),
    (
        "bp.plot.width(field)",
        "ds: expected a dataset with fwhm_in, fwhm_out, fwhm_air, got one without fwhm_in, fwhm_out, fwhm_air",
    ),
    ("bp.plot.bloch(field)", "ds: expected a dataset with kz_over_k0, got one without kz_over_k0"),
    ("bp.plot.scattering(field)", "ds: expected a dataset with transmissivity, got one without transmissivity"),
    (
        'bp.plot.scattering(field, quantity="x")',
        "quantity: expected 'transmissivity', 'reflectivity', 'energy_transmission' or 'absorption', got 'x'",
    ),
    ("bp.plot.comparison(field)", "cmp_ds: expected a dataset from compare, got p, error_estimate"),
    ("bp.plot.field(field, ax=3)", "ax: expected Axes of matplotlib, got 3"),
    ("bp.fem.field(slab, 3, 2500, x, z, 1.0)", "beam: expected a Beam (GaussianBeam, Profile, Slits), got 3"),
    ("bp.fem.field(slab, beam, [1, 2], x, z, 1.0)", "frequency: expected a real number, got [1, 2]"),
    ("bp.fem.field(slab, beam, 2500, x, z, 0)", "period: expected a finite number above zero, got 0.0"),
]


@pytest.fixture(scope="module")
def field():
    return bp.field(NAMES["slab"], NAMES["beam"], 2500.0, NAMES["x"], [0.0, 0.1])


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The folder to be in, and a memory that does not depend on the machine."""
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("BEAMPROP_MEMORY", "1G")
    return tmp_path


@pytest.mark.parametrize(("call", "message"), WRONG)
def test_a_wrong_call(call, message, field, folder):
    """A ValueError of one line, and no file."""
    with mpl.rc_context({"backend": "agg"}), pytest.raises(ValueError) as refused:  # noqa: PT011 (the message is compared whole)
        eval(call, NAMES | {"field": field})
    assert type(refused.value) is ValueError
    assert str(refused.value) == message
    assert "\n" not in message
    assert sorted(os.listdir(folder)) == sorted(FILES)


def test_there_are_a_hundred():
    """Each written once."""
    assert len({call for call, _ in WRONG}) == len(WRONG) >= 100
