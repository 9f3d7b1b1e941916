"""The exact plane-wave response, on arrays: layer -> cell -> power of a cell -> slab.

Shapes: omega is (F, 1), kx is (F, n) or (n,); leading axes are batch, the last one is kx. Nothing is checked here.

One layer takes the state (p, q), q = (1/rho_z) dp/dz, from its near to its far face by

    [[ C, A s ], [ -B s, C ]],   A = rho_z d,   B = (w^2/K - kx^2/rho_x) d,   u = A B = (kz d)^2,
    C = cos(sqrt(u)),  s = sin(sqrt(u))/sqrt(u):  entire in u, so kz = 0 is no special case and no branch is chosen.

States are carried BACK from the outgoing wave at the far face, the direction in which the physical solution grows:
nothing cancels, however thick the slab, unless the physical wave decays on the way back (behind negative layers: reflection.py).
What grows is taken out and kept as a logarithm.

layer.py: one layer. solid_layer.py, solids.py: one of solid; solid_run.py: several in contact; solid_half_space.py: one behind. cell.py: a cell. periods.py: many of them in closed form. recursion.py: the way back through a slab. interior.py: the field there.
slab.py: what is asked of a slab. reflection.py: r and t from the waves of each medium, for where the way back cancels.
conditioning.py: r and t with estimated errors. walls.py: layers of density 0. bloch.py: infinite stacks. sampled_slab.py: a slab at given frequencies.
transfer_function.py: H(kx, z), a plane wave in front of, inside and behind it. reference.py: the plain formulas, for tests.
"""

import numpy as np

from .bloch import bloch_error, bloch_wavenumber
from .conditioning import Checked, solve_checked
from .slab import Response, solve, transmitted_flux

__all__ = ["Checked", "Response", "bloch_error", "bloch_wavenumber", "solve", "solve_checked", "transmitted_flux"]

# The C library hands freed memory back to the system, and takes each new array from it page by page, unless a large array was freed
# before (glibc raises its thresholds to the size of that): half of the time of a response at 4000 kx. This array is never touched.
np.empty(2**20)
