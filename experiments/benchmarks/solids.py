"""Time of r and t of solids for each kx and layer, over that of as many layers of fluid, in one run: plates, and stacks in contact.

Fluids and solids take the same way through `SampledSlab.response`, at the same kx. Times are of the processor. "Like" stacks repeat two layers, of "unlike" ones no two
are the same. Cells that hold a fluid take as long for any number of periods.
"""

import time

import _one_thread  # noqa: F401  (before NumPy)
import numpy as np
from timing import amount, measure

import beamprop as bp
from beamprop.response.sampled_slab import sample

WATER = bp.Fluid.from_speed(1000.0, 1480.0)
STEEL, EPOXY = bp.Solid(7900.0, 5900.0, 3200.0), bp.Solid(1200.0, 2600.0, 1150.0)
HEAVY, LIGHT = bp.Fluid.from_speed(7900.0, 5900.0), bp.Fluid.from_speed(1200.0, 2600.0)
FREQUENCY, COUNT = 3e6, 4000
PERIODS = (10, 1000, 100000)


def response_of(layers, periods=1, turn=1.0):
    """One response of layers (medium, thickness) at COUNT kx up to 2 k0, times `turn`."""
    s = sample(bp.Slab([bp.Layer(*layer) for layer in layers], periods, background=WATER), FREQUENCY)
    kx = np.linspace(0, 2, COUNT) * s.k0 * turn + 0j
    return lambda: s.response(kx)


def stack(media, thickness, count, unlike=0.0):
    """`count` layers of two media in turn, each thicker by a share `unlike` than the one before."""
    return [(media[i % 2], thickness * (1 + unlike * i)) for i in range(count)]


def main():
    print("| layers | thickness [mm] | kx | fluid [ns per kx and layer] | solid | ratio |")
    print("|---|---|---|---|---|---|")
    for name, count, unlike in (("a plate", 1, 0.0), ("20 like", 20, 0.0), ("20 unlike", 20, 0.01)):
        for thickness in (1e-3, 1e-5):
            for kind, turn in (("real", 1.0), ("complex", 1 - 0.02j)):
                stacks = (stack(media, thickness, count, unlike) for media in ((HEAVY, LIGHT), (STEEL, EPOXY)))
                works = (response_of(layers, turn=turn) for layers in stacks)
                fluid, solid = (1e9 * t / (COUNT * count) for t in measure(*works, clock=time.process_time))
                print(f"| {name} | {1e3 * thickness:g} | {kind} | {fluid:.0f} | {solid:.0f} | {solid / fluid:.1f} |")
    cell = [(STEEL, 1e-3), (WATER, 1e-3), (EPOXY, 5e-4)]
    print("\n| periods of steel, water and epoxy | time of r and t |\n|---|---|")
    times = measure(*(response_of(cell, n) for n in PERIODS), clock=time.process_time)
    for periods, seconds in zip(PERIODS, times, strict=True):
        print(f"| {periods} | {amount(seconds, 's')} |")


if __name__ == "__main__":
    main()
