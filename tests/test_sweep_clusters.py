"""Sweeps through the executors of other packages, where they are installed: dask, mpi4py, executorlib."""

import shutil
import subprocess
import sys

import pytest

STUDY = """
import sys
import numpy as np, xarray as xr, beamprop as bp

def question(a, b):
    return xr.Dataset({"v": ("x", np.sin(a + b * np.arange(4.0)))})

def main(executor):
    axes = {"a": np.arange(15), "b": np.arange(20.0)}
    ds = bp.sweep(question, axes, store=sys.argv[1], executor=executor, workers=2, progress=False)
    plain = bp.sweep(question, axes, workers=1, progress=False)
    print(np.array_equal(ds.v, plain.v), int((ds.status == 1).sum()))

if __name__ == "__main__":
"""
DASK = """
    from distributed import Client, LocalCluster
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        main(client.get_executor())
"""
MPI = """
    from mpi4py.futures import MPIPoolExecutor
    with MPIPoolExecutor() as executor:
        main(executor)
"""
EXECUTORLIB = """
    from executorlib import SingleNodeExecutor
    with SingleNodeExecutor(max_workers=2) as executor:
        main(executor)
"""
MPIEXEC = ("mpiexec", "--allow-run-as-root", "--oversubscribe", "-n", "3", sys.executable, "-m", "mpi4py.futures")


@pytest.mark.parametrize(
    ("package", "text", "command"),
    [
        ("distributed", DASK, (sys.executable,)),
        ("mpi4py", MPI, MPIEXEC),
        ("executorlib", EXECUTORLIB, (sys.executable,)),
    ],
)
def test_an_executor_of_another_package(package, text, command, tmp_path):
    """Values of the plain loop, every point answered."""
    pytest.importorskip(package)
    if not shutil.which(command[0]):
        pytest.skip(f"no {command[0]} here")
    (tmp_path / "study.py").write_text(STUDY + text)
    words = [*command, str(tmp_path / "study.py"), str(tmp_path / "study.zarr")]
    done = subprocess.run(words, capture_output=True, text=True, timeout=120, check=False)
    assert done.stdout.split() == ["True", "300"], done.stderr
