"""Profiles from files and from fields."""

import numpy as np
import pytest

import beamprop as bp

F = 2500.0


@pytest.mark.parametrize("separator", [" ", ", ", ";\t"])
def test_a_profile_from_a_file(tmp_path, separator):
    """Rows in any order, comments, both conventions; the field is that of the samples."""
    x = np.linspace(-0.2, 0.2, 161)
    p = np.exp(-((x / 0.05) ** 2) + 3j * x)
    rows = [separator.join(f"{v:.17g}" for v in row) for row in zip(x, p.real, -p.imag, strict=True)]
    path = tmp_path / "measured.txt"
    path.write_text("\n".join(["% x Re Im", *rows[::-1], ""]))
    beam = bp.Profile.from_file(path, z0=-0.02, conjugate=True)
    assert beam == bp.Profile(x, p, -0.02)


def test_a_profile_from_a_field():
    """What leaves one slab is launched into the next: equal to the two in a row where nothing comes back."""
    air = bp.Slab.uniform(bp.AIR, 0.1)
    x = np.linspace(-0.6, 0.6, 481)
    first = bp.field(air, bp.GaussianBeam(0.1), F, x, 0.1)
    again = bp.field(air, bp.Profile.from_data(first.p), F, [0.0, 0.05], 0.1)
    whole = bp.field(air, bp.GaussianBeam(0.1), F, [0.0, 0.05], 0.2)
    np.testing.assert_allclose(again.p, whole.p, atol=2e-3)  # the window of the samples cuts the tails


@pytest.mark.parametrize(
    ("text", "said"), [("0 1 2\n1 2\n", "line 2"), ("0 1\nabc 2\n", "line 2"), ("% only\n", "2 rows")]
)
def test_files_that_are_no_profile(tmp_path, text, said):
    """The file and the line are named."""
    path = tmp_path / "p.txt"
    path.write_text(text)
    with pytest.raises(ValueError, match=said):
        bp.Profile.from_file(path)
