"""Arrays: the sum of their elements' own fields, Rayleigh's integral over each, steering and focusing."""

import numpy as np
import pytest
from test_piston import rayleigh

import beamprop as bp

WATER = bp.Fluid.from_speed(1000.0, 1500.0)
NOTHING = bp.Slab.uniform(WATER, 0.001, background=WATER)
PLATE = bp.Slab.uniform(bp.Fluid.from_speed(1900.0, 2800.0), 0.0065, background=WATER)
FREQUENCY, Z0 = 0.2e6, -0.04
K = 2 * np.pi * FREQUENCY / 1500.0
POSITIONS = np.array([[0.004, 0.0], [-0.006, 0.003], [0.01, -0.008], [0.0, 0.012]])
WEIGHTS = np.array([1.0, 0.5j, -0.7, 0.2 + 1j])
X, Y, Z = np.array([-0.02, 0.003, 0.01]), np.array([0.0, 0.014]), np.array([-0.01, 0.004, 0.05])
GRID = 0.0006 * np.arange(-16, 17)
ELEMENTS = {
    "rigid": bp.Piston(0.0025, z0=Z0),
    "soft": bp.Piston(0.0025, "soft", 2j, z0=Z0),
    "bowl": bp.Bowl(0.02, 0.005, z0=Z0),
    "beam": bp.GaussianBeam((0.006, 0.004), 10, z0=Z0, azimuth=50.0),
    "plane": bp.SourcePlane(GRID, GRID, np.exp(-(GRID**2 + GRID[:, None] ** 2) / 0.002**2), Z0),
}


def moved(element, x, y):
    """The element at (x, y)."""
    if isinstance(element, bp.SourcePlane):
        return bp.SourcePlane(element.x + x, element.y + y, element.p, element.z0)
    names = [n for n in element.__dataclass_fields__ if n not in ("x0", "y0")]
    return type(element)(**{n: getattr(element, n) for n in names}, x0=x, y0=y)


def errors(p, known):
    return np.max(np.abs(p - known), axis=(1, 2)) / np.max(np.abs(known), axis=(1, 2))


@pytest.mark.parametrize("kind", ELEMENTS)
def test_it_is_the_sum_of_its_elements(kind):
    element, rtol = ELEMENTS[kind], 1e-7
    ds = bp.field(PLATE, bp.Array(POSITIONS, element, WEIGHTS), FREQUENCY, X, Z, y=Y, rtol=rtol)
    known = 0
    for (x, y), weight in zip(POSITIONS, WEIGHTS, strict=True):
        known = known + weight * bp.field(PLATE, moved(element, x, y), FREQUENCY, X, Z, y=Y, rtol=rtol).p.values
    assert np.max(errors(ds.p.values, known)) < 5 * rtol
    assert float(ds.error_estimate) < rtol


def summed(weights, x, y, z):
    """Rayleigh's integral over every piston of 1 cm, of which `test_piston` has the radius and the frequency."""
    return sum(w * rayleigh("rigid", x - a, y - b, z) for (a, b), w in zip(SPREAD, weights, strict=True))


SPREAD = np.array([[-0.03, 0.0], [0.0, 0.025], [0.035, -0.02]])
FAST, OF_FAST = 0.5e6, 2 * np.pi * 0.5e6 / 1500.0


def test_by_rayleighs_integrals():
    array = bp.Array(SPREAD, bp.Piston(0.01, z0=-0.01), WEIGHTS[:3])
    p = bp.field(NOTHING, array, FAST, X, [0.02, 0.1], y=Y, rtol=1e-8).p.values
    known = np.array([[[summed(WEIGHTS[:3], a, b, c) for a in X] for b in Y] for c in (0.02, 0.1)])
    assert np.max(errors(p, known)) < 1e-8


@pytest.mark.parametrize("angles", [[0, 25], np.linspace(-4, 4, 41)], ids=["each", "interpolated"])
def test_steering_is_by_delays(angles):
    array = bp.Array(SPREAD, bp.Piston(0.01, z0=-0.01))
    ds = bp.field(NOTHING, array, FAST, X, [0.1], angle=angles, y=Y, azimuth=30.0, rtol=1e-5)
    middle = (SPREAD.min(axis=0) + SPREAD.max(axis=0)) / 2
    away = (SPREAD - middle) @ [np.cos(np.radians(30)), np.sin(np.radians(30))]
    weights = np.exp(1j * OF_FAST * np.sin(np.radians(angles[-1])) * away)
    known = np.array([[[summed(weights, a, b, 0.1) for a in X] for b in Y]])
    assert np.max(errors(ds.p.values[-1], known)) < 1e-5


@pytest.mark.parametrize("kind", ["rigid", "bowl"])
def test_elements_are_in_phase_at_a_focus(kind):
    """There |p| is the sum of the elements' own |p|, all but for the phases of an element off its axis."""
    focus, element = (0.005, -0.002, 0.06), ELEMENTS[kind]
    focused = bp.field(NOTHING, bp.Array(POSITIONS, element, focus=focus), FREQUENCY, 0.005, 0.06, y=-0.002).p.item()
    own = [bp.field(NOTHING, moved(element, x, y), FREQUENCY, 0.005, 0.06, y=-0.002).p.item() for x, y in POSITIONS]
    assert abs(focused) == pytest.approx(np.sum(np.abs(own)), rel=1e-4)
    assert abs(sum(own)) < 0.99 * abs(focused)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"positions": [0.0, 1.0]}, r"positions: expected an array \(N, 2\)"),
        ({"positions": [[0.0, np.nan]]}, "positions: expected finite"),
        ({"weights": [1.0]}, "weights: expected a weight of each of 4 positions"),
        ({"weights": np.zeros(4)}, "weights: expected any that is not zero"),
        ({"element": bp.Slits(0.01, 0.04)}, "element: expected a Piston, Bowl, GaussianBeam or SourcePlane"),
        ({"angle": 95}, "angle: expected"),
        ({"azimuth": np.inf}, "azimuth: expected"),
        ({"focus": (0.0, 1.0)}, "focus: expected x, y and z"),
        ({"focus": (0.0, 0.0, Z0)}, "focus: expected a z behind the launch plane"),
    ],
)
def test_arguments_are_checked(changes, message):
    with pytest.raises(ValueError, match=f"^{message}"):
        bp.Array(**({"positions": POSITIONS, "element": ELEMENTS["rigid"]} | changes))


def test_without_y_it_is_refused():
    with pytest.raises(ValueError, match=r"^beam: expected one on which nothing depends on y"):
        bp.field(NOTHING, bp.Array(POSITIONS, ELEMENTS["rigid"]), FREQUENCY, 0.0, 0.1)


@pytest.mark.parametrize("kind", ["soft", "beam", "plane"])
def test_files_bring_it_back(tmp_path, kind):
    source = bp.Array(POSITIONS, ELEMENTS[kind], WEIGHTS, angle=10, azimuth=20.0, focus=(0.0, 0.01, 0.1))
    bp.save(bp.field(NOTHING, source, FREQUENCY, 0.0, [0.02, 0.1], y=0.0, rtol=1e-3), tmp_path / "p.nc")
    assert bp.provenance(bp.load(tmp_path / "p.nc"))["beam"] == source
