"""The site: no page is lost, every public name has its place, tasks are short, and the built pages ask no other server for anything."""

import fnmatch
import inspect
import re
from html.parser import HTMLParser
from urllib.parse import unquote, urlsplit

import doc_snippets
import pytest
from source_tree import CHECKOUT

import beamprop as bp

DOCS = CHECKOUT / "docs"
#: Where the command of docs/conf.py puts the site; without it the tests of built pages have nothing to look at.
SITE = CHECKOUT / "build" / "site"


def text_of(name):
    return (DOCS / name).read_text(encoding="utf-8")


# --- the pages' sources -----------------------------------------------------------------------------------


def contents():
    """Entries of the contents lists of docs/index.md."""
    lists = re.findall(r"^:::\{toctree\}\n((?::.*\n)*)\n((?:.+\n)+?):::", text_of("index.md"), re.MULTILINE)
    return [entry for _, entries in lists for entry in entries.split()]


def test_every_page_stands_in_the_contents_once():
    pages = {page.stem for page in DOCS.glob("*.md")} - {"index"}
    assert len(pages) >= 17
    placed = [page for entry in contents() for page in fnmatch.filter(pages, entry)]
    assert sorted(placed) == sorted(pages)


def names_of_the_reference():
    """Names that docs/api.md lists, as they are typed after `bp.`."""
    names = []
    for module, listed in re.findall(
        r"currentmodule:: beamprop\.?(\w*)\n(.*?)(?=currentmodule|\Z)", text_of("api.md"), re.DOTALL
    ):
        prefix = f"{module}." if module else ""
        names += [prefix + name for name in re.findall(r"^(?:   |\.\. data:: )(\w+)$", listed, re.MULTILINE)]
    return names


def test_the_reference_lists_every_public_name_once():
    """Those of beamprop itself, of fem, and the functions of plot; `tests/test_docstrings.py` runs the example of each."""
    drawn = {name for name, value in vars(bp.plot).items() if inspect.isfunction(value) and not name.startswith("_")}
    public = set(bp.__all__) - {"__version__", "fem", "plot"}
    public |= {f"fem.{name}" for name in bp.fem.__all__} | {f"plot.{name}" for name in drawn}
    assert sorted(names_of_the_reference()) == sorted(public)


def test_the_cookbook_has_twenty_short_tasks():
    """Each under a heading of its own, in 3 to 12 lines, with what comes out."""
    text = text_of("cookbook.md")
    tasks = [block for block in doc_snippets.blocks(text, "python") if block.section]
    assert [block.section for block in tasks] == list(range(1, 21))
    assert len(re.findall("^## ", text, re.MULTILINE)) == 20
    for block in tasks:
        assert 3 <= len(block.text.splitlines()) <= 12, block.text
        assert block.printed, block.text


@pytest.mark.parametrize("page", ["index.md", "tutorial.md"])
def test_a_slab_of_ones_own_takes_less_than_ten_lines(page):
    """The first block of the page goes from nothing to a picture of the widths."""
    first = doc_snippets.blocks(text_of(page), "python")[0].text
    assert len(first.strip().splitlines()) < 10
    assert all(part in first for part in ("beamprop as bp", "beam_width(", "plot.width(", "savefig("))


@pytest.mark.parametrize("page", ["tutorial.md", "cookbook.md", "pitfalls.md"])
def test_every_number_that_a_page_shows_is_printed(page):
    """Text blocks follow a Python block, which prints them; a block that prints shows what."""
    text = text_of(page)
    assert doc_snippets.blocks(text, "text") == []
    for block in doc_snippets.blocks(text, "python"):
        assert ("print(" in block.text) == bool(block.printed), block.text


def test_a_wrong_output_is_noticed():
    """Of a block, and of one in a section that must not see another's names."""
    page = "x\n```python\na = 1\nprint(a)\n```\n\n```text\n2\n```\n\n<!-- sections alone -->\n\n## s\n\n```python\nb = a\n```\n\n## t\n\n```python\nb\n```\n"
    ran = doc_snippets.run(page, "page.md")
    block, printed = next(ran)
    assert (printed, block.printed) == ("1\n", "2\n")
    next(ran)
    with pytest.raises(NameError, match="b"):
        next(ran)


def test_the_page_on_citing_agrees_with_the_file():
    citation = (CHECKOUT / "CITATION.cff").read_text(encoding="utf-8")
    page = text_of("cite.md")
    for key in ("title", "version"):
        (value,) = re.findall(rf'^{key}: "?(.*?)"?$', citation, re.MULTILINE)
        assert f"{{{value}}}" in page, key


# --- the built pages --------------------------------------------------------------------------------------


class Page(HTMLParser):
    """What an HTML page loads, links to, and can be linked at."""

    def __init__(self, path):
        super().__init__()
        self.loads, self.links, self.anchors, self.without_alt = [], [], set(), 0
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        self.anchors.add(given.get("id"))
        if tag == "a" and "href" in given:
            self.links.append(given["href"])
        elif tag == "link" and given.get("rel") not in ("next", "prev", "index", "search"):
            self.loads.append(given["href"])
        self.loads += [given[name] for name in ("src", "poster", "data") if given.get(name)]
        self.loads += [candidate.split()[0] for candidate in (given.get("srcset") or "").split(",") if candidate]
        self.without_alt += tag == "img" and "alt" not in given


@pytest.fixture(scope="module")
def pages():
    if not SITE.exists():
        pytest.skip("no site: sphinx-build -W -b html docs build/site")
    return {path: Page(path) for path in SITE.rglob("*.html")}


def test_built_pages_load_nothing_from_elsewhere(pages):
    """Neither scripts nor styles nor pictures; what they load is there."""
    assert len(pages) > 60
    for path, page in pages.items():
        for source in page.loads:
            parts = urlsplit(source)
            assert (parts.scheme == "data") or (parts.scheme, parts.netloc) == ("", ""), (path.name, source)
            if not parts.scheme:
                assert (path.parent / unquote(parts.path)).exists(), (path.name, source)
        assert page.without_alt == 0, path.name
    for style in SITE.rglob("*.css"):
        assert not re.search(r"url\(\s*['\"]?(https?:)?//|@import", style.read_text(encoding="utf-8")), style.name


def test_links_between_built_pages_lead_somewhere(pages):
    """To a file of the site, and to a place on it if they name one."""
    for path, page in pages.items():
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            assert target.exists(), (path.name, link)
            if parts.fragment and target in pages:
                assert unquote(parts.fragment) in pages[target].anchors, (path.name, link)
