"""The table of materials as docs/media.md shows it: ``python experiments/materials.py > TABLE.md``."""

from __future__ import annotations

import math

import beamprop as bp


def table() -> str:
    """A row a material, and below them the sources that the rows number."""
    rows = bp.materials()
    sources = list(dict.fromkeys(row.source for row in rows.values()))
    lines = [
        "| name | density (kg/m3) | speed (m/s) | shear speed (m/s) | attenuation (dB/cm) | conditions | source |",
        "|---|---|---|---|---|---|---|",
    ]
    for name, row in rows.items():
        shear = "" if row.shear_speed is None else f"{row.shear_speed:g}"
        number = sources.index(row.source) + 1
        lines.append(
            f"| {name} | {row.density:.6g} | {row.sound_speed:.6g} | {shear} | {_loss(name)} | {row.conditions} | {number} |"
        )
    return "\n".join([*lines, "", *(f"{i}. {source}" for i, source in enumerate(sources, start=1))])


def _loss(name: str) -> str:
    """dB/cm at 1 MHz; of air at 1 kHz, in dB/km."""
    frequency, length, unit = (1e3, 1e3, " dB/km at 1 kHz") if name == "air" else (1e6, 1e-2, " at 1 MHz")
    if bp.materials()[name].attenuation is None:
        return ""
    nepers = float(bp.material(name, attenuation=True).wavenumber(frequency).imag) * length
    return f"{20 / math.log(10) * nepers:.3g}{unit}"


if __name__ == "__main__":
    print(table())
