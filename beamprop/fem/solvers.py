"""Two solvers of one discrete problem, and the residual of its global equations.

The slab's matrix A joins its rows; a row's matrix takes the unknowns of its lines to outward fluxes through
its faces. With the flux per pressure B of the two half-spaces and the source s, the global equations are

    (A - B) p = -s        (B and s act on the two outer lines, s on the near one).

"sparse" assembles them and factors them with SuperLU. "superelement" condenses rows to their two faces and
merges neighbours, a block of 2^k periods at the price of k merges. It keeps Robin maps: with Y = scale *
(mass of a line) and the outward flux f of a block, ``g = f - i Y p`` enters the block, ``h = f + i Y p``
leaves it, and ``h = S g``. Condensing on Dirichlet data instead fails wherever a block resonates between hard
walls; in a passive slab a Robin problem never does.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, TypeVar

import numpy as np
from scipy import linalg, sparse
from scipy.sparse.linalg import splu

from .boundary import Ends
from .strip import Layout, Row, Segment, Strip, row_matrix

T = TypeVar("T")
Progress = Callable[[int], Any]


@dataclass(frozen=True, eq=False)
class Leaf:
    """One row of elements: Robin map S (2n, 2n), and p on all its lines from what enters, (lines n, 2n)."""

    S: np.ndarray
    lines: np.ndarray
    span: int


@dataclass(frozen=True, eq=False)
class Pair:
    """Two blocks, near and far: the map S of both, and from what enters (2n) what enters each at their common face."""

    S: np.ndarray
    near: Block
    far: Block
    into_near: np.ndarray
    into_far: np.ndarray
    span: int


Block = Leaf | Pair


# --- condensation, upward ---------------------------------------------------------------------------------


def _leaf(matrix: sparse.csr_matrix, Y: np.ndarray, span: int) -> Leaf:
    """Condense one row: (A - i Y on both faces) p = g."""
    n, size = Y.shape[0], matrix.shape[0]
    faces = np.r_[0:n, size - n : size]
    entering = np.zeros((size, 2 * n), dtype=complex)
    entering[faces, np.arange(2 * n)] = 1
    Y2 = sparse.block_diag([Y, sparse.csr_matrix((size - 2 * n, size - 2 * n)), Y], format="csc")
    robin = (matrix - 1j * Y2).tocsc()
    lines = splu(robin).solve(entering)
    p = lines[faces]
    S = np.eye(2 * n) + 2j * np.vstack([Y @ p[:n], Y @ p[n:]])
    return Leaf(S, lines, span)


def _pair(near: Block, far: Block) -> Pair:
    """Merge two blocks: p is continuous at their common face and fluxes cancel, so g of one is -h of the other."""
    n = near.S.shape[0] // 2
    a, b = near.S, far.S
    entering = np.hstack([b[:n, :n] @ a[n:, :n], -b[:n, n:]])
    into_near = linalg.solve(np.eye(n) - b[:n, :n] @ a[n:, n:], entering, overwrite_b=True, check_finite=False)
    into_far = -a[n:, n:] @ into_near
    into_far[:, :n] -= a[n:, :n]
    S = np.vstack([a[:n, n:] @ into_near, b[n:, :n] @ into_far])
    S[:n, :n] += a[:n, :n]
    S[n:, n:] += b[n:, n:]
    return Pair(S, near, far, into_near, into_far, near.span + far.span)


def _chain(blocks: list[T], pair: Callable[[T, T], T]) -> T:
    """Merge neighbours, then neighbours of those, so that a long list stays shallow."""
    while len(blocks) > 1:
        pairs = [pair(a, b) for a, b in zip(blocks[::2], blocks[1::2], strict=False)]
        blocks = pairs + blocks[2 * len(pairs) :]
    return blocks[0]


def _power(block: T, count: int, pair: Callable[[T, T], T]) -> T:
    """`count` copies of a block by powers of two."""
    parts: list[T] = []
    while True:
        if count & 1:
            parts.insert(0, block)
        count >>= 1
        if not count:
            return _chain(parts, pair)
        block = pair(block, block)


def _merge(segments: list[Segment], leaf: Callable[[Row], T], pair: Callable[[T, T], T]) -> T:
    """A whole slab from its distinct rows; equal rows and equal cells are made once."""
    leaf = lru_cache(None)(leaf)

    @lru_cache(None)
    def cell(rows: tuple[tuple[Row, int], ...]) -> T:
        return _chain([_power(leaf(row), count, pair) for row, count in rows], pair)

    return _chain([_power(cell(rows), periods, pair) for rows, periods in segments], pair)


def _condense(strip: Strip, segments: list[Segment], omega: float, scale: float, progress: Progress) -> Block:
    """The Robin map of the whole slab, with the tree that led to it."""
    Y = scale * strip.line_mass

    def leaf(row: Row) -> Block:
        progress(1)
        return _leaf(row_matrix(strip, row, omega), Y, row.span(strip.order))

    def pair(near: Block, far: Block) -> Block:
        progress(1)
        return _pair(near, far)

    return _merge(segments, leaf, pair)


# --- recovery, downward -----------------------------------------------------------------------------------


def _descend(block: Block, entering: np.ndarray, starts: np.ndarray, out: np.ndarray) -> None:
    """Fill out[lines, n] from what enters copies of a block, (2n, copies), whose first lines are `starts`."""
    if isinstance(block, Leaf):
        p = (block.lines @ entering).reshape(-1, out.shape[1], starts.size)
        for line in range(p.shape[0]):
            out[starts + line] = p[line].T
        return
    n = out.shape[1]
    near = np.vstack([entering[:n], block.into_near @ entering])
    far = np.vstack([block.into_far @ entering, entering[n:]])
    behind = starts + block.near.span
    if block.near is block.far:  # both halves at once: one product of twice the width
        _descend(block.near, np.hstack([near, far]), np.concatenate([starts, behind]), out)
    else:
        _descend(block.near, near, starts, out)
        _descend(block.far, far, behind, out)


def superelement(
    strip: Strip, segments: list[Segment], rows: Layout, ends: Ends, omega: float, progress: Progress
) -> np.ndarray:
    """The solution p (lines, n): condense, merge, close with both half-spaces, and recover every line."""
    n = strip.n
    slab = _condense(strip, segments, omega, ends.scale, progress)
    Y = ends.scale * strip.line_mass.toarray()
    # (S - 1) g = 2 i Y p on each face, and g = (B - i Y) p - s
    face = linalg.solve(2j * Y, np.eye(n), assume_a="sym")
    D = linalg.block_diag((ends.near - 1j * Y) @ face, (ends.far - 1j * Y) @ face)
    s = np.concatenate([ends.source, np.zeros(n)])
    unit = np.eye(2 * n)
    entering = linalg.solve(unit - D @ (slab.S - unit), -s)
    out = np.empty((rows.lines, n), dtype=complex)
    _descend(slab, entering[:, None], np.zeros(1, dtype=int), out)
    return out


# --- the other solver -------------------------------------------------------------------------------------


def _tiled(matrix: sparse.coo_matrix, offsets: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Values, rows and columns of copies of a matrix at diagonal offsets."""
    row, column = (np.add.outer(offsets, index).ravel() for index in (matrix.row, matrix.col))
    return np.tile(matrix.data, offsets.size), row, column


def assemble(strip: Strip, rows: Layout, ends: Ends, omega: float) -> sparse.csc_matrix:
    """The global matrix A - B."""
    n, last = strip.n, (rows.lines - 1) * strip.n
    parts = [
        _tiled(row_matrix(strip, row, omega).tocoo(), rows.start[rows.kind == number] * n)
        for number, row in enumerate(rows.kinds)
    ]
    for B, offset in ((ends.near, 0), (ends.far, last)):
        parts.append(_tiled(sparse.coo_matrix(-B), np.array([offset])))
    data, row, column = (np.concatenate(part) for part in zip(*parts, strict=True))
    return sparse.csc_matrix((data, (row, column)), shape=(rows.lines * n, rows.lines * n))


def direct(
    strip: Strip, segments: list[Segment], rows: Layout, ends: Ends, omega: float, progress: Progress
) -> np.ndarray:
    """The solution p (lines, n) by SuperLU.

    Minimum degree on the symmetric pattern: the default column ordering is 80 times slower. Hardly any
    pivoting, which halves the factors, and refinement to make up for it; with more pivoting where that is not
    enough.
    """
    K = assemble(strip, rows, ends, omega)
    f = np.zeros(K.shape[0], dtype=complex)
    f[: strip.n] = -ends.source
    for threshold in (1e-6, 1e-2, 1.0):
        p, rest = _factor_and_refine(K, f, threshold)
        if rest < 1e-11:
            break
    progress(1)
    return p.reshape(rows.lines, strip.n)


def _factor_and_refine(K: sparse.csc_matrix, f: np.ndarray, threshold: float) -> tuple[np.ndarray, float]:
    """Solve K p = f with a pivot threshold; p and its relative residual after up to four refinements."""
    try:
        factors = splu(K, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=threshold, options={"SymmetricMode": True})
    except SystemError as error:  # what SuperLU says when memory ends
        raise MemoryError(f"the sparse factors of {K.shape[0]} unknowns did not fit into memory") from error
    p, best = np.zeros_like(f), np.inf
    rest = f
    for _ in range(5):
        trial = p + factors.solve(rest)
        rest = f - K @ trial
        size = float(np.linalg.norm(rest) / np.linalg.norm(f))
        if not size < best / 2:
            break
        p, best = trial, size
    return p, best


SOLVERS: dict[str, Callable[..., np.ndarray]] = {"superelement": superelement, "sparse": direct}


def _blocks(starts: np.ndarray, size: int) -> Iterable[np.ndarray]:
    count = max(1, 4_000_000 // size)
    return (starts[first : first + count] for first in range(0, starts.size, count))


def residual(strip: Strip, rows: Layout, ends: Ends, omega: float, p: np.ndarray) -> float:
    """|| (A - B) p + s || / || s ||, row by row of elements over the whole slab."""
    out = np.zeros_like(p)
    for number, row in enumerate(rows.kinds):
        matrix = row_matrix(strip, row, omega)
        lines = row.span(strip.order) + 1
        for starts in _blocks(rows.start[rows.kind == number], matrix.shape[0]):
            values = p[starts[:, None] + np.arange(lines)].reshape(starts.size, -1)
            flux = (matrix @ values.T).T.reshape(starts.size, lines, strip.n)
            for line in range(lines):
                out[starts + line] += flux[:, line]
    out[0] += ends.source - ends.near @ p[0]
    out[-1] -= ends.far @ p[-1]
    return float(np.linalg.norm(out) / np.linalg.norm(ends.source))


# --- what they cost ---------------------------------------------------------------------------------------


def _merges(segments: list[Segment]) -> int:
    """How many pairs of blocks are merged."""
    count = [0]

    def pair(near: None, far: None) -> None:
        count[0] += 1

    _merge(segments, lambda row: None, pair)
    return count[0]


def _superelement_cost(segments: list[Segment], rows: Layout, n: int, order: int) -> tuple[float, float]:
    leaves, merges = len(rows.kinds), _merges(segments)
    solution = 16 * rows.lines * n
    memory = 16 * n**2 * (leaves * (4 + 2 * (order + 1)) + 8 * merges + 24) + 4 * solution + 1e8
    condense = 2.5e-9 * n**3 * (merges + 8) + 2e-7 * n**2 * order**2 * leaves
    return memory, condense + 1.5e-9 * n**2 * rows.lines + 0.1


def _sparse_cost(segments: list[Segment], rows: Layout, n: int, order: int) -> tuple[float, float]:
    dofs = rows.lines * n
    return 18 * dofs * n + 1e8, 8e-10 * dofs * n**2 + 0.1


#: Predicted memory [bytes] and time [s] from segments, layout, unknowns on a line and order; measured on one core by
#: experiments/benchmarks/constants.py COSTS.
COSTS: dict[str, Callable[..., tuple[float, float]]] = {"superelement": _superelement_cost, "sparse": _sparse_cost}


def step_count(segments: list[Segment], method: str) -> int:
    """How often a solver reports progress."""
    if method == "sparse":
        return 1
    return _merges(segments) + len({row for rows, _ in segments for row, _ in rows})
