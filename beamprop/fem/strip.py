"""The x-periodic strip: layers to rows of finite elements, and rows to matrices.

The equation is ``div((1/rho) grad p) + (w^2/K) p = 0`` with a density that may differ along x and z; its weak
form over one row of elements, with the outward flux ``f`` of ``q = (1/rho_z) dp/dz`` through the row's two
faces, is

    integral (1/rho_x) p_x v_x + (1/rho_z) p_z v_z - (w^2/K) p v  =  f(v).

A mesh is never drawn across a layer's face: a slab is a sequence of rows, every row lies inside one layer,
and the elements of a row are tensor-product quadrilaterals of order 1 to 4. scikit-fem assembles the three
integrals once, on a row of unit height; a row of height d scales them by d, 1/d and d. A `Membrane` is a row
of height zero.

A row's unknowns are ordered by lines: line 0 is the near face, line `order` the far one, and those between
are the element's inner shape functions along z. A line has ``order * elements_x`` unknowns; the sides are
merged.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from scipy import sparse

from ..media.fluids import Fluid
from ..media.structures import Cell, Layer, Membrane, Slab

#: Element size along x and z over the wavelength that gives an error of some 1e-4 to 1e-3, by order; experiments/fem_convergence.py
#: measures it.
SIZE_OVER_WAVELENGTH = {1: 0.05, 2: 0.1, 3: 0.2, 4: 0.3}


def skfem() -> Any:
    """The finite-element library, imported when it is first needed."""
    try:
        import skfem
    except ImportError as error:
        raise ImportError('beamprop.fem needs scikit-fem: pip install -e ".[fem]" in the checkout') from error
    return skfem


class Row(NamedTuple):
    """One row of elements: a layer or an equal part of it, or (thickness 0) a membrane.

    `mobility_x` and `mobility_z` are 1/rho_x and 1/rho_z, `compliance` is 1/K; a membrane has the inverse of
    its areal density as `mobility_z`.
    """

    thickness: float
    mobility_x: complex
    mobility_z: complex
    compliance: complex

    def span(self, order: int) -> int:
        """Lines from the row's near face to its far one."""
        return order if self.thickness else 1


#: A cell as rows with the number of times that each is repeated, and the number of periods.
Segment = tuple[tuple[tuple[Row, int], ...], int]


@dataclass(frozen=True, eq=False)
class Strip:
    """Matrices of a row of unit height over one period in x.

    stiffness_x, stiffness_z, mass : sparse, ((order+1) n, (order+1) n), with n = order * elements_x
        Integrals of p_x v_x, p_z v_z and p v, in line order.
    line_mass : sparse, (n, n)
        Integral of p v along a line.
    """

    period: float
    origin: float
    order: int
    elements_x: int
    stiffness_x: sparse.csr_matrix
    stiffness_z: sparse.csr_matrix
    mass: sparse.csr_matrix
    line_mass: sparse.csr_matrix

    @property
    def n(self) -> int:
        """Unknowns of a line."""
        return self.order * self.elements_x


class Layout(NamedTuple):
    """Every row of a slab from the near face on: arrays over the rows, and the distinct rows they refer to."""

    kinds: tuple[Row, ...]
    kind: np.ndarray
    start: np.ndarray
    lines: int
    near: np.ndarray  # z of the row's near face


# --- elements ---------------------------------------------------------------------------------------------


def line_element(order: int) -> Any:
    """scikit-fem's 1-D element whose tensor product with itself is `quad_element`."""
    fem = skfem()
    known = {1: fem.ElementLineP1, 2: fem.ElementLineP2}
    return known[order]() if order in known else fem.ElementLinePp(order)


def quad_element(order: int) -> Any:
    """scikit-fem's quadrilateral element."""
    fem = skfem()
    known = {1: fem.ElementQuad1, 2: fem.ElementQuad2}
    return known[order]() if order in known else fem.ElementQuadP(order)


def shape_functions(order: int, local: np.ndarray) -> np.ndarray:
    """Values (order+1, points) of the 1-D shape functions at local coordinates in [0, 1]."""
    if not local.size:
        return np.zeros((order + 1, 0))
    element = line_element(order)
    return np.stack([element.lbasis(local[None, :], i)[0] * np.ones(local.shape) for i in range(order + 1)])


def line_numbers(order: int) -> np.ndarray:
    """Line of each 1-D shape function along z: the near end first, the far end last, the inner ones between."""
    return np.array([0, order, *range(1, order)])


def line_dofs(order: int, elements_x: int) -> np.ndarray:
    """Unknowns (order+1, elements_x) on a line of each element's 1-D shape functions, with the sides merged."""
    first = order * np.arange(elements_x)
    return np.stack([first, np.roll(first, -1), *(first + i for i in range(1, order))])


def _tensor_indices(order: int) -> np.ndarray:
    """(z, x) indices of the 1-D shape functions behind each shape function of `quad_element`, (N, 2).

    The library's tensor meshes number an element's corners so that its first local coordinate runs along z.
    """
    inner = range(2, order + 1)
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    edges = [*((i, 0) for i in inner), *((1, i) for i in inner), *((i, 1) for i in inner), *((0, i) for i in inner)]
    return np.array(corners + edges + [(i, j) for i in inner for j in inner])


def _row_numbering(basis: Any, order: int, elements_x: int) -> sparse.csr_matrix:
    """Matrix that takes a row's unknowns in line order to scikit-fem's: periodic in x."""
    n = order * elements_x
    left = basis.mesh.p[0, basis.mesh.t].min(axis=0)
    element = np.argsort(np.argsort(left))  # position along x of each element
    iz, ix = _tensor_indices(order).T
    mine = line_numbers(order)[iz][:, None] * n + line_dofs(order, elements_x)[ix][:, element]
    theirs = basis.element_dofs
    chosen = np.empty(basis.N, dtype=int)
    chosen[theirs] = mine
    return sparse.csr_matrix((np.ones(basis.N), (np.arange(basis.N), chosen)), shape=(basis.N, (order + 1) * n))


def make_strip(period: float, origin: float, order: int, elements_x: int) -> Strip:
    """Assemble the matrices of a row of unit height, with x from `origin` to ``origin + period``."""
    fem = skfem()
    x = np.linspace(0, period, elements_x + 1)
    basis = fem.Basis(fem.MeshQuad.init_tensor(x, np.array([0.0, 1.0])), quad_element(order), intorder=2 * order)
    number = _row_numbering(basis, order, elements_x)

    def assemble(form: Any) -> sparse.csr_matrix:
        return (number.T @ fem.BilinearForm(form).assemble(basis) @ number).tocsr()

    stiffness_x = assemble(lambda u, v, w: u.grad[0] * v.grad[0])
    stiffness_z = assemble(lambda u, v, w: u.grad[1] * v.grad[1])
    mass = assemble(lambda u, v, w: u * v)
    line_mass = _line_mass(x, order)
    return Strip(period, origin, order, elements_x, stiffness_x, stiffness_z, mass, line_mass)


def _line_mass(x: np.ndarray, order: int) -> sparse.csr_matrix:
    """Integral of p v along a line, periodic."""
    fem = skfem()
    basis = line_basis(x, order, 2 * order)
    dofs = line_dofs(order, x.size - 1)
    fold = sparse.csr_matrix((np.ones(dofs.size), (basis.element_dofs.ravel(), dofs.ravel())))
    fold.data[:] = 1.0  # a vertex belongs to two elements
    return (fold.T @ fem.BilinearForm(lambda u, v, w: u * v).assemble(basis) @ fold).tocsr()


def line_basis(x: np.ndarray, order: int, intorder: int) -> Any:
    """scikit-fem's basis on a line of elements with the ends x."""
    fem = skfem()
    return fem.Basis(fem.MeshLine(x), line_element(order), intorder=intorder)


def row_matrix(strip: Strip, row: Row, omega: float) -> sparse.csr_matrix:
    """Matrix of a row of elements: its unknowns p in line order to the outward fluxes through its faces."""
    if row.thickness:
        d = row.thickness
        return (
            row.mobility_x * d * strip.stiffness_x
            + row.mobility_z / d * strip.stiffness_z
            - omega**2 * row.compliance * d * strip.mass
        )
    return row.mobility_z * sparse.kron(np.array([[1.0, -1.0], [-1.0, 1.0]]), strip.line_mass, format="csr")


# --- a slab as rows ---------------------------------------------------------------------------------------


def _layer_rows(layer: Layer | Membrane, frequency: float, kx: float, order: int, least: int) -> tuple[Row, int] | None:
    """The rows of a layer, as many as waves up to kx ask for; none for a membrane without mass."""
    if isinstance(layer, Membrane):
        mass = complex(layer.at(np.array([frequency]))[0])
        return None if mass == 0 else (Row(0.0, 0j, 1 / mass, 0j), 1)
    if not isinstance(layer.fluid, Fluid):
        raise ValueError(f"slab: finite elements take layers of fluid, got {layer.fluid!r}")
    values = layer.fluid.at(frequency)
    rho_z, rho_x, K = (complex(v) for v in values)
    if rho_z == 0 or rho_x == 0:
        raise ValueError(f"slab: finite elements need densities other than zero, got a layer with {layer.fluid!r}")
    mobility_x = 1 / rho_x if np.isfinite(rho_x) else 0j
    omega = 2 * math.pi * frequency
    kz = math.sqrt(max(abs(rho_z * omega**2 / K), abs(rho_z * (omega**2 / K - kx**2 * mobility_x))))
    count = max(least, math.ceil(layer.thickness * kz / (2 * math.pi * SIZE_OVER_WAVELENGTH[order])))
    return Row(layer.thickness / count, mobility_x, 1 / rho_z, 1 / K), count


def slab_rows(slab: Slab, frequency: float, kx: float, order: int, least: int = 1) -> list[Segment]:
    """A slab's segments as rows of elements.

    A layer is `least` rows, or more equal ones where these are thicker than `SIZE_OVER_WAVELENGTH` of its own
    wavelength along z (or decay length times 2 pi) for lateral wavenumbers up to kx.
    """

    def rows(cell: Cell) -> tuple[tuple[Row, int], ...]:
        of_layers = (_layer_rows(layer, frequency, kx, order, least) for layer in cell.layers)
        return tuple(row for row in of_layers if row is not None)

    return [(rows(cell), periods) for cell, periods in slab.segments]


def layout(segments: list[Segment], order: int) -> Layout:
    """Number the lines of a slab's rows."""
    kinds: dict[Row, int] = {}
    pieces = []
    for cell, periods in segments:
        numbers = [kinds.setdefault(row, len(kinds)) for row, count in cell for _ in range(count)]
        pieces.append(np.tile(numbers, periods))
    kind = np.concatenate(pieces)
    span = np.array([row.span(order) for row in kinds])[kind]
    height = np.array([row.thickness for row in kinds])[kind]
    start, near = np.cumsum(span) - span, np.cumsum(height) - height
    return Layout(tuple(kinds), kind, start, int(span.sum()) + 1, near)


# --- the field from the unknowns --------------------------------------------------------------------------


def along_x(strip: Strip, x: np.ndarray) -> sparse.csr_matrix:
    """Matrix (x.size, n) that evaluates a line's shape functions at x."""
    u = np.mod((x - strip.origin) / strip.period, 1.0) * strip.elements_x
    element = np.minimum(u.astype(int), strip.elements_x - 1)
    values = shape_functions(strip.order, u - element)
    columns = line_dofs(strip.order, strip.elements_x)[:, element]
    rows = np.broadcast_to(np.arange(x.size), columns.shape)
    return sparse.csr_matrix((values.ravel(), (rows.ravel(), columns.ravel())), shape=(x.size, strip.n))


def lines_at(strip: Strip, rows: Layout, solution: np.ndarray, z: np.ndarray) -> np.ndarray:
    """The unknowns (z.size, n) of horizontal lines at z inside the slab: the elements' own interpolation."""
    thick = np.flatnonzero(np.array([row.thickness for row in rows.kinds])[rows.kind])
    index = thick[np.clip(np.searchsorted(rows.near[thick], z, side="right") - 1, 0, thick.size - 1)]
    height = np.array([row.thickness for row in rows.kinds])[rows.kind[index]]
    weights = shape_functions(strip.order, np.clip((z - rows.near[index]) / height, 0.0, 1.0))
    line = rows.start[index] + line_numbers(strip.order)[:, None]
    out = np.zeros((z.size, strip.n), dtype=complex)
    for w, number in zip(weights, line, strict=True):
        out += w[:, None] * solution[number]
    return out
