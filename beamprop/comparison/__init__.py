"""Two fields compared: on one grid, plane by plane."""
