"""The explorer in a real browser: what it draws, asks for and refuses, what a link restores and a download holds."""

import re
from urllib.parse import urlsplit

import explorer_pages
import numpy as np
import pytest
from explorer_pages import moved, pixels, settled, skip_without_browser, width

import beamprop as bp

skip_without_browser()
browser, opened, server = explorer_pages.browser, explorer_pages.opened, explorer_pages.server


def test_it_loads_and_draws_all_panels(opened, server):
    """A map of many colours, three panels with curves, a printed width; no word on the console, no request elsewhere."""
    page = opened(server.url)
    colours = page.evaluate(
        "() => { const c = document.querySelector('#map-a canvas'), d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;"
        " return new Set(new Uint32Array(d.buffer)).size; }"
    )
    assert colours > 100
    for panel in ("scattering", "bloch", "beam_width"):
        assert len(page.get_attribute(f"#{panel} path.line", "d")) > 100
    expected = bp.beam_width(bp.Slab(bp.lmmd_cell(), 450), bp.GaussianBeam(0.096), 2500.0)
    assert width(page) == pytest.approx(float(expected.fwhm_out), rel=1e-8)
    assert page.text_content('dd[data-name="fwhm_out"]') == f"{100 * width(page):.6g} cm"
    assert {urlsplit(url).netloc for url in opened.asked_for if not url.startswith("data:")} == {server.host}


def test_what_is_no_number_is_refused_in_words_and_curves_keep_to_their_box(opened, server):
    """A unit that is typed is told beside its control until a number comes; lines are drawn within the axes."""
    page = opened(server.url)
    typed = page.get_by_label("Frequency, typed", exact=True)
    typed.fill("500kHz")
    typed.press("Enter")
    assert page.locator("#v-question-frequency-wrong").first.inner_text() == "expected a number in Hz, got 500kHz"
    typed.fill("2400")
    typed.press("Enter")
    settled(page)
    assert page.locator("#v-question-frequency-wrong").first.inner_text() == ""
    assert page.locator(".plot svg svg path.line").count() > 4
    assert page.evaluate(
        "[...document.querySelectorAll('.plot svg svg')].every((box) => getComputedStyle(box).overflow === 'hidden')"
    )


def test_a_slider_changes_pixels_and_the_width(opened, server):
    """By keyboard alone; what is printed is what `beam_width` answers, and undo and redo bring both back."""
    page = opened(server.url)
    before = pixels(page), width(page)
    moved(page, "Angle", ["ArrowRight"] * 10)
    angle = float(page.get_by_label("Angle, typed").input_value())
    assert angle == 4.0
    moved(page, "Layers a cell N", ["ArrowRight", "ArrowRight"])
    slab = bp.Slab(bp.lmmd_cell(n_layers=12), 450)
    expected = bp.beam_width(slab, bp.GaussianBeam(0.096, angle), 2500.0)
    assert width(page) == pytest.approx(float(expected.fwhm_out), rel=1e-8)
    after = pixels(page), width(page)
    assert after[0] != before[0]
    assert after[1] != before[1]
    while page.is_enabled("#undo"):
        page.keyboard.press("Control+z")
    settled(page)
    assert (pixels(page), width(page)) == before
    while page.is_enabled("#redo"):
        page.click("#redo")
    settled(page)
    assert (pixels(page), width(page)) == after


def test_a_link_restores_the_state(opened, server):
    """Values of all kinds, typed and chosen, in a fresh context; what a link has and the study has not is said."""
    page = opened(server.url)
    page.get_by_label("Period over wavelength η, typed").fill("1/40")
    page.keyboard.press("Enter")
    page.get_by_label("Source", exact=True).select_option("slits")
    page.get_by_label("Without loss").check()
    settled(page)
    assert page.get_by_label("Width at launch", exact=True).is_hidden()
    again = opened(page.url)
    assert (pixels(again), width(again)) == (pixels(page), width(page))
    assert again.get_by_label("Period over wavelength η, typed").input_value() == "0.025"
    assert again.get_by_label("Modulation of the loss δρ", exact=True).is_disabled()
    wrong = opened(f"{server.url}#slab.eta=x&slab.layers=a&question.angle=20")
    assert "slab.eta, slab.layers" in wrong.text_content("#notes")
    assert wrong.get_by_label("Angle, typed").input_value() == "20"


def test_two_states_are_compared(opened, server):
    """Side by side: the sliders move one, the other stays; colours have one scale, curves both states."""
    page = opened(server.url)
    page.click("#compare")
    settled(page)
    before = pixels(page, "a")
    assert pixels(page, "b") == before
    page.get_by_label("Medium").select_option("none")
    settled(page)
    assert width(page, "b") > 2 * width(page, "a")
    assert pixels(page, "b") != pixels(page, "a")
    texts = [page.locator(f"#map-{slot} svg text").all_text_contents() for slot in "ab"]
    assert texts[0] == texts[1]  # ticks of the colour bar, too
    assert page.locator("#scattering path.line").count() == 4
    page.get_by_label("sliders move A").check()
    moved(page, "Angle", ["ArrowRight"])
    assert pixels(page, "a") != before
    again = opened(page.url)
    assert (pixels(again, "a"), pixels(again, "b")) == (pixels(page, "a"), pixels(page, "b"))
    page.click("#compare")
    settled(page)
    assert page.locator("#map-b").count() == 0


def test_a_refusal_is_said_and_mended(opened, server):
    """What the package refuses stands below the faint last picture, until the value is moved back."""
    page = opened(server.url)
    loss = page.get_by_label("Mean density, loss, typed")
    loss.fill("0.01")
    page.keyboard.press("Enter")
    settled(page)
    assert "expected a passive medium" in page.text_content("#map-a .refused")
    assert page.locator("#map-a .plot.stale").count() == 1
    page.click("#undo")
    settled(page)
    assert page.text_content("#map-a .refused") == ""
    assert page.locator(".plot.stale").count() == 0
    refusals = [fault for fault in opened.faults if "422" in fault]
    for fault in refusals:  # the browser's own line for an answer that is none
        opened.faults.remove(fault)


def test_values_are_read_with_pointer_and_arrow_keys(opened, server):
    """|p| under the pointer is that of `field` there; arrow keys move the place."""
    page = opened(server.url)
    box = page.locator("#map-a canvas").bounding_box()
    page.mouse.move(box["x"] + 0.4 * box["width"], box["y"] + 0.5 * box["height"] - 3)
    text = page.text_content("#map-a .read")
    z, x, size = map(float, re.fullmatch(r"z (\S+) m, x (\S+) m: \|p\| (\S+) Pa, phase .*", text).groups())
    slab = bp.Slab(bp.lmmd_cell(), 450)
    z = (
        2 * slab.cell.thickness * round(z / slab.cell.thickness / 2)
    )  # of which four digits are shown: a plane is on every second face
    ds = bp.field(slab, bp.GaussianBeam(0.096), 2500.0, x, z)
    assert size == pytest.approx(abs(complex(ds.p)), rel=1e-3)
    page.mouse.move(5, 5)
    page.locator("#map-a .plot").focus()
    page.keyboard.press("ArrowRight")
    first = page.text_content("#map-a .read")
    page.keyboard.press("ArrowUp")
    assert page.text_content("#map-a .read") != first != ""
    page.locator("#bloch .plot").focus()
    page.keyboard.press("ArrowLeft")
    assert "Re kz/k₀" in page.text_content("#bloch .read")


def test_downloads_hold_what_is_shown(opened, server, tmp_path):
    """The dataset at the state of the page, a picture, and the three texts."""
    page = opened(f"{server.url}#slab.periods=30")
    page.click("#take")
    page.wait_for_selector("#texts pre")
    texts = page.locator("#texts pre").all_text_contents()
    assert [text.split()[0] for text in texts] == ["import", "beamprop", "[question]"]
    assert all("30" in text for text in texts)
    page.select_option("#question", "beam_width")
    for kind in ("nc", "png"):
        with page.expect_download() as download:
            page.click(f'[data-kind="{kind}"]')
        download.value.save_as(tmp_path / f"a.{kind}")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    expected = bp.beam_width(bp.Slab(bp.lmmd_cell(), 30), bp.GaussianBeam(0.096), np.linspace(2000, 3000, 21))
    np.testing.assert_array_equal(bp.load(tmp_path / "a.nc").fwhm_out, expected.fwhm_out)
    page.keyboard.press("Escape")
    assert page.is_hidden("#handout")


def test_motion_starts_and_stops(opened, server):
    page = opened(server.url)
    page.click("#play")
    first = pixels(page)
    page.wait_for_timeout(200)
    assert pixels(page) != first
    page.click("#play")
    still = pixels(page)
    page.wait_for_timeout(100)
    assert pixels(page) == still
