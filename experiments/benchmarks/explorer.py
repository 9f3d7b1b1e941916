"""How fast the explorer follows a slider, in the browser: from a step to its new picture, medians of fifty; and what an answer's layers take.

    python experiments/benchmarks/explorer.py

Needs the extra `browser` and a chromium. A step is an input event of the slider; a picture is there when its pixels are painted.
"""

from __future__ import annotations

import argparse
import os
import shutil
import statistics
import subprocess
import sys
from typing import Any

#: Depth behind the slab with which the map has 400 planes on every second face of the paper's slab [m].
BEHIND = 0.6955
#: What is asked for: milliseconds to a map, and to all curves (20 steps a second).
MAP, CURVES = 100.0, 50.0
#: From a step of a slider to the pictures of `panels`, `count` times; the first steps warm up.
STEP = """async ({id, panels, count, warm}) => {
  const slider = document.getElementById(id), times = [], drawn = (p) => Number(document.body.dataset["drawn" + p]);
  const quiet = async () => { while (document.body.dataset.idle !== "true") await new Promise((r) => setTimeout(r, 5)); };
  const range = Number(slider.max);
  for (let i = 0; i < count + warm; i++) {
    await quiet();
    const before = panels.map(drawn);
    slider.value = String(Math.round(range * (0.25 + 0.5 * ((i * 7) % 50) / 50)));
    const start = performance.now();
    slider.dispatchEvent(new Event("input", {bubbles: true}));
    while (!panels.every((p, k) => drawn(p) > before[k])) await new Promise((r) => setTimeout(r, 0));
    await new Promise(requestAnimationFrame);
    if (i >= warm) times.push(performance.now() - start);
  }
  slider.dispatchEvent(new Event("change", {bubbles: true}));
  return times;
}"""
#: What is moved and drawn: title, the slider, the panels that a step waits for, what is asked for [ms].
ROWS = [
    ("angle: map of 400 × 400", "v-question-angle", ["field"], MAP),
    ("period η: map of 400 planes at most", "v-slab-eta", ["field"], MAP),
    ("angle: width curve of 21 frequencies", "v-question-angle", ["beam_width"], CURVES),
    ("period η: transmission and contour", "v-slab-eta", ["scattering", "bloch"], CURVES),
    ("period η: map and all three curves", "v-slab-eta", ["field", "scattering", "bloch", "beam_width"], MAP),
]


def start_server() -> tuple[subprocess.Popen[str], str]:
    """The explorer of the paper's slab, and its address."""
    command = [sys.executable, "-m", "beamprop", "explore", "--no-open"]
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, text=True, env=os.environ | {"OPENBLAS_NUM_THREADS": "1"}
    )
    assert process.stdout is not None
    return process, process.stdout.readline().strip()


def measure(page: Any, slider: str, panels: list[str], count: int, warm: int = 5) -> float:
    """Median milliseconds from a step of a slider to its pictures."""
    times = page.evaluate(STEP, {"id": slider, "panels": panels, "count": count, "warm": warm})
    return statistics.median(times)


def main(count: int = 50) -> list[str]:
    """The table, a line each."""
    from playwright.sync_api import sync_playwright

    lines = ["| a step of the slider | median | asked | holds? |", "|---|---|---|---|"]
    server, url = start_server()
    try:
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
            page = browser.new_page(viewport={"width": 1300, "height": 900})
            page.goto(f"{url}#view.behind={BEHIND}")
            page.wait_for_selector('body[data-idle="true"][data-drawnfield]')
            for title, slider, panels, limit in ROWS:
                median = measure(page, slider, panels, count)
                lines.append(f"| {title} | {median:.0f} ms | {limit:.0f} ms | {'yes' if median <= limit else 'NO'} |")
            browser.close()
    finally:
        server.terminate()
        server.wait()
    return lines


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--count", type=int, default=50, help="steps of each row")
    print("\n".join(main(parser.parse_args().count)))
