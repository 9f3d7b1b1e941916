"""Contours of integration over kx: nodes, sums, their choice, and the error estimate."""
