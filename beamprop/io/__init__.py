"""Labelled datasets, and files that hold them."""
