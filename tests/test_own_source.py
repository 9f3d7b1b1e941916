"""A source of the user's own: any object with the members of the protocol."""

import numpy as np
import pytest

import beamprop as bp


class TwoBeams:
    """Two Gaussian beams side by side, by the members that every source has and none beside them."""

    centre, entire = 0.0, True

    def __init__(self, apart, angle=0.0, z0=0.0):
        self.apart, self.angle, self.z0 = apart, angle, z0
        self.parts = [bp.GaussianBeam(0.1, angle, side * apart / 2, z0) for side in (-1, 1)]

    def spectrum(self, kx, k0):
        return sum(part.spectrum(kx, k0) for part in self.parts)

    def profile(self, x, k0):
        return sum(part.profile(x, k0) for part in self.parts)

    def reach(self, tolerance):
        return self.parts[0].reach(tolerance) + self.apart / 2

    def band(self, k0, tolerance):
        return self.parts[0].band(k0, tolerance)

    def at_angle(self, angle):
        return TwoBeams(self.apart, angle, self.z0)


SLAB = bp.Slab(bp.lmmd_cell(0.05 + 0.05j, 0.02, n_layers=6, eta=1 / 40, design_frequency=2000.0), 30)


def test_its_field_is_the_sum_of_its_parts(tmp_path):
    beam, x = TwoBeams(0.4, 20.0, -0.1), np.linspace(-0.6, 0.8, 41)
    ask = (2300.0, x, [-0.05, 0.2, SLAB.thickness])
    found = bp.field(SLAB, beam, *ask)
    parts = [bp.field(SLAB, part, *ask).p for part in beam.parts]
    # exp(i k0 sin(angle) (x - x0)): both parts are in phase at their own middles
    np.testing.assert_allclose(found.p, sum(parts), rtol=0, atol=1e-7)
    bp.save(found, tmp_path / "own.nc")
    bp.save_field(tmp_path / "map.zarr", SLAB, beam, *ask)
    for name in ("own.nc", "map.zarr"):
        back = bp.load(tmp_path / name)
        np.testing.assert_array_equal(back.p, found.p)
        record = bp.provenance(back)
        assert record["slab"] == SLAB
        assert record["beam"]["source"].endswith("TwoBeams")


@pytest.mark.parametrize("question", [bp.beam_width, bp.beam_measures])
def test_it_is_taken_by_the_other_questions(question):
    beam = TwoBeams(0.05, 0.0, -0.02)
    found = question(SLAB, beam, 2300.0)
    assert np.all(np.isfinite(found["fwhm_out" if question is bp.beam_width else "fwhm"]))
    assert bp.provenance(found)["beam"]["source"].endswith("TwoBeams")


def test_its_velocity_and_power():
    """v_x takes the spectrum times kx of any source; v of the sum is the sum of the parts'."""
    beam, x = TwoBeams(0.4, 20.0, -0.1), np.linspace(-0.6, 0.8, 41)
    ask = {"frequency": 2300.0, "x": x, "z": [-0.05, 0.2, SLAB.thickness], "variables": ["v_x", "v_z", "power_through"]}
    found = bp.field(SLAB, beam, **ask)
    parts = [bp.field(SLAB, part, **ask) for part in beam.parts]
    for name in ("v_x", "v_z"):
        wanted = sum(part[name] for part in parts)
        np.testing.assert_allclose(found[name], wanted, rtol=0, atol=1e-7 * float(np.abs(wanted).max()))
    apart = sum(part.power_through for part in parts)  # but for what interferes between beams 0.4 m apart
    np.testing.assert_allclose(found.power_through, apart, rtol=0.01)
