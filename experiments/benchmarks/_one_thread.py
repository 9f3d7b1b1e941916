"""One thread for the BLAS, as for the FFT that is the limit: imported before NumPy, which reads this once."""

import os

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")
