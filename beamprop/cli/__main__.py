"""``python -m beamprop.cli``."""

from . import main

main(prog_name="beamprop")
