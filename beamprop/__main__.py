"""``python -m beamprop``."""

from .cli import main

main(prog_name="beamprop")
