"""Widths, centroids and sections of |p| along x."""
