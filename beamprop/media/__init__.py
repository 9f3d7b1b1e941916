"""Fluids, layers, cells and slabs; effective media; a slab at given frequencies as arrays."""
