"""Dataset -> matplotlib Axes. Knows nothing of media: it draws what the dataset holds.

Every function takes `ax` and returns the Axes it drew in, so that figures are put together outside; without `ax` it makes a figure of
`width` millimetres in the style of `paper.mplstyle`: 88 is one column of a journal, 180 is two.
"""

from __future__ import annotations

from typing import Any

from .comparison import comparison as comparison
from .curves import bloch as bloch
from .curves import scattering as scattering
from .curves import sweep as sweep
from .curves import width as width
from .field import field as field

#: Line styles by turn, as in the paper: solid, dashed, dash-dotted, dash-dot-dotted.
STYLES: tuple[Any, ...] = ("-", "--", "-.", (0, (6, 1.5, 1, 1.5, 1, 1.5)))
