"""The variables of a field beside its pressure: particle velocity, intensity, and power through planes."""

from __future__ import annotations

import dataclasses
from typing import Any, NamedTuple

import numpy as np

from .. import validate
from ..contour.error import ErrorBudget, uniform_budget
from ..fields.in_space import PreparedInSpace, SpaceQuestion
from ..fields.question import FieldQuestion, Prepared
from ..fields.sum_in_space import PreparedSum, SumQuestion
from ..media.solid_runs import has_solids, in_solid
from ..media.structures import Slab
from ..profiles.plane_power import power_through_planes
from ..profiles.power import PowerError
from ..profiles.space_power import power_through_planes_in_space
from ..response.sampled_slab import SampledSlab, sample
from ..sources.angles import AngleInterpolation

#: What can be asked for, in the order of a dataset; "intensity" stands for all of its components.
VARIABLES = ("p", "v_x", "v_z", "u_x", "u_z", "s_xz", "intensity_x", "intensity_z", "power_through")
IN_SPACE = (
    *("p", "v_x", "v_y", "v_z", "u_x", "u_y", "u_z", "s_xz", "s_yz"),
    *("intensity_x", "intensity_y", "intensity_z", "power_through"),
)
INTENSITY = {f"intensity_{axis}": f"v_{axis}" for axis in "xyz"}
#: Displacements are made of velocities: v = -i w u.
DISPLACEMENT = {f"u_{axis}": f"v_{axis}" for axis in "xyz"}
#: What is summed over plane waves, and what of it is 0 in fluids.
SUMMED, SHEAR = ("p", "v_x", "v_y", "v_z", "s_xz", "s_yz"), ("s_xz", "s_yz")
#: What an error is relative to.
SCALES = (
    {name: f"the largest |{name}|" for name in (*SUMMED, *DISPLACEMENT)}
    | {name: f"{name}: half the largest |p| times the largest |{v}|" for name, v in INTENSITY.items()}
    | {"power_through": "power_through: the incident power"}
)


def checked_variables(variables: Any, slab: Slab, z: np.ndarray, known: tuple[str, ...] = VARIABLES) -> tuple[str, ...]:
    """The names of the variables, each once and in the order of those `known`, or a ValueError."""
    names = [variables] if isinstance(variables, str) else variables
    expected = f"some of {', '.join((*known, 'intensity'))}"
    if not isinstance(names, list | tuple) or not names:
        raise validate.refuse("variables", expected, variables)
    for name in names:
        if not isinstance(name, str) or name not in (*known, "intensity"):
            raise validate.refuse("variables", expected, name)
    chosen = tuple(v for v in known if v in names or (v in INTENSITY and "intensity" in names))
    if set(INTENSITY) & set(chosen) and (solid := in_solid(slab, z)).any():
        raise ValueError(
            f"variables: expected an intensity at z in fluids (p v lacks the part of the shear stress), got z = {z[solid][0]:g} "
            "in a solid; power_through is the whole flux there"
        )
    return chosen


def of_component(component: Any, variables: Any) -> Any:
    """`variables`, or what `component` names alone, or a ValueError."""
    if component is None:
        return variables
    if variables != ("p",):
        raise validate.refuse("component", "none beside variables, which takes several", component)
    validate.word(component, "component", *SUMMED, *DISPLACEMENT)
    return (component,)


class Row(NamedTuple):
    """A question at one frequency: what is to be filled, and the contour of each quantity that is summed for it."""

    variables: tuple[str, ...]  #: those on (z, x)
    prepared: dict[str, Prepared | PreparedInSpace | PreparedSum]
    omega: float

    def fill(self, planes: slice, angles: slice, out: dict[str, np.ndarray]) -> dict[str, ErrorBudget]:
        """Every variable at planes and angles into out[variable] (A, Z, X) or (A, Z, Y, X); the terms of their errors, (A,) each."""
        if not self.variables:
            return {}
        shape = out[self.variables[0]].shape
        sums = {q: out[q] if q in out else np.empty(shape, complex) for q in self.prepared}
        budgets = {q: prepared.fill(planes, angles, sums[q]) for q, prepared in self.prepared.items()}
        for name in set(self.variables) & set(DISPLACEMENT):
            np.multiply(sums[DISPLACEMENT[name]], 1j / self.omega, out=out[name])
            budgets[name] = budgets[DISPLACEMENT[name]]
        for name in set(self.variables) & set(SHEAR) - set(self.prepared):  # fluids alone
            out[name][:] = 0
            budgets[name] = uniform_budget(shape[0], 0.0)
        for name in set(self.variables) & set(INTENSITY):
            p, v = sums["p"], sums[INTENSITY[name]]
            for at in range(shape[0]):  # (1/2) Re p v*, angle by angle, which takes less memory
                np.multiply(p[at].real, v[at].real, out=out[name][at])
                out[name][at] += p[at].imag * v[at].imag
            out[name] *= 0.5
            both = zip(budgets["p"], budgets[INTENSITY[name]], strict=True)
            budgets[name] = ErrorBudget(*(a + b for a, b in both))
        return {name: budgets[name] for name in self.variables}


def _summed_for(variable: str) -> tuple[str, ...]:
    """The sums over plane waves that make a variable on (z, x)."""
    return ("p", INTENSITY[variable]) if variable in INTENSITY else (DISPLACEMENT.get(variable, variable),)


def row_of(question: FieldQuestion | SpaceQuestion | SumQuestion, i: int, variables: tuple[str, ...]) -> Row:
    """The contours at frequency i; both factors of an intensity keep half its rtol."""
    on_map = tuple(v for v in variables if v != "power_through")
    wanted = {q for v in on_map for q in _summed_for(v)}
    if set(INTENSITY) & set(on_map):
        question = dataclasses.replace(question, rtol=max(question.rtol / 2, 1e-12))
    if wanted & set(SHEAR) and not has_solids(question.slab):
        wanted -= set(SHEAR)
    prepared = {q: question.prepared(i, q) for q in SUMMED if q in wanted}
    return Row(on_map, prepared, 2 * np.pi * float(question.frequency[i]))


def kinds(variables: tuple[str, ...]) -> dict[str, type]:
    """The type of each variable on (z, x)."""
    return {v: float if v in INTENSITY else complex for v in variables if v != "power_through"}


def bytes_held(variables: tuple[str, ...], question: FieldQuestion | SpaceQuestion | SumQuestion) -> tuple[int, int]:
    """Bytes of all variables of a point on (z, x), and of what is summed for them and not kept.

    Of a sum of sources the field of one of them is held, too.
    """
    kept = kinds(variables)
    summed = {q for v in kept for q in _summed_for(v)}
    return sum(np.dtype(kind).itemsize for kind in kept.values()), 16 * (
        len(summed - set(kept)) + isinstance(question, SumQuestion)
    )


class Errors(NamedTuple):
    """The errors of each variable on (frequency, angle), and the terms of its worst one."""

    total: dict[str, np.ndarray]
    worst: dict[str, ErrorBudget | PowerError]

    def add(self, i: int, angles: slice, budgets: dict[str, ErrorBudget]) -> None:
        """Take those of a part at frequency i in: a beam's error is that of its worst part."""
        for name, budget in budgets.items():
            self.total[name][i, angles] = np.fmax(self.total[name][i, angles], budget.total)
            worst = self.worst.get(name)
            self.worst[name] = worst.worse(budget) if isinstance(worst, ErrorBudget) else budget.worst

    @property
    def worst_by_scale(self) -> list[tuple[ErrorBudget | PowerError, str]]:
        """The worst error of each variable, and what it is relative to."""
        return [(self.worst[name], SCALES[name]) for name in self.total if name in self.worst]


def no_errors(variables: tuple[str, ...], shape: tuple[int, ...]) -> Errors:
    """Those before anything is known: nan."""
    return Errors({name: np.full(shape[:2], np.nan) for name in variables}, {})


def powers(question: FieldQuestion | SpaceQuestion | SumQuestion, errors: Errors) -> np.ndarray:
    """Power through planes on (frequency, angle, z), [W/m] or in three dimensions [W], with its errors."""
    name, power = "power_through", np.empty(question.shape[:3])
    for i, frequency in enumerate(question.frequency):
        s = sample(question.slab, float(frequency), backward=True)
        for j in range(question.angle.size):
            power[i, j], error = _through_planes(question, j, s)
            errors.total[name][i, j] = error.total
            errors.worst[name] = max(error, errors.worst.get(name, error), key=lambda e: float(np.max(e.total)))
    return power


def _through_planes(
    question: FieldQuestion | SpaceQuestion | SumQuestion, j: int, s: SampledSlab
) -> tuple[np.ndarray, PowerError]:
    """Power through the planes at angle j, and its error."""
    z, rtol = question.z, question.rtol
    if isinstance(question, SumQuestion):
        return power_through_planes_in_space(s, question.source_at(j), z, rtol, question.period)
    source = AngleInterpolation(question.source, question.angle).at(float(question.angle[j]))
    if isinstance(question, SpaceQuestion):
        return power_through_planes_in_space(s, source, z, rtol, question.period)
    return power_through_planes(s, source, z, rtol, question.period)
