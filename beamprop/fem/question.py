"""The questions to the finite elements: `plan` predicts what a solve takes, `field` does it."""

from __future__ import annotations

import math
import time
import warnings
from typing import TYPE_CHECKING

import numpy as np

from .. import validate
from ..io import datasets
from ..media.structures import Slab
from ..progress import Progress, Steps
from ..sources.base import Beam
from ..sources.in_space import check_on_a_line
from . import boundary, solvers, strip
from .task import Plan, Task, make_task, predict, wavenumber

if TYPE_CHECKING:
    import xarray as xr

#: Field over incident field of an order above which a warning names a guided mode. Near 1 away from them; 290 went with an error
#: of 3e-4 and 4000 with one of 5e-2 (order 3, lossless, 20 periods of the paper's cell): it grows as the square, and leaves below
#: this what `SIZE_OVER_WAVELENGTH` promises.
GUIDED_GAIN = 300.0


def plan(
    slab: Slab,
    beam: Beam,
    frequency: float,
    period: float,
    order: int = 3,
    elements_x: int | None = None,
    method: str = "superelement",
    layer_rows: int = 1,
) -> Plan:
    """What `field` with the same arguments takes, before anything is solved.

    Parameters
    ----------
    slab, beam, frequency, period, order, elements_x, method, layer_rows
        As in `field`.

    Returns
    -------
    Plan
        dofs, elements_x, elements_z, memory [bytes], seconds; the last two within a factor of about two.

    Examples
    --------
    >>> slab, beam = bp.Slab(bp.lmmd_cell(), periods=2), bp.GaussianBeam(0.096)
    >>> bp.fem.plan(slab, beam, 2500.0, period=1.0).elements_z
    20
    """
    return predict(make_task(slab, beam, frequency, period, order, elements_x, method, layer_rows))


# --- warnings ---------------------------------------------------------------------------------------------


def _check_window(task: Task) -> None:
    """Refuse or warn where the launched profile reaches out of the window."""
    half, centre = task.period / 2, task.beam.centre
    k0 = float(task.slab.before.wavenumber(task.frequency).real)
    source = min(half, task.beam.reach(1e-3))
    inside = np.abs(task.beam.profile(centre + np.linspace(-source, source, 401), k0))
    outside = np.linspace(half, 2 * half, 101)
    tail = np.abs(task.beam.profile(centre + np.concatenate([-outside, outside]), k0))
    share = float(tail.max() / max(inside.max(), tail.max()))
    message = (
        f"the beam has {share:.2g} of its largest pressure at {half:.4g} m from its centre, "
        f"where a window of {task.period:.4g} m ends"
    )
    if share > 1e-1:
        raise ValueError(f"period: expected a window that holds the beam; {message}")
    if share > 1e-3:
        warnings.warn(f"period: {message}; it overlaps with its own copies", stacklevel=3)


def _warn_grazing(task: Task, orders: boundary.Orders) -> None:
    """An integer period in wavelengths: an order along the face of a half-space."""
    for name, kz in (("before", orders.before), ("after", orders.after)):
        k = complex(getattr(task.slab, name).wavenumber(task.frequency))
        if not math.isfinite(abs(k)):
            continue
        m = int(np.argmin(np.abs(kz)))
        if abs(kz[m]) < 1e-2 * abs(k):
            warnings.warn(
                f"period: {task.period * abs(k) / (2 * math.pi):.6g} wavelengths of the medium {name} the slab put the "
                f"order {m - kz.size // 2:+d} at |kz| = {abs(kz[m]) / abs(k):.1e} k; choose a period that is no whole "
                "number of wavelengths",
                stacklevel=3,
            )


def _warn_unresolved(task: Task, count: int) -> None:
    """A beam with more orders than the mesh has."""
    orders = boundary.orders(task.slab, task.beam, task.frequency, task.period, 4 * count)
    strength = np.abs(orders.incident) ** 2
    beyond = math.sqrt((strength[: 3 * count].sum() + strength[5 * count + 1 :].sum()) / strength.sum())
    if beyond > 1e-2:
        warnings.warn(
            f"elements_x: {task.elements_x} elements of order {task.order} leave out orders with "
            f"{beyond:.2g} of the beam on the near face",
            stacklevel=3,
        )


def _warn_guided(task: Task, orders: boundary.Orders, near: np.ndarray, far: np.ndarray) -> None:
    """An order beside a guided mode: it answers far above what drives it, and magnifies the mesh's error as much."""
    answer = np.maximum(np.abs(near - orders.incident), np.abs(far))
    driven = np.abs(orders.incident)
    # beyond half of elements_x an order may be the mesh's image of a strong one, no answer to its own drive
    matters = np.abs(np.arange(driven.size) - driven.size // 2) <= 0.5 * task.elements_x
    matters &= (driven > 1e-12 * driven.max()) & (answer > 1e-5 * driven.max())
    gain = np.where(matters, answer / np.where(matters, driven, 1.0), 0.0)
    m = int(np.argmax(gain))
    if gain[m] > GUIDED_GAIN:
        k0 = wavenumber(task.slab, task.frequency)
        warnings.warn(
            f"period: the order {m - gain.size // 2:+d} at kx = {orders.kx[m] / k0:.5f} k0 lies beside a guided mode "
            f"of the slab, its field is {gain[m]:.3g} times the incident one; the result is sensitive there, "
            "choose another period or a higher order",
            stacklevel=3,
        )


# --- the question -----------------------------------------------------------------------------------------


def _check_memory(expected: Plan, memory_limit: float) -> None:
    if expected.memory > memory_limit:
        raise ValueError(
            f"memory_limit: expected at least {expected.memory:.3g} bytes for {expected.dofs} unknowns "
            f"({expected.elements_x} x {expected.elements_z} elements, about {expected.seconds:.3g} s), got {memory_limit:.3g}"
        )


def _evaluate(
    task: Task,
    mesh: strip.Strip,
    orders: boundary.Orders,
    solution: np.ndarray,
    C: np.ndarray,
    x: np.ndarray,
    z: np.ndarray,
) -> np.ndarray:
    """p(z, x): Fourier sums in front and behind, the elements' interpolation inside."""
    thickness = task.slab.thickness
    near, far = C.conj().T @ solution[0], C.conj().T @ solution[-1]
    front, behind = z <= 0, z >= thickness
    inside = ~(front | behind)
    amplitudes = np.zeros((z.size, orders.kx.size), dtype=complex)
    amplitudes[front] = orders.launched * np.exp(1j * np.multiply.outer(z[front] - task.beam.z0, orders.before))
    amplitudes[front] += (near - orders.incident) * np.exp(-1j * np.multiply.outer(z[front], orders.before))
    amplitudes[behind] = far * np.exp(1j * np.multiply.outer(z[behind] - thickness, orders.after))
    p = np.empty((z.size, x.size), dtype=complex)
    p[~inside] = amplitudes[~inside] @ np.exp(1j * np.multiply.outer(orders.kx, x))
    p[inside] = (strip.along_x(mesh, x) @ strip.lines_at(mesh, task.rows, solution, z[inside]).T).T
    return p


def _solve(
    task: Task, steps: solvers.Progress
) -> tuple[strip.Strip, boundary.Orders, boundary.Ends, np.ndarray, float]:
    """The mesh, the orders, the open sides, the solution and its residual."""
    mesh = strip.make_strip(task.period, task.beam.centre - task.period / 2, task.order, task.elements_x)
    orders = boundary.orders(task.slab, task.beam, task.frequency, task.period, (mesh.n - 1) // 2)
    ends = boundary.ends(mesh, task.slab, task.frequency, orders)
    solution = solvers.SOLVERS[task.method](mesh, task.segments, task.rows, ends, task.omega, steps)
    return mesh, orders, ends, solution, solvers.residual(mesh, task.rows, ends, task.omega, solution)


def field(
    slab: Slab,
    beam: Beam,
    frequency: float,
    x: np.ndarray,
    z: np.ndarray,
    period: float,
    angle: float | None = None,
    order: int = 3,
    elements_x: int | None = None,
    method: str = "superelement",
    memory_limit: float = 4e9,
    progress: Progress = False,
    layer_rows: int = 1,
) -> xr.Dataset:
    """The sound field of a beam and its copies every `period`, from a full-wave finite-element solve.

    An independent witness for ``beamprop.field(..., boundary="periodic", period=period)``: it shares the
    description of slab and beam with it and nothing else.

    Parameters
    ----------
    slab : Slab
        Any: stacks, different half-spaces, dispersive, anisotropic, lossy or negative densities, membranes.
    beam : Beam
    frequency : float, Hz
    x : 1-D array, m
        Anywhere: the field repeats every `period`. The mesh's window is centred on the beam.
    z : 1-D array, m
        From the launch plane on: in front, inside and behind.
    period : float, m
        Width of the window. Take no whole number of wavelengths of either half-space.
    angle : float, optional, degree
        Instead of the beam's.
    order : 1, 2, 3 or 4
        Of the tensor-product elements.
    elements_x : int, optional
        Elements along x. Default: 0.05, 0.1, 0.2 or 0.3 wavelengths in front for orders 1 to 4, or finer by
        up to a factor of two where the beam's orders on the near face ask for it. Only orders that the mesh
        resolves are used: those below half the number of unknowns on a line.
    method : "superelement" or "sparse"
        "superelement" condenses the rows and merges periods by powers of two: the choice for many periods.
        "sparse" factors the global matrix: the choice for a slab of many different layers. Both solve the
        same equations.
    memory_limit : float, bytes
    progress : bool or function
        True: a bar on stderr for work of more than a second. A function wraps the list of steps that is worked through.
    layer_rows : int
        Rows of elements in a layer, at least. A layer thicker than the size above over its own wavelength
        along z is divided further anyway; thin layers need a second row for studies of convergence only.

    Returns
    -------
    xarray.Dataset
        `p` (z, x), complex, with scalar coordinates `frequency` and `angle`: the total pressure, in front the
        Fourier sum of incident and reflected orders, inside the interpolation by the elements' shape
        functions. Attributes: `dofs`, `elements_x`, `elements_z`, `order`, `orders`, `method`, `boundary`,
        `period`, `seconds`, and `residual`, the relative residual of the global discrete equations.

    Raises
    ------
    ValueError
        Arguments out of range, a layer of density 0, a window that does not hold the beam, or more memory
        than `memory_limit` predicted.
    ImportError
        Without scikit-fem.

    Warns
    -----
    UserWarning
        With the number: a period that puts an order on kz = 0, an order beside a guided mode, a window too
        narrow for the beam, and a mesh too coarse for it.

    Notes
    -----
    On a busy machine set OPENBLAS_NUM_THREADS=1: threads that wait for each other cost several times more than
    they bring.

    Examples
    --------
    >>> slab, beam = bp.Slab(bp.lmmd_cell(), periods=2), bp.GaussianBeam(0.096)
    >>> x, z = np.linspace(-0.4, 0.4, 41), [0.0, slab.thickness]
    >>> ours = bp.field(slab, beam, 2500.0, x, z, boundary="periodic", period=1.0)
    >>> bool(bp.compare(ours, bp.fem.field(slab, beam, 2500.0, x, z, period=1.0)).relative_l2 < 1e-3)
    True
    """
    began = time.perf_counter()
    validate.flag_or_function(progress, "progress")
    x, z = validate.positions(x, "x"), validate.positions(z, "z")
    check_on_a_line(beam)
    if angle is not None and isinstance(beam, Beam):
        beam = beam.at_angle(validate.angle(angle))
    task = make_task(slab, beam, frequency, period, order, elements_x, method, layer_rows)
    if z.min() < beam.z0:
        raise ValueError(f"z: expected positions from the launch plane z0 = {beam.z0} m on, got {z.min()}")
    expected = predict(task)
    _check_memory(expected, validate.as_number(memory_limit, "memory_limit", positive=True))
    _check_window(task)
    steps = Steps(progress, solvers.step_count(task.segments, task.method), "finite elements")
    mesh, orders, ends, solution, residual = _solve(task, steps.step)
    steps.close()
    _warn_grazing(task, orders)
    _warn_unresolved(task, orders.kx.size // 2)
    C = ends.transform
    _warn_guided(task, orders, C.conj().T @ solution[0], C.conj().T @ solution[-1])
    settings = {
        "period": task.period,
        "boundary": "periodic",
        "order": task.order,
        "method": method,
        "elements_x": task.elements_x,
        "layer_rows": layer_rows,
    }
    ds = datasets.make(
        {"p": (("z", "x"), _evaluate(task, mesh, orders, solution, C, x, z))},
        {"z": (("z",), z), "x": (("x",), x), "frequency": ((), task.frequency), "angle": ((), float(beam.angle))},
        "fem.field",
        np.array([task.frequency]),
        slab=slab,
        beam=beam,
        **settings,
    )
    ds.attrs.update(
        settings,
        dofs=expected.dofs,
        elements_z=expected.elements_z,
        orders=int(orders.kx.size),
        slab_thickness=slab.thickness,
        residual=residual,
        seconds=time.perf_counter() - began,
    )
    return ds
