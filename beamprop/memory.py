"""What a question will hold in memory, and the refusal of what does not fit, before anything is allocated.

Sizes are predicted from numbers of points alone: the answer, and the largest temporaries beside it. The constants, bytes for
each point, are measured: tests/test_memory.py holds predictions to within a factor of two of the peak of a process. The limit is the
memory that is free, within what a container or a shell's limit allows; the environment variable BEAMPROP_MEMORY sets another
(bytes, or a number with K, M, G or T).
"""

from __future__ import annotations

import contextlib
import math
import os
from collections.abc import Iterator
from pathlib import Path

COMPLEX = 16
#: Whatever is smaller than this is not worth asking the system what is free.
SMALL = 2**26
#: Where the system does not say what is free: 8 GB.
UNKNOWN = 2.0**33
VARIABLE = "BEAMPROP_MEMORY"
PREFIXES = {"": 0, "K": 10, "M": 20, "G": 30, "T": 40}


def check(name: str, size: float, what: str, instead: str) -> None:
    """Refuse a question that would hold more than fits: `what` it is that takes `size` bytes, and what to do `instead`."""
    if size < SMALL and VARIABLE not in os.environ:
        return
    free = limit()
    if size > free:
        raise ValueError(
            f"{name}: expected a question that fits into {text(free)} of memory, got one that takes about {text(size)} "
            f"for {what}; {instead}"
        )


def text(size: float) -> str:
    """Bytes as a person reads them."""
    power = min(max(int(math.log10(max(size, 1.0))) // 3, 0), 5) if math.isfinite(size) else 5
    return f"{size / 1000**power:.3g} {('B', 'kB', 'MB', 'GB', 'TB', 'PB')[power]}"


# --- the limit --------------------------------------------------------------------------------------------


def limit() -> float:
    """Bytes that a question may hold: what BEAMPROP_MEMORY says, else what is free."""
    given = os.environ.get(VARIABLE)
    if given is None:
        return available()
    number, prefix = given.strip().upper().removesuffix("B").removesuffix("I"), ""
    if number[-1:] in PREFIXES:
        number, prefix = number[:-1], number[-1:]
    with contextlib.suppress(ValueError):
        if (size := float(number) * 2 ** PREFIXES[prefix]) > 0:
            return size
    raise ValueError(f"{VARIABLE}: expected bytes such as 8e9 or 8G, got {given!r}")


def available() -> float:
    """Bytes that this process may take without swapping: the least of what the system, containers and limits leave."""
    return max(0.0, min((*_system(), *_container(), *_address_space()), default=UNKNOWN))


def _numbers(path: str | Path) -> dict[str, float]:
    """Name -> number of a file of lines such as ``MemAvailable:  123 kB``; '' is the name of a lone number."""
    numbers = {}
    with contextlib.suppress(OSError, ValueError):
        for line in Path(path).read_text(encoding="ascii").splitlines():
            words = line.replace(":", " ").split()
            if len(words) == 1:
                words.insert(0, "")
            with contextlib.suppress(ValueError, IndexError):
                numbers[words[0]] = float(words[1]) * (1024 if words[-1] == "kB" else 1)
    return numbers


def _system() -> Iterator[float]:
    """What the machine has free."""
    linux = _numbers("/proc/meminfo").get("MemAvailable")
    if linux is not None:
        yield linux
        return
    with contextlib.suppress(AttributeError, ValueError, OSError):  # not on every system
        pages = os.sysconf("SC_AVPHYS_PAGES") if "SC_AVPHYS_PAGES" in os.sysconf_names else os.sysconf("SC_PHYS_PAGES")
        yield float(pages) * os.sysconf("SC_PAGE_SIZE")


def _container(own: str | Path = "/proc/self/cgroup", groups: str | Path = "/sys/fs/cgroup") -> Iterator[float]:
    """What the control groups of this process, and those around them, leave of their limits; files in the cache can go."""
    for line in _lines(own):
        _, controllers, path = line.split(":", 2)
        if not controllers or "memory" in controllers.split(","):
            new = not controllers  # version 2 has one tree for all controllers
            root = Path(groups) if new else Path(groups) / "memory"
            most, used = ("memory.max", "memory.current") if new else ("memory.limit_in_bytes", "memory.usage_in_bytes")
            here = root / path.lstrip("/")
            for folder in (here, *here.parents):
                top, now = _numbers(folder / most).get(""), _numbers(folder / used).get("")
                if top is not None and now is not None:
                    yield top - now + _numbers(folder / "memory.stat").get("inactive_file", 0.0)
                if folder == root:
                    break


def _lines(path: str | Path) -> list[str]:
    with contextlib.suppress(OSError):
        return [line for line in Path(path).read_text(encoding="utf-8").splitlines() if line.count(":") >= 2]
    return []


def _address_space() -> Iterator[float]:
    """What ``ulimit -v`` leaves."""
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource

        most, _ = resource.getrlimit(resource.RLIMIT_AS)
        if most != resource.RLIM_INFINITY:
            pages = float(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
            yield most - pages * resource.getpagesize()


# --- what questions hold ----------------------------------------------------------------------------------

#: Plane waves that are answered at a time, and positions along a row that are summed at a time.
WAVES_AT_A_TIME, POINTS_AT_A_TIME = 2**17, 2**18


def check_field(shape: tuple[int, ...], in_file: bool = False, values: tuple[int, int] = (COMPLEX, 0)) -> None:
    """A field map on (frequency, angle, z, x), of which a file takes the answer, and a row of it.

    `values` are the bytes that all variables of a point take, and those that are held for one frequency besides.
    """
    frequencies, angles, planes, points = shape
    row = COMPLEX * points
    # exponentials; copies of x, and rows that are summed together; angles that are made of others
    working = min(1.5e8, 4e4 * points) + (2 + min(planes, 16)) * row + 32.0 * angles * min(angles, 100)
    answer = 0 if in_file else points * planes * angles * (values[0] * frequencies + values[1])
    of = "p" if values == (COMPLEX, 0) else "each variable"
    many = (
        f"{frequencies * angles * planes * points:.3g} values of {of}"
        if not in_file
        else f"rows of {points:.3g} points"
    )
    advice = "ask for fewer points" if in_file else "ask for fewer points, or write the map to a file with save_field"
    check("x", answer + working, many, advice)


def check_waves(values: int, columns: int, name: str, bytes_each: float) -> None:
    """Plane-wave questions on (frequency, kx): what each answer takes, and the temporaries of a block."""
    size = bytes_each * values + 400.0 * min(values, WAVES_AT_A_TIME)
    check(name, size, f"{values:.3g} plane waves", f"ask for fewer of the {columns:.3g} {name}, in parts")


def check_table(entries: int, bytes_each: float) -> None:
    """Measures of beams on (frequency, angle)."""
    check("frequency", bytes_each * entries, f"{entries:.3g} pairs of frequency and angle", "ask for fewer, in parts")


def check_fft(values: int) -> None:
    """Buffers of FFTs, and what is done to a row of them."""
    check("x", 128.0 * values, f"Fourier transforms of {values:.3g} values", "ask for fewer points")


def check_contour(waves: float, beams: int = 1, planes: int = 9) -> None:
    """The plane waves of a contour: spectra of the beams, and the response on the planes that are compared."""
    size = waves * (700.0 + 75.0 * beams + 30.0 * planes)
    check(
        "x",
        size,
        f"{waves:.3g} plane waves" + (f" of {beams} beams" if beams > 1 else ""),
        "bring the launch plane, x and z nearer to each other, take a thinner slab, fewer angles or a larger rtol",
    )


#: Terms of the sum over plane waves at all positions of one window: 7e8 take a second on one core.
MOST_TERMS = 2e9


#: Terms of the two products by which a plane is summed at the positions of a window: 1.7e9 take a second on one core.
MOST_PRODUCTS = 1e10


def check_terms(waves: int, points: int) -> None:
    """The sum by which a beam is looked for in a window, of which nobody has chosen the positions."""
    if (terms := float(waves) * points) > MOST_TERMS:
        raise _too_many_terms((terms, MOST_TERMS, 7e8), waves, points)


def check_products(terms: float, waves: int, points: int, chosen: bool) -> None:
    """The products by which a plane is summed at the positions of a window, `chosen` by the user or widened to hold the beam."""
    if terms <= MOST_PRODUCTS:
        return
    if not chosen:
        raise _too_many_terms((terms, MOST_PRODUCTS, 1.7e9), waves, points)
    raise ValueError(
        f"window: expected one in which the beam is summed by products of at most {MOST_PRODUCTS:.3g} terms, got one that takes {terms:.3g} "
        f"({waves:.3g} plane waves at {points:.3g} positions, {terms / 1.7e9:.0f} s): take a smaller one, a larger rtol, or ask for the field "
        "at positions of your choice"
    )


def _too_many_terms(terms: tuple[float, float, float], waves: int, points: int) -> ValueError:
    """Of terms, how many there may be, and how many take a second."""
    count, most, of_second = terms
    return ValueError(
        f"slab: expected one in which the beam is found by sums of at most {most:.3g} terms, got one that takes "
        f"{count:.3g} ({waves:.3g} plane waves at {points:.3g} positions, {count / of_second:.0f} s for each of several windows): "
        "give it some loss, or take a thinner one, a nearer launch plane or a larger rtol, choose the window= of beam_measures, or ask for "
        "the field at positions of your choice"
    )


def most_values(bytes_each: float = 600.0) -> float:
    """How many values of a dispersion function may be held at a time, and be waited for: 2e6 take up to half a minute."""
    return min(limit() / bytes_each, 2e6)
