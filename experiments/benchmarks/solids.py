"""Time of r and t of solids for each kx and layer, over that of as many layers of fluid: a plate, and a stack in contact."""

import _one_thread  # noqa: F401  (before NumPy)
import numpy as np
from timing import measure

import beamprop as bp
from beamprop.response.sampled_slab import sample

WATER = bp.Fluid.from_speed(1000.0, 1480.0)
STEEL, EPOXY = bp.Solid(7900.0, 5900.0, 3200.0), bp.Solid(1200.0, 2600.0, 1150.0)
HEAVY, LIGHT = bp.Fluid.from_speed(7900.0, 5900.0), bp.Fluid.from_speed(1200.0, 2600.0)
FREQUENCY, COUNT = 3e6, 4000


def response_of(media, thickness, layers):
    """One response at COUNT kx up to 2 k0."""
    stack = [bp.Layer(media[i % 2], thickness) for i in range(layers)]
    s = sample(bp.Slab(stack, background=WATER), FREQUENCY)
    kx = np.linspace(0, 2, COUNT) * s.k0 + 0j
    return lambda: s.response(kx)


def main():
    print("| layers | thickness [mm] | fluid [ns per kx and layer] | solid | ratio |")
    print("|---|---|---|---|---|")
    for layers, thickness in ((1, 1e-3), (1, 1e-5), (20, 1e-3), (20, 1e-5)):
        works = (response_of(media, thickness, layers) for media in ((HEAVY, LIGHT), (STEEL, EPOXY)))
        fluid, solid = measure(*works)
        per = 1e9 / (COUNT * layers)
        print(f"| {layers} | {1e3 * thickness:g} | {fluid * per:.0f} | {solid * per:.0f} | {solid / fluid:.1f} |")


if __name__ == "__main__":
    main()
