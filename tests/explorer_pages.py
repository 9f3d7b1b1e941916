"""The explorer's pages in a browser, for the tests of them: fixtures, and what is done on a page. Pages are held to their own address and to a silent console."""

import shutil
from importlib import resources
from urllib.parse import urlsplit

import pytest
from explorer_server import running

DESKTOP, PHONE = {"width": 1300, "height": 900}, {"width": 375, "height": 812}
#: The colours of the map, as a text that differs where a pixel does.
PIXELS = "document.querySelector('#map-{} canvas').toDataURL()"


def browser_path():
    """The chromium of this machine, or None."""
    return shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


def skip_without_browser():
    """Leave a file of tests out where there is no browser, playwright or axe; .ci/run installs them."""
    pytest.importorskip("playwright.sync_api", reason="playwright is in the extra `browser`")
    pytest.importorskip("axe_playwright_python", reason="axe is in the extra `browser`")
    if browser_path() is None:
        pytest.skip("there is no chromium here", allow_module_level=True)


@pytest.fixture(scope="module")
def server():
    with running() as server:
        yield server


@pytest.fixture(scope="module")
def browser():
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=browser_path(), args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture
def opened(browser):
    """A function that opens an address; what pages say on the console, and all that they ask for, is held to nothing and to their own address."""
    contexts, faults, asked_for = [], [], []

    def open_page(url, viewport=DESKTOP, **options):
        context = browser.new_context(viewport=viewport, accept_downloads=True, **options)
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda message: faults.append(message.text))
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.on("request", lambda request: asked_for.append(request.url))
        page.goto(url)
        settled(page)
        return page

    open_page.asked_for, open_page.faults = asked_for, faults
    yield open_page
    for context in contexts:
        context.close()
    hosts = {urlsplit(url).netloc for url in asked_for if not url.startswith(("data:", "blob:"))}
    assert len(hosts) <= 1
    assert faults == []


def settled(page):
    """Wait until nothing is asked for any more, and all is drawn."""
    page.wait_for_selector(
        'body[data-idle="true"][data-drawnfield][data-drawnbeam_width], body[data-drawn]', timeout=30_000
    )


def width(page, slot="a", name="fwhm_out"):
    """A printed width, in full precision."""
    return float(page.get_attribute(f'dd[data-slot="{slot}"][data-name="{name}"]', "data-value"))


def moved(page, label, keys):
    """Press keys on the slider of a label."""
    slider = page.get_by_label(label, exact=True)
    slider.focus()
    for key in keys:
        page.keyboard.press(key)
    settled(page)
    return slider


def pixels(page, slot="a"):
    return page.evaluate(PIXELS.format(slot))


def serious(page):
    """What axe finds of weight: rule and the first place."""
    page.evaluate((resources.files("axe_playwright_python") / "axe.min.js").read_text(encoding="utf-8"))
    found = page.evaluate("() => axe.run().then((r) => r.violations)")
    return [(v["id"], v["nodes"][0]["html"][:200]) for v in found if v["impact"] in ("serious", "critical")]
