"""What a question will hold: predictions against the peak of a process, and refusals before anything is allocated."""

import json
import subprocess
import sys

import numpy as np
import pytest

import beamprop as bp
from beamprop import memory

SLAB = bp.Slab(bp.lmmd_cell(), periods=20)
BEAM = bp.GaussianBeam(0.2, z0=-0.1)

#: Peak memory of a question beyond that of a small one, and what was predicted for it, as a process of its own tells.
CHILD = """
import json, resource, sys, warnings
import numpy as np, beamprop as bp
from beamprop import memory
warnings.simplefilter("ignore")
slab, beam = bp.Slab(bp.lmmd_cell(), periods=20), bp.GaussianBeam(0.2, z0=-0.1)
bp.field(slab, beam, 2500.0, np.linspace(-1, 1, 2048, endpoint=False), [0.1, 0.2])
bp.scattering(slab, 2500.0, kx=[0.0, 1.0]), bp.bloch(slab.cell, 2500.0, kx=[0.0, 1.0])
def peak():
    try:  # getrusage would tell the peak of the process that started this one, if that was higher
        lines = open("/proc/self/status").read().splitlines()
        return 1024 * next(int(line.split()[1]) for line in lines if line.startswith("VmHWM"))
    except OSError:
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
before, sizes = peak(), []
memory.check = lambda name, size, what, instead: sizes.append(size)
ask = {ask}
ask()
print(json.dumps([peak() - before, max(sizes)]))
"""

QUESTIONS = {
    "scattering, 2e6 kx": "lambda: bp.scattering(slab, 2500.0, kx_over_k0=np.linspace(0, 5, 2_000_000))",
    "scattering, 1000 x 1500": "lambda: bp.scattering(slab, np.linspace(2e3, 3e3, 1000), kx=np.linspace(0, 90, 1500))",
    "bloch, 1e6 kx": "lambda: bp.bloch(slab.cell, 2500.0, kx_over_k0=np.linspace(0, 5, 1_000_000))",
    "field, a row of 2e6 even x": "lambda: bp.field(slab, beam, 2500.0, np.linspace(-1, 1, 2_000_000), 0.1)",
    "field, 20 rows of 3e5 x": "lambda: bp.field(slab, beam, 2500.0, np.geomspace(1e-3, 1, 300_000), np.linspace(0, 1, 20))",
    "field, a map of 4096 x 4000": "lambda: bp.field(slab, beam, 2500.0, np.linspace(-1, 1, 4096), np.linspace(0, 1, 4000))",
    "field, all variables of a map of 2048 x 1000": "lambda: bp.field(slab, beam, 2500.0, np.linspace(-1, 1, 2048), "
    "np.linspace(0, 1, 1000), variables=('p', 'v_x', 'v_z', 'intensity', 'power_through'))",
    "field, the intensity of a map of 2048 x 2000": "lambda: bp.field(slab, beam, 2500.0, np.linspace(-1, 1, 2048), "
    "np.linspace(0, 1, 2000), variables='intensity')",
    "field, many angles": "lambda: bp.field(slab, beam, 2500.0, np.linspace(-1, 1, 1024), np.linspace(0, 1, 20), "
    "angle=np.linspace(-40, 40, 800))",
    "field, a rotated beam from afar": "lambda: bp.field(slab, bp.GaussianBeam(0.2, z0=-1e4, form='rotated'), 2500.0, 0.0, 0.1)",
}


@pytest.mark.skipif(sys.platform == "win32", reason="no resource module")
@pytest.mark.parametrize("name", QUESTIONS)
def test_predictions(name):
    """The peak of a process that asks, and the prediction, are within a factor of about two of each other."""
    code = CHILD.replace("{ask}", QUESTIONS[name])
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    peak, predicted = json.loads(found.stdout)
    assert 0.45 < predicted / peak < 2.2, (predicted, peak)


HUGE = {
    "points of a map": ("x", lambda: bp.field(SLAB, BEAM, 2500.0, np.linspace(-1, 1, 10**6), np.linspace(0, 1, 10**6))),
    "many angles": ("x", lambda: bp.field(SLAB, BEAM, 2500.0, np.arange(10**4), 0.0, angle=np.linspace(0, 9, 10**8))),
    "kx": ("kx", lambda: bp.scattering(SLAB, np.linspace(1, 2, 10**6), kx=np.linspace(0, 1, 10**6))),
    "kx of a contour": ("kx", lambda: bp.bloch(SLAB.cell, np.linspace(1, 2, 10**6), kx=np.linspace(0, 1, 10**6))),
    "widths": ("frequency", lambda: bp.beam_width(SLAB, BEAM, np.linspace(1, 2, 10**6), np.linspace(0, 9, 10**6))),
    "measures": ("frequency", lambda: bp.beam_measures(SLAB, BEAM, np.linspace(1, 2, 10**6), np.linspace(0, 9, 10**6))),
    "a view of 1e15 numbers": ("x", lambda: bp.field(SLAB, BEAM, 2500.0, np.broadcast_to(0.0, 10**15), 0.0)),
    "a rotated beam far away": (
        "x",
        lambda: bp.field(SLAB, bp.GaussianBeam(0.2, z0=-1e9, form="rotated"), 2500.0, 0.0, 0.1),
    ),
    "a thick slab": ("x", lambda: bp.beam_measures(bp.Slab.uniform(bp.AIR, 1e10), BEAM, 2500.0)),
    "layers of a cell": ("n_layers", lambda: bp.lmmd_cell(n_layers=10**12)),
    "slits": ("count", lambda: bp.Slits(0.1, 0.2, 10**13)),
    "uneven samples": ("x", lambda: bp.Profile([0.0, 1e-14, 1.0], [1.0, 1.0, 1.0])),
    "elements along x": ("period", lambda: bp.fem.plan(SLAB, BEAM, 2500.0, 1e12)),
    "rows of elements": ("slab", lambda: bp.fem.plan(bp.Slab.uniform(bp.AIR, 1e12), BEAM, 2500.0, 1.0)),
    "rows of a file": (
        "x",
        lambda: bp.save_field("never.nc", SLAB, BEAM, 2500.0, np.broadcast_to(0.0, 10**14), 0.1, memory=1e6),
    ),
}


@pytest.mark.parametrize("name", HUGE)
def test_what_does_not_fit_is_refused(name):
    """By the argument's name, with the size, what is free, and what to do instead; nothing of that size is allocated."""
    argument, ask = HUGE[name]
    said = rf"^{argument}: expected a question that fits into .* of memory, got one that takes about .*B for .*; \w+"
    with pytest.raises(ValueError, match=said):
        ask()


def test_a_huge_strip_is_refused(monkeypatch):
    """A search for guided modes that would take too many values of the dispersion function."""
    slab = bp.Slab(bp.lmmd_cell(rho_m=0.05, delta_rho=0.0), periods=450)
    monkeypatch.setenv("BEAMPROP_MEMORY", "60M")
    with pytest.raises(
        ValueError, match=r"^kx_over_k0_max: expected a strip that .* values .* search through, got 1e\+08"
    ):
        bp.guided_modes(slab, 2500.0, 1e8, 1e7)


@pytest.mark.filterwarnings("ignore:z. steps of:beamprop.HintWarning")
def test_the_limit_can_be_set(monkeypatch):
    """BEAMPROP_MEMORY takes bytes, or a number with a prefix; anything else is said to be wrong."""
    x = np.linspace(-1, 1, 1000)
    for text, size in {"1e6": 1e6, "2M": 2 * 2**20, " 3 GiB": 3 * 2**30, "1.5kb": 1536.0, "1T": 2.0**40}.items():
        monkeypatch.setenv("BEAMPROP_MEMORY", text)
        assert memory.limit() == size
    monkeypatch.setenv("BEAMPROP_MEMORY", "10M")
    with pytest.raises(ValueError, match=r"^x: expected a question that fits into 10.5 MB of memory, got one"):
        bp.field(SLAB, BEAM, 2500.0, x, x[500:])
    for text in ("", "much", "-1", "nan", "1e6x", "G"):
        monkeypatch.setenv("BEAMPROP_MEMORY", text)
        with pytest.raises(ValueError, match=r"^BEAMPROP_MEMORY: expected bytes such as 8e9 or 8G, got "):
            bp.field(SLAB, BEAM, 2500.0, x, x[500:])
    monkeypatch.delenv("BEAMPROP_MEMORY")
    assert bp.field(SLAB, BEAM, 2500.0, x, x[500:510]).p.shape == (10, 1000)


def test_what_is_free():
    """Some bytes, whatever the system tells; and a number where it tells nothing."""
    assert 2**20 < memory.available() < 2**50


def test_containers_and_limits_count(monkeypatch, tmp_path):
    """The least of what the machine, the control groups around a process and its own limit leave."""
    monkeypatch.setattr(memory, "_system", lambda: iter([8e9]))
    monkeypatch.setattr(memory, "_address_space", lambda: iter([6e9]))
    monkeypatch.setattr(memory, "_container", lambda: iter([9e9, 2e9]))
    assert memory.available() == 2e9
    for name in ("_system", "_address_space", "_container"):
        monkeypatch.setattr(memory, name, lambda: iter([]))
    assert memory.available() == memory.UNKNOWN


@pytest.mark.parametrize(
    ("line", "folder", "most", "used"),
    [
        ("0::/a/b", "a", "memory.max", "memory.current"),
        ("0::/a/b", "a/b", "memory.max", "memory.current"),
        ("4:memory:/a/b", "memory/a/b", "memory.limit_in_bytes", "memory.usage_in_bytes"),
        ("4:cpu,memory:/elsewhere", "memory", "memory.limit_in_bytes", "memory.usage_in_bytes"),
    ],
)
def test_control_groups(tmp_path, line, folder, most, used):
    """Both versions; the group itself, one around it, and the root, where a container does not see its own path."""
    own, groups = tmp_path / "own", tmp_path / "groups"
    own.write_text(f"7:cpuset:/\n{line}\n")
    (groups / folder).mkdir(parents=True)
    (groups / folder / most).write_text("5000000\n")
    (groups / folder / used).write_text("3000000\n")
    assert list(memory._container(own, groups)) == [2e6]
    (groups / folder / "memory.stat").write_text("anon 1\ninactive_file 500000\n")
    assert list(memory._container(own, groups)) == [2.5e6]
    (groups / folder / most).write_text("max\n")
    assert list(memory._container(own, groups)) == []


@pytest.mark.skipif(sys.platform != "linux", reason="the limit is not kept elsewhere")
def test_a_limit_of_the_shell_counts():
    """``ulimit -v`` leaves less than the machine has: a question that would be killed is refused instead."""
    resource = pytest.importorskip("resource")

    def limited():
        resource.setrlimit(resource.RLIMIT_AS, (2**31, 2**31))

    code = (
        "import numpy as np, beamprop as bp\n"
        "try: bp.field(bp.Slab(bp.lmmd_cell(), 2), bp.GaussianBeam(0.1), 2500.0, np.linspace(-1, 1, 10**5), np.linspace(0, 1, 2000))\n"
        "except ValueError as error: print(error)"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, preexec_fn=limited)
    assert found.stdout.startswith("x: expected a question that fits into ")


# --- in parts ---------------------------------------------------------------------------------------------


def test_plane_waves_in_parts_are_the_same(monkeypatch):
    """Blocks of frequencies and kx give what one block gives."""
    f, kx = np.linspace(2000, 3000, 7), np.linspace(0, 200, 301)
    whole = bp.scattering(SLAB, f, kx=kx)
    monkeypatch.setattr(memory, "WAVES_AT_A_TIME", 200)
    parts = bp.scattering(SLAB, f, kx=kx)
    for name in whole.data_vars:
        if name.endswith("error_estimate"):  # what is estimated is rounding itself
            assert np.all(abs(parts[name] - whole[name]) <= 0.5 * whole[name])
        else:
            np.testing.assert_allclose(parts[name], whole[name], rtol=1e-10, atol=1e-13)


@pytest.mark.parametrize("even", [True, False])
def test_rows_in_parts_are_the_same(monkeypatch, even):
    """A long row is summed in parts: the field is the same to rounding."""
    from beamprop.contour import sums

    x = np.linspace(-1, 1, 5000) if even else np.sort(np.random.default_rng(1).uniform(-1, 1, 5000))
    ask = lambda: bp.field(SLAB, BEAM, 2500.0, x, [0.0, 0.1, 0.2], angle=[0.0, 10.0]).p  # noqa: E731
    whole = ask()
    monkeypatch.setattr(sums, "POINTS_AT_A_TIME", 300)
    monkeypatch.setattr("beamprop.fields.evaluate.fft_is_cheaper", lambda *_: False)
    parts = ask()
    assert float(abs(parts - whole).max()) < 1e-9 * float(abs(whole).max())


def test_widths_in_parts_are_the_same(monkeypatch):
    """Frequencies that take many plane waves are worked on in halves."""
    from beamprop.profiles import many_frequencies

    f = np.linspace(2000, 3000, 11)
    whole = bp.beam_width(SLAB, BEAM, f)
    monkeypatch.setattr(many_frequencies, "MOST_TOGETHER", 200)
    parts = bp.beam_width(SLAB, BEAM, f)
    for name in whole.data_vars:
        np.testing.assert_allclose(parts[name], whole[name], rtol=1e-7, atol=1e-12)


def test_profiles_in_parts_are_the_same():
    """Many positions of a profile of many samples, and of many slits, are computed in bounded memory."""
    x = np.linspace(-1, 1, 3000)
    beam = bp.Profile(x, np.exp(-(x**2) / 0.05))
    at = np.linspace(-0.5, 0.5, 5001).reshape(1, -1)
    np.testing.assert_allclose(beam.profile(at, 46.0), np.exp(-(at**2) / 0.05), atol=1e-12)
    for slits in (bp.Slits(0.1, 0.3, 5), bp.Slits(0.1, 0.1, 4), bp.Slits(0.2, 0.5, 1)):
        plain = np.any(np.abs(at[..., None] - slits.positions) <= slits.width / 2, axis=-1)
        np.testing.assert_array_equal(slits.profile(at, 46.0), plain)
