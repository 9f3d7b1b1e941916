"""The way of a frequency through `field`: which rooms of the package it enters, in which order, and from where."""

import sys

import numpy as np
import pytest
from source_tree import ROOT
from test_architecture import ORDER

import beamprop as bp
from beamprop.contour.error import uniform_budget
from beamprop.response import sampled_slab

#: Rooms of pure functions of numbers and arrays, which every other may call: they know neither slab nor beam nor contour.
HELPERS = {"conventions", "memory", "validate", "arrays"}


def room_of(frame):
    """The room whose code a frame runs, or None outside the package."""
    name = frame.f_code.co_filename
    return name.removeprefix(f"{ROOT}/").split("/")[0].removesuffix(".py") if name.startswith(f"{ROOT}/") else None


def calls_between_rooms(ask):
    """(caller's room, called room) of each call of `ask(progress)` from one room into another, in order.

    A frequency is on its way from the moment that `field` takes it out of its list of frequencies, which `progress` wraps,
    until it asks for the next. NumPy and others between two rooms are passed over.
    """
    calls = []

    def record(frame, event, _):
        if event == "call" and (room := room_of(frame)):
            caller = frame.f_back
            while caller and not room_of(caller):
                caller = caller.f_back
            if caller and room_of(caller) != room:
                calls.append((room_of(caller), room))

    def traced(frequencies):
        for frequency in frequencies:
            sys.setprofile(record)
            yield frequency
            sys.setprofile(None)

    before = sys.getprofile()
    try:
        ask(traced)
    finally:
        sys.setprofile(before)
    return calls


def rooms_entered(calls):
    """The rooms of `calls` in the order of their first entry, helpers left out."""
    return [room for room in dict.fromkeys(room for _, room in calls) if room not in HELPERS]


def upward(calls):
    """Calls from a room into a later one of the package's order."""
    return {(caller, room) for caller, room in calls if ORDER.index(room) > ORDER.index(caller)}


PAPER = bp.Slab(bp.lmmd_cell(), 450)
#: A layer of negative density guides a backward wave, whose pole is searched for and put right by a residue.
BACKWARD = bp.Slab.uniform(bp.Fluid(-0.6 * 1.25, bp.AIR.bulk_modulus), 0.01)


def calls_of_a_field(slab, planes):
    """The calls between rooms of one frequency of one tilted beam in open space."""
    x, z = np.linspace(-0.5, 0.5, 101), bp.faces(slab, planes)
    beam = bp.GaussianBeam(0.096, 20.0, z0=-0.1)
    return calls_between_rooms(lambda traced: bp.field(slab, beam, 2500.0, x, z, progress=traced))


@pytest.mark.parametrize(
    ("slab", "planes"), [(PAPER, 3), (PAPER, 250), (BACKWARD, 3)], ids=["paper", "map", "backward"]
)
def test_a_frequency_enters_at_most_six_rooms(slab, planes):
    """From the question to p: `fields` first, and no room is entered again from a room that it uses."""
    calls = calls_of_a_field(slab, planes)
    rooms = rooms_entered(calls)
    print(" -> ".join(rooms))
    assert rooms[0] == "fields"
    assert set(rooms) == {"fields", "response", "media", "sources", "contour", "modes"}
    assert upward(calls) == set()


def test_a_call_back_up_is_seen(monkeypatch):
    """Or the test above would hold by itself: a slab that asks contours for something while it is sampled."""
    values = sampled_slab.slab_values
    monkeypatch.setattr(sampled_slab, "slab_values", lambda *given: (uniform_budget(1, 0.0), values(*given))[1])
    assert upward(calls_of_a_field(PAPER, 3)) == {("response", "contour")}
