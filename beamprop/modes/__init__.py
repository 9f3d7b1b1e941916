"""Guided modes: zeros of the dispersion function by the argument principle, and those on the wrong side of a contour."""
