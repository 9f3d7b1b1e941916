"""Does a change of the code change an answer? 300 varied questions, answered at two commits and compared.

    python experiments/same_answers.py answers OLD.npz      at the old commit (copy this file there if it has none)
    python experiments/same_answers.py answers NEW.npz      at the new one
    python experiments/same_answers.py compare OLD.npz NEW.npz

Public names only: fields, widths, measures, plane waves, Bloch waves, modes, files, commands. Differences are over the largest value
of each variable; those above 1e-12 are listed.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from tqdm import tqdm

import beamprop as bp

#: Questions of each kind; 300 in all.
COUNTS = {
    "field": 110,
    "periodic": 10,
    "width": 50,
    "measures": 30,
    "scattering": 40,
    "bloch": 20,
    "modes": 20,
    "file": 12,
    "command": 8,
}
#: Differences up to this are rounding.
ROUNDING = 1e-12


def slab_of(rng: np.random.Generator) -> bp.Slab:
    """The paper's cell, layers of any sign, or a uniform fluid; lossy or not."""
    loss = rng.choice([0.0, 1e-3, 0.05])
    kind = rng.integers(4)
    if kind == 0:
        return bp.Slab(bp.lmmd_cell(0.05 + 1j * loss, loss / 2), int(rng.choice([1, 40, 450])))
    if kind == 1:
        fluid = bp.Fluid((rng.uniform(0.3, 4) + 1j * loss) * 1.25, rng.uniform(0.3, 5) * (1 - 1j * loss) * 147061)
        return bp.Slab.uniform(fluid, rng.uniform(0.01, 0.5))
    signs = rng.choice([-1, 1] if kind == 2 else [1], 5)
    layers = [
        bp.Layer(
            bp.Fluid((sign * rng.uniform(0.2, 8) + 1j * max(loss, 1e-3)) * 1.25, rng.uniform(0.3, 5) * 147061),
            rng.uniform(0.002, 0.05),
        )
        for sign in signs
    ]
    after = bp.Fluid.from_speed(rng.uniform(0.8, 3), rng.uniform(250, 500))
    return bp.Slab(layers, int(rng.choice([1, 3, 10])), after=after)


def beam_of(rng: np.random.Generator) -> Any:
    """A Gaussian beam of either form, a profile or slits."""
    angle, z0 = float(rng.choice([0.0, 20.0, 45.0, 80.0])), -float(rng.choice([0.0, 0.1, 1.0]))
    kind = rng.integers(6)
    if kind < 3:
        return bp.GaussianBeam(rng.uniform(0.05, 1), angle, rng.uniform(-0.2, 0.2), z0)
    if kind == 3:
        return bp.GaussianBeam(rng.uniform(0.1, 0.5), min(angle, 45.0), 0.0, z0, form="rotated")
    if kind == 4:
        x = np.linspace(-0.6, 0.6, 121)
        return bp.Profile(x, np.exp(-((x / 0.15) ** 2)) * (1 + 0.3j * np.cos(9 * x)), z0, angle)
    return bp.Slits(0.03, 0.1, 2, -0.1, 0.0)


def _field(rng: np.random.Generator, boundary: str = "open") -> xr.Dataset:
    slab, beam = slab_of(rng), beam_of(rng)
    x = (
        np.linspace(-1, 1, int(rng.choice([7, 65, 512])))
        if rng.random() < 0.7 or boundary == "periodic"
        else np.sort(rng.uniform(-1, 1, 20))
    )
    if boundary == "periodic":
        x, beam = np.arange(-256, 256) * 0.02, bp.GaussianBeam(0.4, 20.0, z0=-0.1)
    z = np.sort(rng.uniform(0, slab.thickness + 0.3, int(rng.choice([1, 4, 220], p=[0.4, 0.5, 0.1]))))
    angle = None if rng.random() < 0.85 or not getattr(beam, "entire", True) else np.linspace(-20, 20, 12)
    return bp.field(
        slab, beam, rng.uniform(1500, 4000), x, z, angle, boundary=boundary, rtol=float(rng.choice([1e-6, 1e-8, 1e-10]))
    )


def _file(rng: np.random.Generator) -> xr.Dataset:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / ("a.nc" if rng.random() < 0.5 else "a.zarr")
        args = (slab_of(rng), bp.GaussianBeam(0.3, z0=-0.1), 2500.0, np.linspace(-1, 1, 33), [0.0, 0.01])
        if rng.random() < 0.5:
            bp.save(bp.field(*args), path)
        else:
            bp.save_field(path, *args)
        return bp.load(path).load()


COMMANDS = (
    ["width", "--frequency", "2000:3000:5"],
    ["spectrum", "--kx-over-k0", "0:3:31"],
    ["bloch", "--kx-over-k0=-5:5:21"],
    ["field", "--x=-0.5:0.5:33", "--z=0:1:5"],
    ["width", "--frequency", "2400", "--angle", "0:40:3"],
    ["spectrum", "--frequency", "2000:2500:3", "--kx-over-k0", "0.5"],
    ["field", "--x=-0.5:0.5:33", "--z=0:1:5", "--periods", "10"],
    ["modes", "--periods", "10"],
)


def _command(number: int) -> xr.Dataset:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.nc"
        code = "from beamprop.cli import main; main()"
        subprocess.run(
            [sys.executable, "-W", "ignore", "-c", code, *COMMANDS[number], "--output", str(path)],
            check=True,
            capture_output=True,
        )
        return bp.load(path).load()


def answer(kind: str, number: int) -> xr.Dataset:
    """One question, the same at every commit."""
    rng = np.random.default_rng([7, list(COUNTS).index(kind), number])
    if kind == "field":
        return _field(rng)
    if kind == "periodic":
        return _field(rng, "periodic")
    if kind == "width":
        return bp.beam_width(slab_of(rng), beam_of(rng), np.sort(rng.uniform(1500, 4000, 4)))
    if kind == "measures":
        return bp.beam_measures(slab_of(rng), beam_of(rng), rng.uniform(1500, 4000))
    if kind == "scattering":
        k = rng.uniform(0, 4, 50) + 1j * rng.choice([0, 0.1]) * rng.uniform(-1, 1, 50)
        return bp.scattering(slab_of(rng), np.sort(rng.uniform(500, 9000, 3)), kx_over_k0=k)
    if kind == "bloch":
        return bp.bloch(slab_of(rng).segments[0][0], rng.uniform(500, 9000), kx_over_k0=np.linspace(0, 8, 60))
    if kind == "modes":
        return bp.guided_modes(slab_of(rng), rng.uniform(1500, 4000), kx_over_k0_max=4.0)
    return _file(rng) if kind == "file" else _command(number)


def questions() -> Iterator[tuple[str, int]]:
    """All of them."""
    yield from ((kind, number) for kind, count in COUNTS.items() for number in range(count))


def answers(path: str) -> None:
    """Every answer's numbers in one file; of a refusal, its text."""
    out: dict[str, np.ndarray] = {}
    for kind, number in tqdm(list(questions()), file=sys.stderr):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            try:
                ds = answer(kind, number)
            except ValueError as refusal:
                out[f"{kind}/{number}/refused"] = np.array(str(refusal))
                continue
        out[f"{kind}/{number}/warnings"] = np.array(sorted({w.category.__name__ for w in caught}), dtype=str)
        for name, variable in ds.variables.items():
            out[f"{kind}/{number}/{name}"] = variable.values
    np.savez_compressed(path, **out)


def compare(old_path: str, new_path: str) -> str:
    """How the answers of two commits differ, as a text."""
    old, new = np.load(old_path), np.load(new_path)
    lines, worst = [], {}
    for key in sorted(set(old.files) | set(new.files)):
        if key not in old.files or key not in new.files:
            lines.append(f"{key}: only in the {'new' if key in new.files else 'old'} answers")
            continue
        a, b = old[key], new[key]
        if a.dtype.kind in "US" or a.shape != b.shape:
            if a.shape != b.shape or np.any(a != b):
                lines.append(f"{key}: {a} became {b}")
            continue
        if key.endswith("error_estimate"):  # what is estimated is rounding itself
            if not np.all((b < 30 * a + 1e-12) & (a < 30 * b + 1e-12) | ~np.isfinite(a)):
                lines.append(f"{key}: {np.max(a):.1e} became {np.max(b):.1e}")
            continue
        size = np.nanmax(np.abs(a), initial=0.0)
        apart = np.nanmax(np.abs(a - b), initial=0.0) / (size or 1.0)
        if np.any(np.isnan(a) != np.isnan(b)):
            apart = np.inf
        kind = key.split("/")[0]
        worst[kind] = max(worst.get(kind, 0.0), float(apart))
        if apart > ROUNDING:
            lines.append(f"{key}: differs by {apart:.1e}")
    table = [f"{kind}: largest difference {value:.1e}" for kind, value in worst.items()]
    return "\n".join([*table, f"{len(lines)} differences above {ROUNDING:g}", *lines])


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["answers", "compare"])
    parser.add_argument("files", nargs="+")
    given = parser.parse_args()
    if given.what == "answers":
        answers(given.files[0])
    else:
        print(compare(*given.files))


if __name__ == "__main__":
    main()
