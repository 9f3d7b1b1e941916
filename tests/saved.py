"""Datasets of every question, for the tests of files; and fields written in blocks against whole ones."""

import numpy as np
import xarray as xr

import beamprop as bp

F = 2500.0
SLAB = bp.Slab(bp.lmmd_cell(), 20)
BEAM = bp.GaussianBeam(0.096, z0=-0.05)
X = np.linspace(-0.4, 0.4, 11)

DATASETS = {
    "field": lambda: bp.field(SLAB, BEAM, [2400.0, F], X, [0.0, 0.1, 0.2], angle=[0.0, 30.0]),
    "periodic": lambda: bp.field(SLAB, BEAM, F, (np.arange(60) - 30) * 0.02, 0.1, boundary="periodic"),
    "scalar field": lambda: bp.field(SLAB, BEAM, F, 0.0, 0.1),
    "scattering": lambda: bp.scattering(SLAB, [F, 2600.0], kx_over_k0=[0.0, 0.5, 1.0, 2.0]),
    "one angle": lambda: bp.scattering(SLAB, F, angle=12.0),
    "bloch": lambda: bp.bloch(SLAB.cell, [F, 2600.0], kx=[0.0, 3.0]),
    "widths": lambda: bp.beam_width(SLAB, BEAM, [2400.0, F]),
    "scalar widths": lambda: bp.beam_width(SLAB, BEAM, F),
    "measures": lambda: bp.beam_measures(SLAB, BEAM, [2400.0, F]),
    "modes": lambda: bp.guided_modes(LOSSLESS, [2400.0, F]),
}
LOSSLESS = bp.Slab(bp.lmmd_cell(rho_m=0.05, delta_rho=0), 20)


def assert_in_blocks_as_whole(folder, ending, arguments, memory, rtol, **options):
    """A file of `save_field` holds what `save` writes of `field`, but p to `rtol` of the largest; and it returns all but p."""
    path, whole = folder / f"map.{ending}", folder / f"whole.{ending}"
    bp.save(bp.field(*arguments, **options), whole)
    rest = bp.save_field(path, *arguments, memory=memory, **options)
    loaded, wanted = bp.load(path), bp.load(whole)
    xr.testing.assert_identical(loaded.drop_vars("p"), wanted.drop_vars("p"))
    xr.testing.assert_identical(loaded.drop_vars("p"), rest)
    assert loaded.p.dims == wanted.p.dims
    assert loaded.p.attrs == wanted.p.attrs
    np.testing.assert_allclose(loaded.p, wanted.p, rtol=0, atol=rtol * float(np.abs(wanted.p).max()))
