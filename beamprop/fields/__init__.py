"""p(z, x) of a question: evaluated on the contour that was chosen."""
