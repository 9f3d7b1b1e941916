"""The explorer for everybody: by keyboard, on a phone, in the dark, for screen readers; and stored results from a file, without a server."""

import re

import explorer_pages
import numpy as np
import pytest
from click.testing import CliRunner
from explorer_pages import DESKTOP, PHONE, serious, settled, skip_without_browser

import beamprop as bp
from beamprop.cli import main

skip_without_browser()
browser, opened, server = explorer_pages.browser, explorer_pages.opened, explorer_pages.server


# --- everybody can use it -----------------------------------------------------------------------------------


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("viewport", [DESKTOP, PHONE], ids=["desktop", "phone"])
def test_axe_finds_no_serious_fault(opened, server, scheme, viewport):
    """The page, all its groups open, two states beside each other, and the dialog; nothing runs over the edge of a phone."""
    page = opened(server.url, viewport, color_scheme=scheme, bypass_csp=True)
    page.evaluate("document.querySelectorAll('details').forEach((group) => { group.open = true; })")
    assert serious(page) == []
    page.click("#compare")
    settled(page)
    assert serious(page) == []
    assert page.evaluate("document.documentElement.scrollWidth") <= viewport["width"]
    page.click("#take")
    page.wait_for_selector("#texts pre")
    assert serious(page) == []
    back = page.evaluate("getComputedStyle(document.body.parentElement).backgroundColor")
    assert (sum(map(int, re.findall(r"\d+", back)[:3])) < 150) == (scheme == "dark")


def test_everything_can_be_reached_by_keyboard(opened, server):
    """Tab goes through every button, slider and picture, and each shows that it has the focus."""
    page = opened(server.url)
    page.click("h1")
    seen = []
    for _ in range(120):
        page.keyboard.press("Tab")
        name, outline = page.evaluate(
            "() => { const e = document.activeElement; return [e.id || e.getAttribute('aria-label') || e.tagName, getComputedStyle(e).outlineStyle]; }"
        )
        if name == "BODY":
            break
        assert outline != "none", name
        seen.append(name)
    assert {
        "compare",
        "take",
        "quantity",
        "v-question-angle",
        "v-slab-eta",
        "v-beam-source",
        "Field; arrow keys read values",
    } <= set(seen)


# --- stored results -----------------------------------------------------------------------------------------

SWEEP = """
[question]
name = "beam_width"
frequency = "2000:3000:5"
[sweep]
slab.periods = [20, 50]
slab.medium = ["exact", "none"]
[output]
store = "width.zarr"
workers = 1
"""


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    """Pages of a sweep's store and of a field."""
    folder = tmp_path_factory.mktemp("stored")
    (folder / "study.toml").write_text(SWEEP, encoding="utf-8")
    slab, beam = bp.Slab(bp.lmmd_cell(), 20), bp.GaussianBeam(0.096, 30.0, z0=-0.1)
    bp.save(bp.field(slab, beam, 2500.0, np.linspace(-0.3, 0.3, 61), np.linspace(0, 0.1, 41)), folder / "field.nc")
    for words in (
        ["run", "study.toml"],
        ["explore", "study.toml", "--export", "sweep.html"],
        ["explore", "field.nc", "--export", "field.html"],
    ):
        words = [str(folder / word) if "." in word else word for word in words]
        result = CliRunner().invoke(main, words)
        assert result.exit_code == 0, result.output
    return folder


def test_a_stored_sweep_opens_from_a_file(opened, stored):
    """Without any network: its curve is that of the store, and selectors change it."""
    page = opened((stored / "sweep.html").as_uri(), offline=True)
    assert page.input_value("#variable") == "fwhm_out"
    plot = page.locator("#curves .plot")
    plot.focus()
    for _ in range(5):
        page.keyboard.press("ArrowRight")
    ds = bp.load(stored / "width.zarr")
    value = float(ds.fwhm_out.sel(periods=20, medium="exact", frequency=3000.0))
    assert page.text_content("#curves .read") == f"frequency [Hz] 3000: fwhm_out {value:.4g}"
    page.get_by_label("medium").focus()
    page.keyboard.press("ArrowRight")
    value = float(ds.fwhm_out.sel(periods=20, medium="none", frequency=3000.0))
    assert page.text_content("#curves .read") == f"frequency [Hz] 3000: fwhm_out {value:.4g}"
    page.get_by_label("And").select_option("periods")
    assert page.locator("#curves path.line").count() == 2
    page.get_by_label("And").select_option("map periods")
    assert page.locator("#map canvas").is_visible()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_stored_field_opens_as_a_map(opened, stored, scheme):
    """Values under the arrow keys are the file's; no serious fault on a phone, in light and dark; nothing else is asked for."""
    page = opened((stored / "field.html").as_uri(), PHONE, offline=True, color_scheme=scheme, bypass_csp=True)
    assert opened.asked_for == [(stored / "field.html").as_uri()]
    page.locator("#map .plot").focus()
    page.keyboard.press("ArrowRight")
    z, x, size = map(
        float, re.fullmatch(r"z \[m\] (\S+), x \[m\] (\S+): (\S+)", page.text_content("#map .read")).groups()
    )
    ds = bp.load(stored / "field.nc")
    assert size == pytest.approx(abs(complex(ds.p.sel(z=z, x=x, method="nearest"))), rel=1e-3)
    assert serious(page) == []
    assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["width"]
