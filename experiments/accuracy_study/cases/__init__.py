"""The questions of the study: random ones by number, and those built for one term of the error estimate."""
