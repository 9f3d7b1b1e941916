"""Dataset -> matplotlib Axes. Knows nothing of media: it draws what the dataset holds.

Every function takes `ax` and returns the Axes it drew in, so that figures are put together outside; without `ax` it makes a figure of
`width` millimetres in the style of `paper.mplstyle`: 88 is one column of a journal, 180 is two.
"""

from __future__ import annotations

from typing import Any

from .animate import animate as animate
from .comparison import comparison as comparison
from .cut import cut as cut
from .field import field as field
from .plane_waves import bloch as bloch
from .plane_waves import modes as modes
from .plane_waves import scattering as scattering
from .quantities import QUANTITIES as QUANTITIES
from .sweeps import sweep as sweep
from .sweeps import width as width

#: Line styles by turn, as in the paper: solid, dashed, dash-dotted, dash-dot-dotted.
STYLES: tuple[Any, ...] = ("-", "--", "-.", (0, (6, 1.5, 1, 1.5, 1, 1.5)))
