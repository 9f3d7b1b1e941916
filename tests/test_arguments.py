"""What is refused, and with which words; structures as values."""

import dataclasses

import numpy as np
import pytest

import beamprop as bp

F = 2500.0
NAN, INF = float("nan"), float("inf")
CELL = bp.lmmd_cell()
SLAB = bp.Slab(CELL, 20)
BEAM = bp.GaussianBeam(0.096, z0=-0.05)
X = np.linspace(-0.6, 0.6, 61)
LAYER = bp.Layer(bp.AIR, 0.01)


# --- what is refused --------------------------------------------------------------------------------------


def fluid(**changed):
    return lambda: bp.Fluid(**({"density": 1.0, "bulk_modulus": 1e5} | changed))


def cell(**changed):
    return lambda: bp.lmmd_cell(**changed)


def gauss(**changed):
    return lambda: bp.GaussianBeam(**({"fwhm": 0.1} | changed))


def scattering(**changed):
    return lambda: bp.scattering(**({"slab": SLAB, "frequency": F} | changed))


def field(**changed):
    return lambda: bp.field(**({"slab": SLAB, "beam": BEAM, "frequency": F, "x": X, "z": [0.1]} | changed))


def width(**changed):
    return lambda: bp.beam_width(**({"slab": SLAB, "beam": BEAM, "frequency": F} | changed))


def uniform(**changed):
    return lambda: bp.scattering(
        bp.Slab.uniform(bp.Fluid(**({"density": 1.0, "bulk_modulus": 1e5} | changed)), 0.1), [1e3, 2e3], kx=0.0
    )


STRUCTURES = [
    *[("thickness", lambda v=v: bp.Layer(bp.AIR, v)) for v in (NAN, INF, -INF, -1, 0, "a", None, 1j, [1.0])],
    *[("density", fluid(density=v)) for v in (NAN, INF, "a", [1.0], 1 - 1j, complex(0, -1e-9))],
    *[("bulk_modulus", fluid(bulk_modulus=v)) for v in (NAN, INF, 0, "a", 1 + 1j)],
    *[("density_x", fluid(density_x=v)) for v in (NAN, 0, "a", 1 - 1j)],
    *[("density", uniform(density=f)) for f in (lambda f: f * NAN, lambda f: 1 - 1j + 0 * f, lambda f: 1.0)],
    ("bulk_modulus", uniform(bulk_modulus=lambda f: 0 * f)),
    ("density_x", uniform(density_x=lambda f: 0 * f)),
    *[("sound_speed", lambda v=v: bp.Fluid.from_speed(1.2, v)) for v in (0, NAN, INF, "a")],
    ("density", lambda: bp.Fluid.from_speed(NAN, 343.0)),
    ("fluid", lambda: bp.Layer(1.25, 0.1)),
    *[("layers", lambda v=v: bp.Cell(v)) for v in ([], 3, [3], [LAYER, 3], [bp.AIR])],
    *[("areal_density", lambda v=v: bp.Membrane(v)) for v in (NAN, INF, -1j, "a")],
    *[("periods", lambda v=v: bp.Slab([LAYER], v)) for v in (0, -1, 1.5, NAN, INF, "a", None, True)],
    *[("cell", lambda v=v: bp.Slab(v)) for v in (3, None, bp.AIR)],
    ("before", lambda: bp.Slab([LAYER], before=3)),
    ("after", lambda: bp.Slab([LAYER], after=None)),
    ("after", lambda: bp.Slab([LAYER], after=bp.Fluid(0, 1e5))),
    ("segments", lambda: bp.Slab.stack([])),
    ("cell", lambda: (SLAB + bp.Slab([LAYER])).cell),
    ("periods", lambda: (SLAB + bp.Slab([LAYER])).periods),
    *[("n_layers", cell(n_layers=v)) for v in (0, -2, 2.5, NAN, "a")],
    *[("eta", cell(eta=v)) for v in (0, -1, NAN, INF, "a")],
    *[("delta_rho", cell(delta_rho=v)) for v in (NAN, "a", 1j)],
    *[("design_frequency", cell(design_frequency=v)) for v in (0, NAN)],
    *[("background", cell(background=v)) for v in (3, bp.Fluid(-1, 1e5))],
    ("rho_m", cell(rho_m="a")),
    ("rho_m, delta_rho", cell(rho_m=0.05, delta_rho=0.025)),  # gain in the layers of small loss
    ("lossless", cell(lossless=1)),
    ("eta", cell(eta=1e60)),
    ("sound_speed", lambda: bp.Fluid.from_speed(1.2, 343 + 1j)),
    ("background", lambda: bp.Slab([LAYER], background=3)),
    ("slab", lambda: bp.fem.field(bp.Slab.interface(), BEAM, F, X[:-1], [0.1], 1.2)),
    ("cell", lambda: bp.bloch(bp.Cell(bp.Membrane(1.0)), F, kx=0)),
    ("cell", lambda: bp.standard_emt(bp.Cell([bp.Layer(bp.Fluid(0, 1e5), 0.1)]))),
    ("cell", lambda: bp.lmmd_emt(bp.Cell([LAYER, bp.Membrane(1.0)]))),
    ("density", fluid(density=None)),
    ("bulk_modulus", fluid(bulk_modulus=None)),
    ("rho_m", cell(rho_m=NAN)),
    ("segments", lambda: bp.Slab.stack([(3, 1)])),
    ("segments", lambda: bp.Slab.stack([3])),
    ("areal_density", lambda: bp.scattering(bp.Slab([LAYER, bp.Membrane(lambda f: np.ones(7))]), F, kx=0.0)),
    ("cell", lambda: bp.lmmd_emt(3)),
    ("cell", lambda: bp.standard_emt(SLAB)),
    ("slab", lambda: bp.lmmd_emt_slab(CELL)),
]

BEAMS = [
    *[("fwhm", gauss(fwhm=v)) for v in (0, -1, NAN, INF, "a")],
    *[("angle", gauss(angle=v)) for v in (90, -90, NAN, 1j, "a")],
    *[("x0", gauss(x0=v)) for v in (NAN, INF, "a")],
    *[("z0", gauss(z0=v)) for v in (0.1, NAN, -INF)],
    ("width_of", gauss(width_of="power")),
    ("form", gauss(form="tilted")),
    *[("x", lambda v=v: bp.Profile(v, [1.0, 1.0])) for v in ([1, 0], [0, 0], [0, NAN], [0], [[0, 1]], [])],
    *[("p", lambda v=v: bp.Profile([0, 1], v)) for v in ([1], [1, NAN], [0, 0], [[1, 1]])],
    ("z0", lambda: bp.Profile([0, 1], [1, 1], z0=1)),
    ("angle", lambda: bp.Profile([0, 1], [1, 1], angle=90)),
    *[("width", lambda v=v: bp.Slits(v, 1)) for v in (0, -1, NAN)],
    *[("separation", lambda v=v: bp.Slits(1, v)) for v in (0.5, 0, NAN, "a")],
    *[("count", lambda v=v: bp.Slits(1, 2, v)) for v in (0, 1.5, NAN)],
    ("z0", lambda: bp.Slits(1, 2, z0=0.1)),
    ("angle", lambda: bp.Slits(1, 2, angle=-90)),
    ("x", lambda: bp.Profile("a", [1, 1])),
]

QUESTIONS = [
    ("slab", scattering(slab=CELL, kx=0)),
    *[("frequency", scattering(frequency=v, kx=0)) for v in (NAN, INF, 0, -1, "a", [], [[1.0]], 1j, [1, NAN], None)],
    *[("kx", scattering(kx=v)) for v in (NAN, "a", [], [[0.0]], [0, INF])],
    *[("kx_over_k0", scattering(kx_over_k0=v)) for v in (NAN, [])],
    *[("angle", scattering(angle=v)) for v in (91, [0, -90.5], NAN, 1j, [])],
    ("kx, angle", scattering(kx=0, angle=0)),
    ("got none", scattering()),
    ("before", scattering(slab=bp.Slab(CELL, before=bp.Fluid(-1, 1e5)), angle=0)),
    ("cell", lambda: bp.bloch(SLAB, F, kx=0)),
    ("cell", lambda: bp.bloch(bp.Cell([bp.Layer(bp.Fluid(0, 1e5), 0.1)]), F, kx=[0, 1])),
    ("kx", lambda: bp.bloch(CELL, F, kx=1j)),
    ("kx_over_k0", lambda: bp.bloch(CELL, F, kx_over_k0=[NAN])),
    ("frequency", lambda: bp.bloch(CELL, -F, kx=0)),
    ("background", lambda: bp.bloch(CELL, F, kx_over_k0=0, background=3)),
    ("background", lambda: bp.bloch(CELL, F, kx_over_k0=0, background=bp.Fluid(-1, 1e5))),
    ("slab", field(slab=CELL)),
    ("beam", field(beam=0.1)),
    *[("frequency", field(frequency=v)) for v in (NAN, 0, [], 1j)],
    *[("x", field(x=v)) for v in ([], np.ones((2, 2)), [NAN], INF, "a", 1j)],
    *[("z", field(z=v)) for v in ([], np.ones((2, 2)), [NAN], -0.0501, [0.1, -1])],
    *[("angle", field(angle=v)) for v in (90, [0, -95], NAN, 1j, [])],
    ("boundary", field(boundary="closed")),
    ("period", field(period=1.0)),
    *[("period", field(boundary="periodic", period=v)) for v in (NAN, 0, -1, "a", 0.05)],
    ("period", field(boundary="periodic", x=[0.0, 0.1, 0.7])),
    ("period", field(boundary="periodic", x=0.0)),
    ("period", field(boundary="periodic", x=np.linspace(-0.05, 0.05, 32))),  # a grid too small for the beam
    *[("rtol", field(rtol=v)) for v in (0, -1, 1.0, 1e-13, NAN, "a")],
    *[
        ("before", field(slab=bp.Slab(CELL, before=v)))
        for v in (bp.Fluid(-1, -1e5), bp.Fluid(-1, 1e5), bp.Fluid(1, 1e5, INF))
    ],
    ("after", lambda: bp.beam_width(bp.Slab(CELL, after=bp.Fluid(-1, -1e5)), bp.GaussianBeam(0.1), 2500.0)),
    ("slab", width(slab=CELL)),
    ("beam", width(beam=None)),
    *[("frequency", width(frequency=v)) for v in (NAN, 0, [])],
    *[("angle", width(angle=v)) for v in (90, NAN, 1j, [])],
    *[("rtol", width(rtol=v)) for v in (0, 1.0, NAN)],
    *[("air_distance", width(air_distance=v)) for v in (0, -1, NAN, "a")],
]


@pytest.mark.parametrize(("name", "ask"), [*STRUCTURES, *BEAMS, *QUESTIONS])
def test_wrong_input_is_named(name, ask):
    """A ValueError that begins with the argument's name and says what was expected and what came."""
    with pytest.raises(ValueError, match=rf"(?s)^({name}\b|.*{name}$)") as caught:
        ask()
    assert len(str(caught.value)) > len(name) + 10


@pytest.mark.parametrize(
    ("ask", "came"),
    [
        (scattering(angle=[0, 91.5]), "91.5"),
        (scattering(kx=[0, INF]), "inf"),
        (scattering(frequency=[1, -3.0], kx=0), "-3"),
        (field(z=[0.1, -0.7]), "-0.7"),
        (field(rtol=2), "2"),
        (lambda: bp.Layer(bp.AIR, -0.5), "-0.5"),
        (field(angle=[0, 95.0]), "95"),
    ],
)
def test_the_message_shows_what_came(ask, came):
    """Of an array, the value that is wrong is shown."""
    with pytest.raises(ValueError, match="got") as caught:
        ask()
    assert came in str(caught.value).split("got")[-1]


@pytest.mark.parametrize(
    "make",
    [
        lambda: bp.Fluid(1 - 0.1j, 1e5, active=True),
        lambda: bp.Fluid(1, 1e5 + 10j, active=True),
        lambda: bp.Fluid(1, 1e5, 1 - 1j, active=True),
        lambda: bp.Fluid.from_speed(1, 343.0 + 1j, active=True),
    ],
)
def test_gain_is_accepted_when_asked_for(make):
    """active=True lets a medium amplify: R + T exceeds 1."""
    ds = bp.scattering(bp.Slab.uniform(make(), 0.1), F, angle=30)
    assert ds.reflectivity + ds.energy_transmission > 1
    assert ds.absorption < 0


def test_adding_something_else_to_a_slab():
    """`slab + number` is a TypeError, Python's own."""
    with pytest.raises(TypeError, match="unsupported"):
        SLAB + 3


# --- structures as values ---------------------------------------------------------------------------------


def test_structures_are_values():
    """Equal parts make equal wholes with equal hashes; a changed number makes another."""
    makers = [
        lambda d=1.25: bp.Fluid(d, 1e5),
        lambda d=1.25: bp.Layer(bp.Fluid(d, 1e5), 0.1),
        lambda d=1.25: bp.Cell([bp.Layer(bp.Fluid(d, 1e5), 0.1)]),
        lambda d=1.25: bp.Slab([bp.Layer(bp.Fluid(d, 1e5), 0.1)], 3),
        lambda d=1.25: bp.lmmd_emt(bp.lmmd_cell(d + 0.1j)),
        lambda d=1.25: bp.lmmd_emt_slab(bp.Slab(bp.lmmd_cell(d + 0.1j), 2)),
        lambda d=1.25: bp.GaussianBeam(d),
        lambda d=1.25: bp.Slits(d, 3.0),
        lambda d=1.25: bp.Profile([0.0, 1.0], [1.0, d]),
        lambda d=1.25: bp.Membrane(d),
    ]
    for make in makers:
        assert make() == make()
        assert hash(make()) == hash(make())
        assert make() != make(1.5)
        assert len({make(), make(), make(1.5)}) == 2


@pytest.mark.parametrize(
    "value", [bp.AIR, LAYER, CELL, SLAB, BEAM, bp.Slits(1, 2), bp.Profile([0, 1], [1, 1]), bp.Membrane(1.0)]
)
def test_structures_are_frozen(value):
    """No field of a structure or beam can be set again."""
    for name in (f.name for f in dataclasses.fields(value)):
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(value, name, 1.0)
    if isinstance(value, bp.Profile):
        with pytest.raises(ValueError, match="read-only"):
            value.p[0] = 2


def test_representations_are_short_and_say_the_numbers():
    """repr fits on a line or two, even for the paper's 4500 layers."""
    assert repr(bp.AIR) == "Fluid(density=1.25, bulk_modulus=147061)"
    assert repr(bp.Slab(CELL, 450)).startswith("Slab(450 x Cell(10 layers, 0.00228667 m)")
    assert "density_x=inf" in repr(bp.Fluid(1, 1e5, INF))
    for value in (bp.lmmd_emt(CELL), SLAB + bp.Slab([LAYER]), LAYER, BEAM):
        assert len(repr(value)) < 400
        assert "object at 0x" not in repr(value)


def test_slabs_stack():
    """a + a is a with twice the periods; thickness adds; equal neighbours merge."""
    twice = SLAB + SLAB
    assert twice == bp.Slab(CELL, 40)
    both = SLAB + bp.Slab([LAYER], after=bp.Fluid(2, 1e5))
    assert both.thickness == pytest.approx(SLAB.thickness + 0.01, rel=1e-15)
    assert [n for _, n in both.segments] == [20, 1]
    assert (both.before, both.after) == (bp.AIR, bp.Fluid(2, 1e5))


@pytest.mark.parametrize(("n_layers", "eta", "f0"), [(10, 1 / 60, 2500.0), (7, 1 / 20, 900.0)])
def test_the_cell_of_equation_10(n_layers, eta, f0):
    """rho_j = rho_m + (1/eta + i delta) cos(2 pi (j-1)/N) times the background's, in layers of eta lambda0/N."""
    background = bp.Fluid.from_speed(3.0, 500.0)
    cell = bp.lmmd_cell(0.3 + 0.2j, 0.1, n_layers, eta, f0, background)
    assert len(cell.layers) == n_layers
    for j, layer in enumerate(cell.layers, start=1):
        rho = 0.3 + 0.2j + (1 / eta + 0.1j) * np.cos(2 * np.pi * (j - 1) / n_layers)
        assert layer.fluid.density == pytest.approx(3.0 * rho, rel=1e-12)
        assert layer.fluid.bulk_modulus == background.bulk_modulus
        assert layer.thickness == pytest.approx(eta * 500 / f0 / n_layers, rel=1e-14)


def test_a_computed_launch_plane_is_the_launch_plane():
    """A plane in front of it by rounding is on it, one farther off is refused."""
    slab, beam = bp.Slab.uniform(bp.AIR, 0.01), bp.GaussianBeam(0.05, z0=-0.015)
    z = -0.5 * 0.03 * (1 + 2**-52)
    assert z < beam.z0
    assert float(bp.field(slab, beam, 2500.0, [0.0], [z]).z[0]) == beam.z0
    with pytest.raises(ValueError, match="z: expected positions not in front of the launch plane"):
        bp.field(slab, beam, 2500.0, [0.0], [beam.z0 - 1e-12])
