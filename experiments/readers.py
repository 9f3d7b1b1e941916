"""Which program reads which of our files: every reader that is here opens every kind, and each number is compared with the dataset's.

``python experiments/readers.py`` prints a table in Markdown: "numbers" where all of them arrive, "part" where all but those of which the reader
itself says that it leaves them out, "refusal" where the reader says that it reads nothing. Anything else is an error, in bold, and ends with 1.
``--environment DIR`` makes an environment for the readers of PyPI (VTK is 130 MB) where there is none; Debian's packages octave,
octave-netcdf, netcdf-bin, r-cran-ncdf4, gnumeric and python3-paraview have the others. What is not here is named and left out.
"""

from __future__ import annotations

import argparse
import csv
import itertools
import re
import shutil
import subprocess
import sys
import tempfile
import timeit
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

import beamprop as bp

HERE = Path(__file__).parent / "reading"
PYPI = ("xarray", "h5netcdf", "netCDF4", "dask", "h5py", "zarr", "scipy", "pandas", "vtk")

#: Of a file, what stands in it by name: numbers, or words.
Content = dict[str, list[float] | list[str]]


# --- files ----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Case:
    """A file, how it is written, and what a reader has to find in it."""

    column: str
    file: str
    ds: xr.Dataset
    content: Callable[[xr.Dataset], Content]
    write: Callable[[xr.Dataset, Path], None] = bp.save


def pairs(ds: xr.Dataset, coded: bool = False) -> Content:
    """Complex variables by parts; words by themselves, or by their place in the alphabet."""
    content: Content = {}
    for name, v in ds.variables.items():
        if v.dtype.kind == "c":
            content |= {f"{name}_{part}": getattr(v.values, part).ravel().tolist() for part in ("real", "imag")}
        elif v.dtype.kind == "U" and coded:
            content[str(name)] = [float(sorted(set(v.values)).index(word)) for word in v.values]
        else:
            content[str(name)] = v.values.ravel().tolist()
    return content


def codes(ds: xr.Dataset) -> Content:
    """What a netCDF file or a Zarr store holds, its complex numbers by parts."""
    return pairs(ds, coded=True)


def columns(ds: xr.Dataset) -> Content:
    """What a table holds: a scalar in each row."""
    content = pairs(ds)
    length = max(map(len, content.values()))
    return {name: values * (length // len(values)) for name, values in content.items()}


def on_grid(ds: xr.Dataset) -> Content:
    """What ParaView's files hold: for each frequency and angle four arrays, z after z and x in each; and the positions."""
    content: Content = {name: np.unique(ds[name]).tolist() if name in ds else [0.0] for name in "xyz"}
    p = ds.p.expand_dims([dim for dim in ("frequency", "angle") if dim not in ds.p.dims]).sortby("z")
    for f, a in itertools.product(range(p.sizes["frequency"]), range(p.sizes["angle"])):
        plane = p.isel(frequency=f, angle=a).transpose("z", "x").values.ravel()
        label = f" (frequency {p.frequency[f]:g} Hz, angle {p.angle[a]:g} degree)" if "angle" in ds.dims else ""
        parts = {
            "real": plane.real,
            "imag": plane.imag,
            "abs": np.hypot(plane.real, plane.imag),
            "phase": np.arctan2(plane.imag, plane.real),
        }
        content |= {f"p_{part}{label}": values.tolist() for part, values in parts.items()}
    return content


def cases() -> list[Case]:
    """Every kind of file, and every kind of variable: complex, counts, words, NaN, scalars, rounded."""
    slab, beam = bp.Slab(bp.lmmd_cell(rho_m=0.05, delta_rho=0), periods=20), bp.GaussianBeam(0.096, z0=-0.05)
    x, z = np.linspace(-0.4, 0.4, 5), [0.0, 0.1, 0.2]
    many = bp.field(slab, beam, [2400.0, 2500.0], x, z, angle=[0.0, 30.0])
    plane = bp.field(slab, beam, 2500.0, x, z)
    uneven = bp.field(slab, beam, 2500.0, x, [0.2, 0.0, 0.05])
    spectrum = bp.scattering(slab, 2500.0, kx_over_k0=[0.0, 0.5, 1.5])
    modes, measures = bp.guided_modes(slab, [2400.0, 2500.0]), bp.beam_measures(slab, beam, [2400.0, 2500.0])
    with tempfile.TemporaryDirectory() as folder:
        bp.save(many, Path(folder, "a.nc"), digits=4)
        rounded = bp.load(Path(folder, "a.nc"))
    return [
        Case("fields .nc", "fields.nc", many, codes),
        Case("plane .nc", "plane.nc", plane, codes),
        Case("rounded .nc", "rounded.nc", rounded, codes, lambda ds, path: bp.save(ds, path, digits=4)),
        Case("spectrum .nc", "spectrum.nc", spectrum, codes),
        Case("modes .nc", "modes.nc", modes, codes),
        Case("measures .nc", "measures.nc", measures, codes),
        Case(".zarr", "measures.zarr", measures.assign(p=plane.p), codes),
        Case(".mat", "fields.mat", many, pairs),
        Case(".vti", "fields.vti", many, on_grid, bp.export),
        Case(".vtr", "uneven.vtr", uneven, on_grid, bp.export),
        Case(".csv", "spectrum.csv", spectrum, columns, bp.export),
    ]


# --- readers --------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Reader:
    """A program, whether it is here, and how it is asked for what it reads."""

    name: str
    probe: list[str]
    command: list[str]
    #: Shows arrays on a grid: its positions are the grid's, and no variables.
    grid: bool = False


def python_readers(python: str) -> list[Reader]:
    """Those of PyPI, in an environment."""
    libraries = {
        "xarray, h5netcdf": ("xarray_h5netcdf", "xarray, h5netcdf"),
        "xarray, netCDF4": ("xarray_netcdf4", "xarray, netCDF4"),
        "xarray, by dask": ("xarray_dask", "xarray, dask.array"),
        "netCDF4-python": ("netcdf4", "netCDF4"),
        "h5py": ("h5py", "h5py"),
        "xarray.open_zarr": ("xarray_zarr", "xarray, zarr"),
        "zarr-python": ("zarr", "zarr"),
        "scipy.io.loadmat": ("scipy", "scipy.io"),
        "pandas.read_csv": ("pandas", "pandas"),
        "VTK, XML": ("vtk", "vtk"),
        "VTK, netCDF": ("vtk_netcdf", "vtk"),
    }
    script = str(HERE / "with_python.py")
    return [
        Reader(name, [python, "-W", "ignore", "-c", f"import {modules}"], [python, script, word], word == "vtk_netcdf")
        for name, (word, modules) in libraries.items()
    ]


def programs() -> list[Reader]:
    """Those that a system has."""
    octave = ["octave", "--no-gui", "-qf", str(HERE / "with_octave.m")]
    r, python = ["Rscript", str(HERE / "with_r.R")], str(HERE / "with_python.py")
    return [
        Reader("Octave, load", ["octave", "--version"], [*octave, "load"]),
        Reader("Octave, ncread", ["octave", "--no-gui", "-qf", "--eval", "pkg load netcdf"], [*octave, "ncread"]),
        Reader("Octave, csvread", ["octave", "--version"], [*octave, "csvread"]),
        Reader("R, ncdf4", ["Rscript", "-e", "library(ncdf4)"], [*r, "ncdf4"]),
        Reader("R, read.csv", ["Rscript", "--version"], [*r, "read.csv"]),
        Reader("ncdump", ["ncdump", "-k", "/dev/null"], ["ncdump", "-p", "17,17"]),
        Reader("Gnumeric", ["ssconvert", "--version"], ["ssconvert"]),
        Reader("ParaView", ["pvpython", "--version"], ["pvpython", python, "paraview"], grid=True),
    ]


#: Readers that are not to be had here, whoever runs this: said instead of left out.
ABSENT = {"matlab": "MATLAB", "julia": "Julia", "excel": "Excel"}


def answers(reader: Reader, paths: list[Path]) -> dict[str, tuple[str, str]]:
    """What a reader prints of each file, and what it says beside it."""
    if reader.command[0] in ("ncdump", "ssconvert"):
        return {path.name: one_file(reader.command, path) for path in paths}
    done = subprocess.run(
        [*reader.command, *map(str, paths)], capture_output=True, text=True, errors="replace", check=False
    )
    out, said = sections(done.stdout), sections(done.stderr)
    crash = f"ended with {done.returncode}"
    return {path.name: (out.get(str(path), f"?{crash}"), said.get(str(path), "") + said.get("", "")) for path in paths}


def sections(text: str) -> dict[str, str]:
    """Parts of a text by the lines that begin with @."""
    first, *parts = re.split(r"^@(.*)\n", text, flags=re.MULTILINE)
    return {"": first} | dict(zip(parts[::2], parts[1::2], strict=True))


def one_file(command: list[str], path: Path) -> tuple[str, str]:
    """What a program prints that takes one file, in the form of the others."""
    with tempfile.TemporaryDirectory() as folder:
        table = Path(folder, "table.csv")
        words = [*command, str(path)] + ([str(table)] if command[0] == "ssconvert" else [])
        done = subprocess.run(words, capture_output=True, text=True, errors="replace", check=False)
        if done.returncode or (command[0] == "ssconvert" and not table.exists()):
            return f"!{done.stderr.strip() or done.returncode}", done.stderr
        if command[0] == "ncdump":
            data = re.sub(r"\s+", " ", done.stdout.partition("\ndata:\n")[2])
            lines = re.findall(r"(\w+) = ([^;]*);", data)
            return "".join(
                f"{name}\t{values.replace(',', ' ').replace('_', 'NaN')}\n" for name, values in lines
            ), done.stderr
        names, *rows = csv.reader(table.read_text().splitlines())
        columns = itertools.zip_longest(*rows, fillvalue="")  # of a text that is no table they are of any length
        return "".join(
            f"{n.split(' (')[0]}\t{' '.join(c)}\n" for n, c in zip(names, columns, strict=False)
        ), done.stderr


def verdict(reader: Reader, printed: str, said: str, wanted: Content, dims: set[str]) -> str:
    """One cell of the table."""
    if printed.startswith("?"):
        return f"**{printed[1:]}**"
    if re.search(r"^!\S", printed, re.MULTILINE):
        return "refusal"
    delivered = dict(line.split("\t", 1) for line in printed.splitlines() if "\t" in line)
    if reader.grid and "p_abs" not in " ".join(wanted):
        wanted = {name: values for name, values in wanted.items() if name not in dims}
    wrong = [name for name, values in wanted.items() if name in delivered and not same(delivered[name].split(), values)]
    missing = [name for name in wanted if name not in delivered]
    silent = [name for name in missing if not re.search(rf"\b{name}\b", said)]
    if wrong:
        return f"**other numbers: {', '.join(wrong)}**"
    if len(missing) == len(wanted) or (missing and "ERR|" in said):  # as VTK begins an error
        return "refusal" if said.strip() else "**nothing, silently**"
    if silent:
        return f"**without, silently: {', '.join(silent)}**"
    return "part" if missing else "numbers"


def same(delivered: list[str], wanted: list[float] | list[str]) -> bool:
    """All numbers to their last digits; phases and magnitudes come from another function here, to the last but one."""
    if len(delivered) != len(wanted):
        return False
    if wanted and isinstance(wanted[0], str):
        return delivered == wanted
    try:
        return np.allclose(np.array(delivered, float), wanted, rtol=1e-15, atol=0, equal_nan=True)
    except ValueError:
        return False


# --- the table ------------------------------------------------------------------------------------------------


def table(readers: list[Reader], folder: Path) -> tuple[list[str], list[str]]:
    """Rows in Markdown, and the errors among the cells."""
    files = cases()
    for case in files:
        case.write(case.ds, folder / case.file)
    rows = ["| reader | " + " | ".join(case.column for case in files) + " |", "|---" * (len(files) + 1) + "|"]
    errors = []
    for reader in readers:
        given = answers(reader, [folder / case.file for case in files])
        cells = [verdict(reader, *given[c.file], c.content(c.ds), set(map(str, c.ds.dims))) for c in files]
        rows.append(f"| {reader.name} | " + " | ".join(cells) + " |")
        errors += [
            f"{reader.name}, {case.column}: {cell}" for case, cell in zip(files, cells, strict=True) if "**" in cell
        ]
    return rows, errors


def sizes() -> list[str]:
    """Rows in Markdown: time to write and to read a field of 1024 x 1000, the best of five each, and the file's size."""
    slab, beam = bp.Slab(bp.lmmd_cell(), periods=450), bp.GaussianBeam(0.096, angle=45, z0=-0.1)
    ds = bp.field(slab, beam, 2500.0, np.linspace(-1.4, 1.4, 1024), np.linspace(-0.1, 1.3, 1000))
    kinds: dict[str, tuple[str, dict[str, Any]]] = {
        ".nc": (".nc", {}),
        ".nc of a compound type, as 0.1.0 wrote it": (".nc", {"split_complex": False}),
        **{f".nc, digits={digits}": (".nc", {"digits": digits}) for digits in (3, 4, 6, 8)},
        ".zarr": (".zarr", {}),
        ".zarr, digits=4": (".zarr", {"digits": 4}),
        ".mat": (".mat", {}),
    }
    rows = ["| file | write [s] | read [s] | size [MiB] |", "|---|---|---|---|"]
    for name, (ending, options) in kinds.items():
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, f"a{ending}")
            write = min(timeit.repeat(lambda: bp.save(ds, path, **options), number=1, repeat=5))  # noqa: B023 (called at once)
            read = min(timeit.repeat(lambda: bp.load(path), number=1, repeat=5))  # noqa: B023
            files = [path] if path.is_file() else [file for file in path.rglob("*") if file.is_file()]
            size = sum(file.stat().st_size for file in files) / 2**20
        rows.append(f"| {name} | {write:.2f} | {read:.2f} | {size:.1f} |")
    return rows


def here(reader: Reader) -> bool:
    """Whether a reader can be run."""
    if shutil.which(reader.probe[0]) is None:
        return False
    done = subprocess.run(reader.probe, capture_output=True, check=False)
    return done.returncode == 0 or reader.name == "ncdump"


def environment(folder: Path) -> str:
    """The Python of an environment with the readers of PyPI, made if there is none."""
    python = folder / "bin" / "python"
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", str(folder)], check=True)
        subprocess.run([str(python), "-m", "pip", "install", "-q", *PYPI], check=True)
    return str(python)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--environment", type=Path, help="Of the readers of PyPI; this one by default.")
    parser.add_argument(
        "--sizes", action="store_true", help="Print how long files take and how large they are instead."
    )
    options = parser.parse_args()
    if options.sizes:
        print("\n".join(sizes()))
        return
    readers = python_readers(environment(options.environment) if options.environment else sys.executable) + programs()
    present = [reader for reader in readers if here(reader)]
    with tempfile.TemporaryDirectory() as folder:
        rows, errors = table(present, Path(folder))
    print("\n".join(rows))
    absent = [reader.name for reader in readers if reader not in present]
    absent += [name for program, name in ABSENT.items() if shutil.which(program) is None]
    print("\nNot found, and not tried: " + (", ".join(absent) or "none") + ".")
    if errors:
        sys.exit("\n".join(errors))


if __name__ == "__main__":
    main()
