"""Contours over the radial wavenumber of beams in three dimensions, and the lattice on which their spectra are summed."""
