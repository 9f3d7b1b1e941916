"""Fluids, layers, cells and slabs; the paper's cell; effective media; all of them as arrays at given frequencies."""
