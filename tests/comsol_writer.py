"""A writer of files like COMSOL's exports, from the description of the format: for the tests of `read_comsol`.

It knows nothing of the reader. Numbers are written as Java does, all digits, 'E-5' for 'e-05'. Points are rows.
"""

from __future__ import annotations

import numpy as np

SIZES = {"m": 1.0, "dm": 10.0, "cm": 100.0, "mm": 1e3, "um": 1e6, "\N{MICRO SIGN}m": 1e6, "in": 1 / 0.0254}


def real(value, comma=False):
    """-3.308E-5, or with a decimal comma."""
    if not np.isfinite(value):
        return "NaN" if np.isnan(value) else ("Inf" if value > 0 else "-Inf")
    text = repr(float(value)).removesuffix(".0")
    if "e" in text:
        mantissa, exponent = text.split("e")
        text = f"{mantissa}E{int(exponent)}"
    return text.replace(".", ",") if comma else text


def number(value, imaginary="i", comma=False):
    """A real value, or -3.308E-5-0.00388i; a complex value that happens to be real has no imaginary part."""
    if not isinstance(value, complex | np.complexfloating):
        return real(value, comma)
    if np.isnan(value):
        return "NaN"
    if value.imag == 0:
        return real(value.real, comma)
    sign = "-" if value.imag < 0 or (value.imag == 0 and np.signbit(value.imag)) else "+"
    return real(value.real, comma) + sign + real(abs(value.imag), comma) + imaginary


def parameters(settings, style="plain", index=None):
    """' @ freq=100, theta=0'; values that are strings stand as they are. style 'indexed': ' @ 3: freq=100 Hz, …'."""
    if not settings:
        return ""
    text = ", ".join(f"{n}={v if isinstance(v, str) else number(v)}" for n, v in settings.items())
    return f" @ {index}: {text}" if style == "indexed" else f" @ {text}"


def meta(
    style, unit, nodes, expressions, dimension, leave_out=(), version="COMSOL 6.0.0.354", description="Total field"
):
    """The lines of the header above the names of the columns."""
    items = {
        "Model": "slab.mph",
        "Version": version,
        "Date": "Sep 1 2022, 14:21",
        "Dimension": dimension,
        "Nodes": nodes,
        "Expressions": expressions,
        "Description": description,
        "Length unit": unit,
    }
    lines = []
    for key, value in items.items():
        if key in leave_out or (key == "Length unit" and unit is None):
            continue
        if style in ("txt", "dat"):
            lines.append(f"% {key + ':':<20}{value}")
        else:
            parts = ";" if style == "semicolon" else ","
            lines.append(f'% {key}{parts}"{value}"' if "," in str(value) else f"% {key}{parts}{value}")
    return lines


def text_file(folder, text):
    """A file of a text as it stands."""
    path = folder / "export.txt"
    path.write_text(text)
    return path


def _finish(path, lines, crlf=False, encoding="utf-8"):
    path.write_bytes(("\r\n" if crlf else "\n").join([*lines, ""]).encode(encoding))
    return path


def spreadsheet(
    path,
    coordinates,
    columns,
    style="csv",
    unit="m",
    comma=False,
    imaginary="i",
    header=True,
    percent=True,
    gap=3,
    leave_out=(),
    quote=False,
    rows=None,
    crlf=False,
    encoding="utf-8",
    **more,
):
    """A spreadsheet export.

    coordinates : name -> (points,) in m;  columns : list of (name, (points,) values)
    style : 'csv', 'semicolon', 'txt' and 'dat' (blanks between columns)
    comma : decimal commas;  gap : fewest blanks between two names of txt;  rows : as many of the rows only
    """
    names = [*coordinates, *(n for n, _ in columns)]
    data = [*(np.asarray(c) * SIZES.get(unit, 1.0) for c in coordinates.values()), *(v for _, v in columns)]
    lines = meta(style, unit, data[0].size, len(columns), len(coordinates), leave_out, **more)
    table = [[number(v, imaginary, comma) for v in row] for row in zip(*data, strict=True)][:rows]
    if style in ("txt", "dat"):
        cells = [f"{n:<24}" if len(n) < 24 else n for n in names]
        title = (" " * gap).join(n.strip() if gap == 1 and k >= len(coordinates) else n for k, n in enumerate(cells))
        body = ["   ".join(f"{c:<22}" for c in row).rstrip() for row in table]
    else:
        parts = ";" if style == "semicolon" else ","
        title = parts.join(f'"{n}"' if quote else n for n in names)
        body = [parts.join(f'"{c}"' if quote or (comma and parts == ",") else c for c in row) for row in table]
    if header:
        lines.append(f"% {title}" if percent else title)
    return _finish(path, [*lines, *body], crlf, encoding)


def grid(
    path,
    axes,
    columns,
    unit="m",
    comma=False,
    imaginary="i",
    style="txt",
    label="inside",
    leave_out=(),
    crlf=False,
    encoding="utf-8",
    **more,
):
    """A grid export. axes : 1-D arrays in m, the first runs along a row; columns : (name, array (…, second, first)).

    label : 'inside' for '% Data (name)', 'below' for '% Data' and '% name', 'none'
    """
    size = int(np.prod([len(a) for a in axes]))
    parts = "," if style == "csv" else "   "
    lines = [*meta(style, unit, size, len(columns), len(axes), leave_out, **more), "% Grid"]
    lines += [parts.join(real(v, comma) for v in np.asarray(a) * SIZES.get(unit, 1.0)) for a in axes]
    for name, values in columns:
        lines += _label(name, label)
        rows = np.asarray(values).reshape(-1, len(axes[0]))
        lines += [parts.join(number(v, imaginary, comma) for v in row) for row in rows]
    return _finish(path, lines, crlf, encoding)


def sectionwise(
    path,
    coordinates,
    elements,
    columns,
    unit="m",
    imaginary="i",
    label="inside",
    leave_out=(),
    crlf=False,
    encoding="utf-8",
    **more,
):
    """A sectionwise export. coordinates : (points, 2) in m; elements : (elements, corners) from 0."""
    lines = meta("txt", unit, len(coordinates), len(columns), coordinates.shape[1], leave_out, **more)
    lines.append("% Coordinates")
    lines += ["   ".join(f"{real(v):<22}" for v in row).rstrip() for row in coordinates * SIZES.get(unit, 1.0)]
    if elements is not None:
        lines += ["% Elements (triangles)", *("   ".join(str(k + 1) for k in row) for row in elements)]
    for name, values in columns:
        lines += [*_label(name, label), *(number(v, imaginary) for v in values)]
    return _finish(path, lines, crlf, encoding)


def _label(name, label):
    return {"inside": [f"% Data ({name})"], "below": ["% Data", f"% {name}"], "none": ["% Data"]}[label]
