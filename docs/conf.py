"""The site: ``sphinx-build -W -b html docs build/site`` makes it from these pages, with the extra ``docs`` installed.

The scripts of the gallery run at full size, in a few minutes; with BEAMPROP_QUICK=1 in the environment, at a reduced one.
"""

from __future__ import annotations

import logging
import re
import sys
from pathlib import Path

CHECKOUT = Path(__file__).parents[1]
GALLERY = CHECKOUT / "experiments" / "gallery"
# The checkout's package, whatever is installed; what the scripts of the gallery share.
sys.path[:0] = [str(CHECKOUT), str(GALLERY), str(CHECKOUT / "docs")]

import beamprop  # noqa: E402

project = "beamprop"
author = "The beamprop developers"
release = version = beamprop.__version__
copyright = f"{author}, MIT licence"

extensions = ["myst_parser", "sphinx.ext.autosummary", "numpydoc", "sphinx_gallery.gen_gallery"]
exclude_patterns = ["templates"]
templates_path = ["templates"]
# A contents list may name pages that a checkout does not have; Sphinx 9 gives this warning no type by which it could be suppressed.
logging.getLogger("sphinx.sphinx.directives.other").addFilter(lambda record: "glob pattern" not in str(record.msg))

myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 3  # links to headings are those of the repository's own view

# Single backticks in docstrings are names: a link where it is a public one, plain code elsewhere.
default_role = "py:obj"
smartquotes = False  # what is typed has straight ones
autodoc_typehints = "none"  # the docstrings tell types, shapes and units
autosummary_imported_members = True
numpydoc_show_class_members = False

sphinx_gallery_conf = {
    "examples_dirs": str(GALLERY),
    "gallery_dirs": "gallery",
    "filename_pattern": ".*",
    "ignore_pattern": "gallery_main",
    "reset_argv": "site_arguments.of_gallery",
    "image_srcset": ["2x"],
    "thumbnail_size": (560, 200),
    "download_all_examples": False,
    "show_signature": False,
    "write_computation_times": False,
    "abort_on_example_error": True,
}

html_theme = "furo"  # 0.1 MB, light and dark, and no request to any other server
html_title = f"beamprop {release}"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_search_summary = False  # which browsers refuse to fetch from files
html_show_sphinx = False

#: Bars of an absolute value, |p|, outside of a literal and not escaped: reStructuredText takes them for a substitution.
_BAR = re.compile(r"(``[^`]*``|`[^`]*`|\\\|)|\|")


def _with_plain_bars(_app, _what, _name, _object, _options, lines) -> None:
    lines[:] = [_BAR.sub(lambda m: m[1] or r"\|", line) if not line.startswith(">>>") else line for line in lines]


def _with_gallery_pages(_app, _page, source) -> None:
    """Links to the gallery's folder, which the repository shows, lead to its pages on the site."""
    source[0] = source[0].replace("(../experiments/gallery/README.rst)", "(gallery/index.rst)")


def setup(app) -> None:
    """Sphinx's hook."""
    app.connect("source-read", _with_gallery_pages)
    app.connect("autodoc-process-docstring", _with_plain_bars, priority=400)
