"""Wrong commands, as a new user types them, each with the message that it must give: the whole of it, on one line, by the option's own name.

``...`` in the end stands for more: where the command's library says it, in words that change with its version, or where all that may be typed
is listed.
"""

import shlex

import pytest
from click.testing import CliRunner

from beamprop.cli import main

#: What stands in the folder in which the commands are typed; a name with / is a folder.
FILES = {
    "text.txt": "no numbers\n",
    "one.txt": "0 1\n",
    "letters.txt": "0 1\n0.1 a\n",
    "layers.csv": "thickness_mm,material\n2,water\n1,unobtainium\n",
    "header.csv": "thick,material\n2,water\n",
    "nothing.csv": "",
    "empty.nc/": None,
    "full.zarr/": None,
    "full.zarr/thesis.txt": "years of work",
}

WRONG = [
    ("feild", "No such command 'feild'..."),
    ("field --frequnecy 3", "No such option..."),
    ("field extra", "Got unexpected extra argument (extra)..."),
    ("field --fwhm", "Option '--fwhm' requires an argument..."),
    ("field --fwhm 0", "--fwhm: expected a finite number above zero, got 0.0"),
    ("field --fwhm -1mm", "--fwhm: expected a finite number above zero, got -0.001"),
    ("field --fwhm wide", "--fwhm: expected a length such as 0.002 or 2mm, got 'wide'"),
    ("field --fwhm nan", "--fwhm: expected a finite number above zero, got nan"),
    (
        "field --fwhm 1e-200",
        "--fwhm: expected a magnitude of 1e-50 to 1e+50, which double precision can compute with, got 1e-200",
    ),
    ("field --fwhm 5furlongs", "--fwhm: expected a length such as 0.002 or 2mm, got '5furlongs'"),
    ("field --angle 90", "--angle: expected degrees from the normal, between -90 and 90, got 90.0"),
    ("field --angle 0:95:3", "--angle: expected degrees from the normal, between -90 and 90, got 95.0"),
    ("field --angle 45deg", "--angle: expected a number, a,b,c or start:stop:count, got '45deg'"),
    ("field --angle 1:2", "--angle: expected a number, a,b,c or start:stop:count, got '1:2'"),
    ("field --angle 1:2:0", "--angle: expected a number, a,b,c or start:stop:count, got '1:2:0'"),
    ("field --angle ''", "--angle: expected a number, a,b,c or start:stop:count, got ''"),
    ("field --angle 1,,2", "--angle: expected a number, a,b,c or start:stop:count, got '1,,2'"),
    ("field --frequency -5", "--frequency: expected values above zero, got -5.0"),
    ("field --frequency 0", "--frequency: expected values above zero, got 0.0"),
    ("field --frequency nan", "--frequency: expected finite values, got nan"),
    (
        "field --frequency 1e60",
        "--frequency: expected a magnitude of 1e-50 to 1e+50, which double precision can compute with, got 1e+60",
    ),
    ("field --frequency 1kz", "--frequency: expected a number, a,b,c or start:stop:count, got '1kz'"),
    ("field --frequency 1:2:3:4", "--frequency: expected a number, a,b,c or start:stop:count, got '1:2:3:4'"),
    ("field --frequency 1:2:1.5", "--frequency: expected a number, a,b,c or start:stop:count, got '1:2:1.5'"),
    (
        "field --frequency 2000:3000:1000000000000",
        "--frequency: expected a question that fits into 1.07 GB of memory, got one that takes about 32 TB for the 1000000000000 numbers of '2000:3000:1000000000000'; take fewer",
    ),
    ("field --x nan --z 0", "--x: expected finite values, got nan"),
    (
        "field --x 0:1:1000000 --z 0:1:1000000",
        "--x: expected a question that fits into 1.07 GB of memory, got one that takes about 16 TB for 1e+12 values of p; ask for fewer points, or write the map to a file with --output and --memory",
    ),
    ("field --z=-1", "--z: expected positions not in front of the launch plane z0 = -0.1, got -1.0"),
    ("field --z 0,-0.5", "--z: expected positions not in front of the launch plane z0 = -0.1, got -0.5"),
    ("field --z0 0.1", "--z0: expected a launch plane in front of the slab, z0 <= 0, got 0.1"),
    ("field --x0 inf", "--x0: expected a finite number, got inf"),
    ("field --rtol 2", "--rtol: expected a value from 1e-12 to 0.1, got 2.0"),
    ("field --rtol 0", "--rtol: expected a finite number above zero, got 0.0"),
    ("field --rtol small", "--rtol: expected a number such as 0.05 or 1/60, got 'small'"),
    ("field --boundary closed", "--boundary: expected 'open' or 'periodic', got 'closed'"),
    ("field --period 1", "--period: expected none with boundary='open', got 1.0"),
    (
        "field --boundary periodic --period 1cm",
        "--period: expected a grid wide enough for the beam, got 0.01 m, at whose ends the launched |p| is still 0.99 of its largest",
    ),
    (
        "field --boundary periodic --x 0,0.1,0.5",
        "--period: expected a length [m] with boundary='periodic' and an uneven x, got none",
    ),
    ("field --form bent", "--form: expected 'launch' or 'rotated', got 'bent'"),
    ("field --width-of power", "--width-of: expected 'pressure' or 'intensity', got 'power'"),
    ("field --quantity phase", "--quantity: expected 'abs' or 'real', got 'phase'"),
    ("field --memory 1", "--memory: expected --output alone, for a map that is written and never held"),
    ("field --memory 0 -o a.nc", "--memory: expected a finite number above zero, got 0.0"),
    ("field --memory 1 -o a.nc --json", "--memory: expected --output alone, for a map that is written and never held"),
    (
        "field --variables q",
        "--variables: expected some of p, v_x, v_z, intensity_x, intensity_z, power_through, intensity, got 'q'",
    ),
    (
        "field --variables ''",
        "--variables: expected some of p, v_x, v_z, intensity_x, intensity_z, power_through, intensity, got ''",
    ),
    ("field --variables v_x --plot a.png", "--plot: expected p among --variables, got v_x"),
    (
        "field --slits 1mm",
        "--slits: expected width,separation or width,separation,count such as 10mm,40mm,2, got '1mm'",
    ),
    ("field --slits a,b", "--slits: expected a length such as 0.002 or 2mm, got 'a'"),
    ("field --slits 1mm,3mm,0", "--slits: expected a whole number of at least 1, got 0"),
    ("field --slits 5mm,1mm", "--slits: expected at least the slits' width 0.005, got 0.001"),
    ("field --slits 1mm,3mm --fwhm 1mm", "--fwhm: expected to be left out beside --slits, got 0.001"),
    (
        "field --profile none.txt",
        "--profile: expected a text file that can be read, got 'none.txt' (No such file or directory)",
    ),
    ("field --profile text.txt", "text.txt, line 1: expected 2 or 3 numbers (x, Re p, Im p), got 'no numbers'"),
    ("field --profile one.txt", "one.txt: expected at least 2 rows of x, Re p, Im p, got 1"),
    ("field --profile letters.txt", "letters.txt, line 2: expected 2 or 3 numbers (x, Re p, Im p), got '0.1 a'"),
    ("field --profile one.txt --slits 1mm,3mm", "--profile: expected to be left out beside --slits, got 'one.txt'"),
    ("field --profile one.txt --form rotated", "--form: expected to be left out beside --profile, got 'rotated'"),
    (
        "field --output a.txt",
        "--output: expected a name ending in .nc or .nc4 or .netcdf or .h5 or .zarr or .mat or .vti or .vtr or .csv, got 'a.txt'",
    ),
    (
        "field --output a",
        "--output: expected a name ending in .nc or .nc4 or .netcdf or .h5 or .zarr or .mat or .vti or .vtr or .csv, got 'a'",
    ),
    ("field --output none/a.nc", "--output: expected a file in an existing folder, got 'none/a.nc'"),
    ("field --output empty.nc", "--output: expected a file or a new name, got a folder: 'empty.nc'"),
    (
        "field --output full.zarr",
        "--output: expected a file or a Zarr store to replace, got a folder with other things in it: 'full.zarr'",
    ),
    ("field --output a.csv", "--output: expected one axis for a .csv, got --x and --z"),
    ("field --plot a.jpg", "--plot: expected a name ending in .png or .pdf, got 'a.jpg'"),
    ("field --plot a.nc", "--plot: expected a name ending in .png or .pdf, got 'a.nc'"),
    ("field --plot a.png --x 0", "--plot: expected axes for --x and --z, got one value"),
    ("field --plot a.png --frequency 1000,2000", "--plot: expected one frequency and one angle, got several"),
    ("beam_width --plot a.png --frequency 2500", "--plot: expected an axis for --frequency or --angle, got one value"),
    ("beam_width --air-distance -1", "--air-distance: expected a finite number above zero, got -1.0"),
    ("beam_width --output a.vti", "--output: expected a field for a .vti, got an answer without positions"),
    ("beam_width --output a.csv --angle 0,10", "--output: expected one axis for a .csv, got --frequency and --angle"),
    ("beam_width --rho-m x", "--rho-m: expected a number such as 0.05 or 0.05+0.05j, got 'x'"),
    (
        "beam_width --rho-m 0.05-0.05j",
        "--rho-m, --delta-rho: expected a passive medium, Im(density) >= 0 in every layer and so Im(rho_m) >= |delta_rho|, got 0.05-0.05j and 0.025; --lossless drops both losses",
    ),
    ("beam_width --delta-rho 0.1j", "--delta-rho: expected a number such as 0.05 or 1/60, got '0.1j'"),
    ("beam_width --delta-rho 1/0", "--delta-rho: expected a number such as 0.05 or 1/60, got '1/0'"),
    ("beam_width --n-layers 0", "--n-layers: expected a whole number of at least 1, got 0"),
    ("beam_width --n-layers 2.5", "--n-layers: expected a whole number of at least 1, got '2.5'"),
    ("beam_width --eta 0", "--eta: expected a finite number above zero, got 0.0"),
    ("beam_width --eta 1/60/2", "--eta: expected a number such as 0.05 or 1/60, got '1/60/2'"),
    ("beam_width --design-frequency 0", "--design-frequency: expected a finite number above zero, got 0.0"),
    ("beam_width --density 0", "--density: expected a finite number other than zero beside a speed, got 0.0"),
    ("beam_width --density nan", "--density: expected a finite number other than zero beside a speed, got nan"),
    ("beam_width --sound-speed 0", "--sound-speed: expected a finite number other than zero, got 0.0"),
    (
        "beam_width --sound-speed 343+5j",
        "--sound-speed: expected a passive medium, Im(bulk_modulus) <= 0 with exp(-i w t) and bulk_modulus = density * sound_speed^2, got (343+5j)",
    ),
    (
        "beam_width --sound-speed 343j",
        "--sound-speed: expected a fluid in which waves propagate, got Fluid(density=1.25, bulk_modulus=-147061)",
    ),
    ("beam_width --periods 0", "--periods: expected a whole number of at least 1, got 0"),
    ("beam_width --periods 1e3", "--periods: expected a whole number of at least 1, got '1e3'"),
    (
        "beam_width --medium steel",
        "--medium: expected 'exact', 'lmmd-emt', 'lmmd-emt-bare', 'standard-emt' or 'none', got 'steel'",
    ),
    (
        "beam_width --medium standard-emt --rho-m 0 --delta-rho 0 --n-layers 4",
        "--medium: the mean of 1/density does not exist, a layer has density 0",
    ),
    (
        "beam_width --after-density 0",
        "--after-density: expected a finite number other than zero beside a speed, got 0.0",
    ),
    ("beam_width --after-speed 0", "--after-speed: expected a finite number other than zero, got 0.0"),
    ("beam_width --after lead --after-speed 3", "--after-speed: expected to be left out beside --after, got 3.0"),
    ("beam_width --after unobtainium", "--after: expected a material, such as 'titanium', got 'unobtainium'"),
    ("beam_width --background stel", "--background: expected a material, such as 'steel', got 'stel'"),
    ("beam_width --background water --density 3", "--density: expected to be left out beside --background, got 3.0"),
    (
        "beam_width --background water --after-speed 300",
        "--after-density: expected a number, since background is a material, got none",
    ),
    (
        "beam_width --layer water",
        "--layer: expected a fluid and a thickness such as 'air 5mm' or 'density=1000 speed=1480 2mm', got 'water'",
    ),
    ("beam_width --layer 'water 2mm'", "--frequency: expected a frequency [Hz] for these layers, got none"),
    (
        "beam_width --layer 'unobtainium 2mm' --frequency 1e6",
        "material of --layer: expected a material, such as 'titanium', got 'unobtainium'",
    ),
    (
        "beam_width --layer 'density=a speed=2 2mm' --frequency 1e6",
        "density of --layer: expected a number such as 0.05 or 0.05+0.05j, got 'a'",
    ),
    (
        "beam_width --layer 'density=1 speed=2 0mm' --frequency 1e6",
        "thickness of --layer: expected a finite number above zero, got 0.0",
    ),
    (
        "beam_width --layer 'density=1 2mm' --frequency 1e6",
        "--layer: expected a fluid and a thickness such as 'air 5mm' or 'density=1000 speed=1480 2mm', got 'density=1 2mm'",
    ),
    (
        "beam_width --layer 'colour=1 2mm' --frequency 1e6",
        "--layer: expected a fluid and a thickness such as 'air 5mm' or 'density=1000 speed=1480 2mm', got 'colour=1 2mm'",
    ),
    (
        "beam_width --layer 'water 2mm' --layer 'water 2xm' --frequency 1e6",
        "thickness of --layer 2: expected a length such as 0.002 or 2mm, got '2xm'",
    ),
    (
        "beam_width --layer '' --frequency 1e6",
        "--layer: expected a fluid and a thickness such as 'air 5mm' or 'density=1000 speed=1480 2mm', got ''",
    ),
    (
        "beam_width --layer 'density=1 speed=300 attenuation=-1 2mm' --frequency 1e6",
        "attenuation of --layer: expected at least 0 Np/m (active=True allows gain), got -1.0",
    ),
    (
        "beam_width --layer 'water 2mm' --eta 1/20 --frequency 1e6",
        "--eta: expected to be left out beside --layer, got 0.05",
    ),
    (
        "beam_width --layer 'water 2mm' --lossless --frequency 1e6",
        "--lossless: expected to be left out beside --layer, got True",
    ),
    (
        "beam_width --layers none.csv --frequency 1e6",
        "--layers: expected a CSV file that can be read, got 'none.csv' (No such file or directory)",
    ),
    (
        "beam_width --layers layers.csv --frequency 1e6",
        "material, row 2 of --layers: expected a material, such as 'titanium', got 'unobtainium'",
    ),
    (
        "beam_width --layers header.csv --frequency 1e6",
        "--layers: expected columns of thickness (m, cm, mm, um), density (kg/m3, g/cm3), sound_speed (m/s, km/s), bulk_modulus (pa, kpa, mpa, gpa), attenuation (np/m, np/cm, db/m, db/cm, db/mm), reference_frequency (hz, khz, mhz), exponent, areal_density (kg/m2, g/m2), material, got 'thick'",
    ),
    (
        "beam_width --layers nothing.csv --frequency 1e6",
        "--layers: expected a line of column names, got no text in nothing.csv",
    ),
    (
        "beam_width --layers layers.csv --layer 'water 2mm' --frequency 1e6",
        "--layer: expected to be left out beside --layers, got 'water 2mm'",
    ),
    ("beam_measures --window 0", "--window: expected a finite number above zero, got 0.0"),
    ("beam_measures --window=-1m", "--window: expected a finite number above zero, got -1.0"),
    ("beam_measures --plot a.png", "No such option..."),
    ("scattering --kx 0,1 --angle 0,3", "--kx, --angle: expected exactly one of them, got 2"),
    ("scattering --angle 95", "--angle: expected degrees from -90 to 90, got 95.0"),
    ("scattering --kx-over-k0 0,inf", "--kx-over-k0: expected finite values, got inf"),
    ("scattering --kx 1+1j", "--kx: expected a number, a,b,c or start:stop:count, got '1+1j'"),
    (
        "scattering --quantity x",
        "--quantity: expected 'transmissivity', 'reflectivity', 'energy_transmission' or 'absorption', got 'x'",
    ),
    ("scattering --plot a.png --angle 45", "--plot: expected an axis for --frequency or --angle, got one value"),
    (
        "scattering --frequency 1:2:100000 --kx 0:1:100000",
        "--kx: expected a question that fits into 1.07 GB of memory, got one that takes about 1 TB for 1e+10 plane waves; ask for fewer of the 1e+05 kx, in parts",
    ),
    ("bloch --kx-over-k0 nan", "--kx-over-k0: expected finite values, got nan"),
    ("bloch --eta=-1", "--eta: expected a finite number above zero, got -1.0"),
    ("bloch --periods 3", "No such option..."),
    ("bloch --plot a.png --kx-over-k0 1", "--plot: expected an axis for --kx-over-k0, got one value"),
    ("bloch --layer 'areal_density=1' --frequency 1000", "--layer: expected a thickness of at least 1e-50 m, got 0"),
    ("guided_modes --kx-over-k0-max 0", "--kx-over-k0-max: expected a finite number above zero, got 0.0"),
    ("guided_modes --strip-over-k0 -1", "--strip-over-k0: expected a finite number above zero, got -1.0"),
    ("guided_modes --strip-over-k0 wide", "--strip-over-k0: expected a number such as 0.05 or 1/60, got 'wide'"),
    ("compare", "Missing argument 'A'..."),
    ("compare text.txt", "Missing argument 'B'..."),
    ("compare none.nc none.nc", "A: expected an existing file, got 'none.nc'"),
    ("compare text.txt text.txt", "text.txt: expected rows of numbers below the header, got none"),
    ("compare text.txt text.txt --tolerance -1", "--tolerance: expected a number of at least 0, got -1.0"),
    ("compare text.txt text.txt --grid 0:1:3", "Option '--grid' requires 2 arguments..."),
    ("compare text.txt text.txt --grid a 0:1:3", "--grid: expected a number, a,b,c or start:stop:count, got 'a'"),
    ("convert none.txt a.nc", "SOURCE: expected an existing file, got 'none.txt'"),
    (
        "convert text.txt a.xyz",
        "TARGET: expected a name ending in .nc or .nc4 or .netcdf or .h5 or .zarr or .mat or .vti or .vtr or .csv, got 'a.xyz'",
    ),
    ("convert text.txt none/a.nc", "TARGET: expected a file in an existing folder, got 'none/a.nc'"),
    ("convert text.txt a.nc", "text.txt: expected rows of numbers below the header, got none"),
    ("convert text.txt a.nc --digits 0", "--digits: expected a whole number of at least 1, got 0"),
    ("convert text.txt a.nc --digits many", "--digits: expected a whole number of at least 1, got 'many'"),
    ("convert text.txt a.nc --angle-unit gon", "--angle-unit: expected one of deg, degree, °, rad, got 'gon'"),
    (
        "convert text.txt a.nc --length-unit furlong",
        "--length-unit: expected one of m, mm, cm, dm, km, um, nm, in, inch, ft, mil, got 'furlong'",
    ),
    (
        "help paint",
        "COMMAND: expected one of beam_measures, beam_width, bloch, compare, convert, field, guided_modes, help, scattering, got 'paint'",
    ),
    ("help field extra", "Got unexpected extra argument (extra)..."),
    (
        "field --output ''",
        "--output: expected a name ending in .nc or .nc4 or .netcdf or .h5 or .zarr or .mat or .vti or .vtr or .csv, got ''",
    ),
    (
        "field --output .nc",
        "--output: expected a name ending in .nc or .nc4 or .netcdf or .h5 or .zarr or .mat or .vti or .vtr or .csv, got '.nc'",
    ),
    (
        "field --output a.mat --memory 1 --x 0 --z 0",
        "--output: expected an ending of .nc, .nc4, .netcdf, .h5, .zarr, got 'a.mat'",
    ),
    (
        "field --output a.csv --memory 1 --x 0 --z 0",
        "--output: expected an ending of .nc, .nc4, .netcdf, .h5, .zarr, got 'a.csv' (which export writes)",
    ),
    ("field --profile .", "--profile: expected a text file that can be read, got '.' (Is a directory)"),
    ("field --layers . --frequency 1e3", "--layers: expected a CSV file that can be read, got '.' (Is a directory)"),
    (
        "field --layer 'water 1e60' --frequency 1e3",
        "thickness of --layer: expected a magnitude of at most 1e+50, which double precision can compute with, got 1e+60",
    ),
    (
        "field --x 1e60 --z 0",
        "--x: expected a magnitude of at most 1e+50, which double precision can compute with, got 1e+60",
    ),
    (
        "field --variables p, --x 0 --z 0",
        "--variables: expected some of p, v_x, v_z, intensity_x, intensity_z, power_through, intensity, got ''",
    ),
    (
        "field --density 1+1j",
        "--density: expected a passive medium, Im(bulk_modulus) <= 0 with exp(-i w t) and bulk_modulus = density * sound_speed^2, got (1+1j)",
    ),
    ("field --angle 10,100", "--angle: expected degrees from the normal, between -90 and 90, got 100.0"),
    (
        "field --json --x 0:1:100000 --z 0:1:10000",
        "--json: expected a question that fits into 1.07 GB of memory, got one that takes about 1 TB for the text of 1e+09 values; write them to a file with --output",
    ),
    (
        "beam_width --n-layers 100000000000",
        "--n-layers: expected a question that fits into 1.07 GB of memory, got one that takes about 100 TB for 1e+11 layers; take fewer",
    ),
    (
        "beam_width --periods 1000000000000000000000",
        "--periods: expected a whole number of at least 1 and at most 9.01e+15, got 1000000000000000000000",
    ),
    ("beam_width --fwhm 1e400", "--fwhm: expected a finite number above zero, got inf"),
    (
        "scattering --background water --after-density 3 --after-speed 0",
        "--after-speed: expected a finite number other than zero, got 0.0",
    ),
    (
        "guided_modes --kx-over-k0-max 1e9 --lossless --periods 5",
        "--kx-over-k0-max: expected a strip that 1.8e+06 values of the dispersion function search through, got 1e+09 by 0.5 k0; search a part of it, by --kx-over-k0-max and --strip-over-k0",
    ),
]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The folder to be in, and a memory that does not depend on the machine."""
    for name, text in FILES.items():
        if text is None:
            (tmp_path / name).mkdir()
        else:
            (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("BEAMPROP_MEMORY", "1G")
    return tmp_path


def contents(folder):
    return {path: path.read_bytes() if path.is_file() else None for path in folder.rglob("*")}


@pytest.mark.parametrize(("line", "message"), WRONG)
def test_a_wrong_command(line, message, folder):
    """Exit 2, the message, nothing on stdout, and the folder as it was."""
    before = contents(folder)
    ran = CliRunner().invoke(main, shlex.split(line), prog_name="beamprop")
    assert ran.exit_code == 2, ran.output
    _, _, said = ran.stderr.rstrip().rpartition("Error: ")
    assert said.startswith(message[:-3]) if message.endswith("...") else said == message
    assert "\n" not in said
    assert ran.stdout == ""
    assert contents(folder) == before


def test_there_are_a_hundred():
    """Each typed once."""
    assert len({line for line, _ in WRONG}) == len(WRONG) >= 100


def test_the_command_alone_shows_its_help():
    ran = CliRunner().invoke(main, [], prog_name="beamprop")
    assert (ran.exit_code, "Commands:" in ran.output) == (2, True)
