"""Layers in words: "air 5mm", "solid steel 1mm", "density=1000 speed=1480 2mm"."""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import Any

from .values import LENGTHS

_SHORT = {"speed": "sound_speed", "c": "sound_speed", "rho": "density", "modulus": "bulk_modulus"}


def described(text: str, name: str, known: Collection[str]) -> dict[str, Any]:
    """The table that words stand for: key=value, a length, and what is left is a material's name."""
    table: dict[str, Any] = {}
    names = []
    for part in re.sub(rf"(?<=[\d.])\s+(?=({'|'.join(LENGTHS)})\b)", "", text).replace(",", " ").split():
        key, equals, value = part.partition("=")
        if equals and _SHORT.get(key, key) in known:
            table[_SHORT.get(key, key)] = value
        elif equals:
            raise refused(text, name)
        elif part[0].isdigit() or part[0] in ".+-":
            table["thickness"] = part
        else:
            names.append(part)
    return table | ({"material": " ".join(names)} if names else {})


def refused(given: Any, name: str) -> ValueError:
    """What is no layer."""
    from .. import validate

    return validate.refuse(name, "a fluid and a thickness such as 'air 5mm' or 'density=1000 speed=1480 2mm'", given)
