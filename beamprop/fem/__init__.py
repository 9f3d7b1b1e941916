"""Full-wave finite elements: the independent witness.

`field` solves the wave equation over an x-periodic window with tensor-product elements, exact radiation
conditions on both sides and no use of layer matrices; `plan` says beforehand what that takes. Nothing in here
imports the plane-wave code.

strip.py: layers to rows of elements to matrices. boundary.py: the open sides and the beam. solvers.py: two
solvers and the residual. question.py: checks, warnings and the labelled result.
"""

from .question import Plan, field, plan

__all__ = ["Plan", "field", "plan"]
