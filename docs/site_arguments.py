"""Arguments with which the site runs the scripts of the gallery: a module of its own, for Sphinx stores what it was configured with."""

from __future__ import annotations

import os


def of_gallery(_configuration: dict, _script: dict) -> list[str]:
    """``--quick`` where the environment has BEAMPROP_QUICK set: fewer points, the same findings."""
    return ["--quick"] if os.environ.get("BEAMPROP_QUICK") else []
