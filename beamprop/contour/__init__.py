"""Contours of integration over kx: paths, sums, their choice, and the error estimate."""
