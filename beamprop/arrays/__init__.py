"""Array kernels that know nothing of acoustics: matrix products, exponentials on even grids, FFT plans."""
