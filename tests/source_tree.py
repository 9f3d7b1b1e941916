"""The package's files and their syntax trees, for the tests of its walls and sizes."""

import ast
from pathlib import Path

import beamprop as bp

ROOT = Path(bp.__file__).parent
CHECKOUT = Path(__file__).parent.parent


def module_of(path):
    """The name in ORDER of a file: the folder's, for a module that has become a folder."""
    parts = path.relative_to(ROOT).parts
    return parts[0].removesuffix(".py")


FILES = {path: module_of(path) for path in sorted(ROOT.rglob("*.py"))}


def tree(path):
    return ast.parse(path.read_text(encoding="utf-8"), str(path))
