"""Print what a Python library reads of files: ``with_python.py READER FILE...``. Knows nothing of beamprop; runs where the library is.

For each file a line ``@FILE``, then ``NAME<tab>NUMBER NUMBER ...`` for each variable, its last dimension running first, or ``!MESSAGE``.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from typing import Any

import numpy as np

Variables = Iterator[tuple[str, Any]]


def of_xarray(ds: Any) -> Variables:
    yield from ((name, v.values) for name, v in ds.variables.items())


def xarray_h5netcdf(path: str) -> Variables:
    import xarray as xr

    yield from of_xarray(xr.open_dataset(path, engine="h5netcdf"))


def xarray_netcdf4(path: str) -> Variables:
    import xarray as xr

    yield from of_xarray(xr.open_dataset(path, engine="netcdf4"))


def xarray_dask(path: str) -> Variables:
    import xarray as xr

    yield from of_xarray(xr.open_dataset(path, chunks={}).compute())


def xarray_zarr(path: str) -> Variables:
    import xarray as xr

    yield from of_xarray(xr.open_zarr(path))


def netcdf4(path: str) -> Variables:
    import netCDF4

    with netCDF4.Dataset(path) as nc:
        yield from ((name, np.ma.getdata(v[...])) for name, v in nc.variables.items())


def h5py(path: str) -> Variables:
    import h5py

    with h5py.File(path) as file:
        yield from ((name, item[()]) for name, item in file.items())


def zarr(path: str) -> Variables:
    import zarr

    yield from ((name, array[...]) for name, array in zarr.open_group(path, mode="r").arrays())


def scipy(path: str) -> Variables:
    from scipy.io import loadmat

    yield from (
        (name, value)
        for name, value in loadmat(path, simplify_cells=True).items()
        if isinstance(value, np.ndarray | float | int)
    )


def pandas(path: str) -> Variables:
    import pandas as pd

    frame = pd.read_csv(path, float_precision="round_trip")
    yield from ((name.split(" (")[0], frame[name].to_numpy()) for name in frame.columns)


def vtk(path: str) -> Variables:
    import vtk

    kinds = {".vti": vtk.vtkXMLImageDataReader, ".vtr": vtk.vtkXMLRectilinearGridReader}
    if os.path.splitext(path)[1] not in kinds:
        raise ValueError("no reader of VTK's takes this ending")
    reader = kinds[os.path.splitext(path)[1]]()
    reader.SetFileName(path)
    reader.Update()
    yield from of_vtk(reader.GetOutput())


def vtk_netcdf(path: str) -> Variables:
    import vtk

    reader = vtk.vtkNetCDFCFReader()
    if not reader.CanReadFile(path):
        raise ValueError("CanReadFile: no")
    reader.SetFileName(path)
    reader.Update()  # of what has the first variable's dimensions; says which it leaves out
    choices = reader.GetAllDimensions()
    for dims in [choices.GetValue(k) for k in range(choices.GetNumberOfValues())]:
        reader.SetDimensions(dims)
        reader.Update()
        yield from of_vtk(reader.GetOutput(), axes=False)


def paraview(path: str) -> Variables:
    from paraview.simple import NetCDFReader, OpenDataFile, UpdatePipeline

    # of several readers for .nc the window asks for the "generic" one, which has a menu of dimensions
    source = NetCDFReader(FileName=[path]) if path.endswith(".nc") else OpenDataFile(path)
    if source is None:
        raise ValueError("OpenDataFile: no reader")
    for dims in source.GetProperty("Dimensions").Available if path.endswith(".nc") else [None]:
        if dims is not None:
            source.Dimensions = dims
        UpdatePipeline(proxy=source)
        yield from of_vtk(source.GetClientSideObject().GetOutputDataObject(0), axes=dims is None)


def of_vtk(data: Any, axes: bool = True) -> Variables:
    """The arrays on the points, and the positions that the grid has."""
    try:
        from vtkmodules.util.numpy_support import vtk_to_numpy
    except ImportError:
        from paraview.vtk.util.numpy_support import vtk_to_numpy
    points, n = data.GetPointData(), data.GetNumberOfPoints()
    yield from ((points.GetArrayName(k), vtk_to_numpy(points.GetArray(k))) for k in range(points.GetNumberOfArrays()))
    if axes:
        places = np.array([data.GetPoint(k) for k in range(n)])
        yield from ((name, np.unique(places[:, k])) for k, name in enumerate("xyz"))


def numbers(name: str, values: Any) -> Variables:
    """An array of real numbers or words; a complex one as two."""
    array = np.asarray(values)
    if array.dtype.kind == "c":
        yield from ((name + "_real", array.real), (name + "_imag", array.imag))
    elif array.dtype.kind in "biufUTO":
        yield name, array
    else:
        raise ValueError(f"{name}: no numbers but {array.dtype}")


def main(reader: str, paths: list[str]) -> None:
    for path in paths:
        for stream in (sys.stdout, sys.stderr):
            print(f"@{path}", file=stream, flush=True)
        try:
            pairs = [pair for name, values in globals()[reader](path) for pair in numbers(name, values)]
        except Exception as error:
            print("!" + f"{type(error).__name__}: {error}".replace("\n", " ")[:300])
            continue
        for name, values in pairs:
            words = (repr(float(v)) if not isinstance(v, str) else v for v in values.ravel().tolist())
            print(name + "\t" + " ".join(words))
        sys.stdout.flush()


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
