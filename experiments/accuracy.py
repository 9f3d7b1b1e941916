"""Does rtol keep its promise? Random beams x slabs x grids x rtol against an independent quadrature; limiting absorption.

The truth is computed from nothing of the package but the definitions of the slab and the source. Its response is a cascade
of scattering matrices in a reference medium (periods by doubling), its contour has a straight bend and its rule is
Gauss-Legendre on panels; the package carries states backward in closed form, on smooth contours, by the trapezoid rule or
FFTs. A case counts only where two such quadratures of different depth, bend and panels agree to a tenth of rtol. Modes on the
wrong side of the contour are counted by the argument principle on the study's own function.

`--class NAME --count 40` runs some cases of one class and lists those that fail; `--case NUMBER` runs single ones.
"""

from __future__ import annotations

from accuracy_study.cases.numbering import CASES, make_case
from accuracy_study.cases.slabs import SLABS
from accuracy_study.study.command import main
from accuracy_study.study.comparison import compare_with_truth
from accuracy_study.study.limit import limiting_absorption

__all__ = ["CASES", "SLABS", "compare_with_truth", "limiting_absorption", "make_case"]

if __name__ == "__main__":
    main(__doc__)
