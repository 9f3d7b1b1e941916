"""A second finite-element code: the same discrete problem assembled by NGSolve, against beamprop.fem.

Both use tensor-product elements of order 3 on the same rows, and the same exact radiation conditions; so both must agree to
rounding, far below the error that they share. Needs `pip install ngsolve`, which the package does not.
"""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from common import DESIGN, FWHM, LOSSLESS, WAVELENGTH, Statement, run, slab
from scipy import sparse
from scipy.sparse.linalg import splu

import beamprop as bp
from beamprop import fem
from beamprop.conventions import outgoing_kz

PERIOD = 6.3 * WAVELENGTH
ORDER = 3
OMEGA = 2 * np.pi * DESIGN


def ngsolve() -> Any:
    """The other code, or a message that says what to install."""
    try:
        import ngsolve
        import ngsolve.meshes
    except ImportError as error:
        raise SystemExit("this experiment needs NGSolve: pip install ngsolve") from error
    return ngsolve


def layer_table(structure: bp.Slab) -> tuple[np.ndarray, np.ndarray, complex]:
    """Faces from 0 to the thickness, density of each layer, and the one bulk modulus."""
    layers = list(structure.cell.layers) * structure.periods
    faces = np.concatenate([[0.0], np.cumsum([layer.thickness for layer in layers])])
    return faces, np.array([layer.fluid.density for layer in layers]), layers[0].fluid.bulk_modulus


def assemble(structure: bp.Slab, elements_x: int) -> tuple[Any, Any, sparse.csc_matrix]:
    """NGSolve's mesh, space and matrix of the slab: one row of quadrilaterals in a layer, periodic in x."""
    ng = ngsolve()
    faces, density, bulk = layer_table(structure)
    rows = density.size
    mesh = ng.meshes.MakeStructured2DMesh(
        quads=True,
        nx=elements_x,
        ny=rows,
        periodic_x=True,
        mapping=lambda x, y: ((x - 0.5) * PERIOD, faces[round(y * rows)]),
    )
    inverse = ng.GridFunction(ng.L2(mesh, order=0, complex=True))
    middle = [np.mean([mesh[v].point[1] for v in element.vertices]) for element in mesh.Elements()]
    inverse.vec.FV().NumPy()[:] = 1 / density[np.searchsorted(faces, middle) - 1]
    space = ng.Periodic(ng.H1(mesh, order=ORDER, complex=True))
    u, v = space.TnT()
    form = ng.BilinearForm(space, check_unused=False)
    form += (inverse * ng.grad(u) * ng.grad(v) - OMEGA**2 / bulk * u * v) * ng.dx(bonus_intorder=2)
    form.Assemble()
    data, column, start = form.mat.CSR()
    return mesh, space, sparse.csr_matrix((np.array(data), np.array(column), np.array(start))).tocsc()


def face_transform(space: Any, face: str, kx: np.ndarray) -> np.ndarray:
    """(1/W) integral phi_i exp(i kx x) dx along a face, by NGSolve's quadrature."""
    ng = ngsolve()
    C = np.empty((space.ndof, kx.size), complex)
    for m, k in enumerate(kx):
        form = ng.LinearForm(space)
        form += ng.exp(1j * k * ng.x) * space.TestFunction() * ng.ds(definedon=face, bonus_intorder=20)
        form.Assemble()
        C[:, m] = form.vec.FV().NumPy() / PERIOD
    return C


def solve(structure: bp.Slab, beam: bp.GaussianBeam, elements_x: int, x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """p(z, x) inside the slab by NGSolve's assembly, with the radiation conditions added order by order."""
    ng = ngsolve()
    mesh, space, A = assemble(structure, elements_x)
    half = (ORDER * elements_x - 1) // 2
    kx = 2 * np.pi / PERIOD * np.arange(-half, half + 1)
    air = bp.AIR.at(DESIGN)
    flux = 1j * outgoing_kz(kx, OMEGA, *air) / air.rho_z
    incident = beam.spectrum(kx, float(bp.AIR.wavenumber(DESIGN).real)) / PERIOD * np.exp(flux * air.rho_z * -beam.z0)
    f = np.zeros(space.ndof, complex)
    for face in ("bottom", "top"):
        C = face_transform(space, face, kx)
        used = np.flatnonzero(np.abs(C).max(axis=1) > 0)
        B = PERIOD * (C[used] * flux) @ C[used].conj().T
        A = A - sparse.csc_matrix((B.ravel(), (np.repeat(used, used.size), np.tile(used, used.size))), A.shape)
        f -= PERIOD * C @ (2 * flux * incident) if face == "bottom" else 0
    live = np.flatnonzero(np.diff(A.tocsr().indptr))  # the merged side's unknowns are not used
    factors = splu(
        A[live][:, live].tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.01, options={"SymmetricMode": True}
    )
    solution = ng.GridFunction(space)
    solution.vec.FV().NumPy()[live] = factors.solve(f[live])
    X, Z = np.meshgrid(x, z)
    return solution(mesh(X.ravel(), Z.ravel())).reshape(X.shape)


def compute(quick: bool = False) -> dict[str, xr.Dataset]:
    """The same slab by both codes and by plane waves: the lossless one at 45 degrees, 20 periods (5 with `quick`)."""
    structure, beam = slab(5 if quick else 20, LOSSLESS), bp.GaussianBeam(FWHM, angle=45, z0=-0.1)
    x, z = np.linspace(-0.4, 0.4, 161), np.linspace(0, structure.thickness, 42)[1:-1]
    ours = fem.field(structure, beam, DESIGN, x, z, PERIOD, order=ORDER, elements_x=32)
    exact = bp.field(structure, beam, DESIGN, x, z, boundary="periodic", period=PERIOD)
    theirs = ours.copy(data={"p": solve(structure, beam, 32, x, z)})
    return {"ours": ours, "ngsolve": theirs, "exact": exact}


def difference(a: xr.Dataset, b: xr.Dataset) -> float:
    """Relative L2 difference."""
    return float(np.linalg.norm(a.p.values - b.p.values) / np.linalg.norm(b.p.values))


def plot(data: dict[str, xr.Dataset]) -> plt.Figure:
    """|p| along x in the middle of the slab by all three."""
    fig, ax = plt.subplots(figsize=(6.2, 4), layout="constrained")
    for (name, ds), style in zip(data.items(), ("-", "--", ":"), strict=True):
        row = np.abs(ds.p.isel(z=ds.sizes["z"] // 2))
        ax.plot(ds.x, row, style, label={"ours": "beamprop.fem", "ngsolve": "NGSolve", "exact": "plane waves"}[name])
    ax.set(xlabel="x (m)", ylabel="|p| (Pa)", title="inside the lossless slab, 45°")
    ax.legend()
    return fig


def statements(data: dict[str, xr.Dataset]) -> list[Statement]:
    """Agreement of the codes beside their common error."""
    between, shared = difference(data["ours"], data["ngsolve"]), difference(data["ours"], data["exact"])
    text = f"{between:.1e} between the codes, {shared:.1e} from both to plane waves"
    return [Statement("FEM, NGSolve", "two codes agree within their discretisation errors", text, between < shared)]


if __name__ == "__main__":
    run("fem_ngsolve", __doc__, compute, plot, statements)
