"""Closed forms as their sources have them, for exp(-i w t). They know nothing of the package: fluids are pairs (density, sound speed)."""
