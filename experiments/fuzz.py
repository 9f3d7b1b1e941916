"""Does anything but an answer or a ValueError come out? Random media and calls, in processes of bounded memory and time.

    python experiments/fuzz.py            # 100 000 media, 5000 calls; half an hour on two cores
    python experiments/fuzz.py --quick    # a few hundred of each
    python experiments/fuzz.py --case calls:123     # one of them again, with its traceback

Every case is made from its number. An outcome is good if it is an answer without NaN or infinity (or with a warning, or where
they are documented), or a ValueError that names an argument. Bad are: other errors, warnings of NumPy that leak, values that are not
finite and not warned of, more than SECONDS of the processor, more than MEMORY bytes, and the end of the process.
"""

from __future__ import annotations

import argparse
import collections
import concurrent.futures
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import traceback
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

SECONDS, MEMORY = 10, 4 * 2**30
COUNTS, QUICK = {"media": 100_000, "calls": 5000}, {"media": 300, "calls": 300}
#: Cases that one process asks.
TOGETHER = {"media": 2500, "calls": 125}

#: Variables of which NaN is documented: where no power is incident; where a frequency has fewer modes than another; outside of
#: all nodes.
DOCUMENTED = {
    "scattering": {"energy_transmission", "absorption"},
    "guided_modes": {"kx", "kx_over_k0", "residual"},
    "to_grid": {"p"},
    "sweep": {"energy_transmission", "absorption"},  # its question asks for them
}
#: How NumPy's and SciPy's own warnings begin.
LEAKS = re.compile(
    r"(overflow|underflow|invalid value|divide by zero) encountered|Mean of empty|Casting complex|All-NaN"
)
NAMED = re.compile(r"[\w.]+( of [\w.]+)?(, [\w. ]+)*: |(/|the field|slab)")
#: Outcomes that are as they should be.
GOOD = ("answer", "answer with a warning", "ValueError", "OSError of a file")
#: Functions that read or write files, which the system may refuse.
FILES = ("Profile.from_file", "Slab.from_table", "load", "read_comsol", "save", "save_field")
#: Functions whose answer repeats a NaN that they are given, or has one where a given field is zero.
GIVEN = ("compare", "fwhm", "load", "save")


class TooSlow(BaseException):
    """A case that takes more than its time: not an Exception, so that nothing on the way keeps it."""


def _out_of_time(*_: object) -> None:
    raise TooSlow


# --- one case ---------------------------------------------------------------------------------------------


def not_finite(answer: Any) -> list[str]:
    """Names of a dataset's variables with NaN or infinity."""
    import numpy as np
    import xarray as xr

    if isinstance(answer, xr.DataArray):
        answer = answer.to_dataset(name="value")
    if not isinstance(answer, xr.Dataset):
        return []
    numbers = ((str(n), v.values) for n, v in answer.variables.items() if v.dtype.kind in "fc")
    return [n for n, values in numbers if not np.all(np.isfinite(values))]


def outcome(name: str, ask: Callable[[], Any]) -> tuple[str, str]:
    """What comes of a question, and details of what is bad."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            answer = ask()
            repr(answer)
        except ValueError as error:
            answer, text = error, str(error)
            if not NAMED.match(text):
                return "ValueError without a name", text
        except TooSlow:
            return f"more than {SECONDS} s", ""
        except Exception as error:
            if isinstance(error, OSError) and name in FILES:
                return "OSError of a file", ""
            return type(error).__name__, str(error)
    leaked = [f"{w.category.__name__}: {w.message}" for w in caught if LEAKS.search(str(w.message))]
    if leaked:
        return "leaked warning", leaked[0]
    if isinstance(answer, ValueError):
        return "ValueError", ""
    bad = set(not_finite(answer)) - DOCUMENTED.get(name.split(",")[0], set())
    if bad and not caught and name not in GIVEN:
        return "unannounced NaN or infinity", ", ".join(sorted(bad))
    return ("answer with a warning" if caught else "answer"), ""


def ask_all(kind: str, first: int, last: int) -> Iterator[dict[str, Any]]:
    """Outcomes of some cases, within limits of time and memory; each prints its number before it begins."""
    import matplotlib

    matplotlib.use("agg")
    import matplotlib.pyplot as plt
    from fuzz_calls import CASES

    signal.signal(signal.SIGPROF, _out_of_time)
    for number in range(first, last):
        yield {"begun": number}
        for name, ask in CASES[kind](number):
            signal.setitimer(signal.ITIMER_PROF, SECONDS)  # of the processor: others may be busy on the machine
            # these end the process: for what Python cannot interrupt, and for what waits without end
            signal.setitimer(signal.ITIMER_VIRTUAL, 3 * SECONDS)
            signal.setitimer(signal.ITIMER_REAL, 60 * SECONDS)
            what, detail = outcome(name, ask)
            signal.setitimer(signal.ITIMER_PROF, 0)
            yield {"case": f"{kind}:{number}", "name": name, "outcome": what, "detail": detail[:200]}
            if name == "media made" and what not in ("answer", "answer with a warning"):
                break
        plt.close("all")


# --- many, in processes -----------------------------------------------------------------------------------


def _limited() -> None:
    import resource

    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def in_process(kind: str, first: int, last: int) -> list[dict[str, Any]]:
    """Outcomes from a process of its own; where it ends, that is the outcome of the case that it was at."""
    cases: list[dict[str, Any]] = []
    while first < last:
        command = [sys.executable, __file__, "--worker", kind, str(first), str(last)]
        with tempfile.TemporaryDirectory() as folder:  # of all files that cases write
            environment = os.environ | {"OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "agg", "TMPDIR": folder}
            child = subprocess.run(command, capture_output=True, text=True, preexec_fn=_limited, env=environment)
        lines = [json.loads(line) for line in child.stdout.splitlines()]
        cases += [line for line in lines if "case" in line]
        if child.returncode == 0:
            break
        at = max((line["begun"] for line in lines if "begun" in line), default=first)
        end = child.stderr.strip().splitlines()[-1:] or [""]
        what = f"end of the process ({child.returncode})"
        cases.append({"case": f"{kind}:{at}", "name": "?", "outcome": what, "detail": end[0][:200]})
        first = at + 1
    return cases


def run(kind: str, count: int, workers: int = 2) -> list[dict[str, Any]]:
    """Outcomes of `count` cases."""
    size = min(TOGETHER[kind], -(-count // workers))
    starts = range(0, count, size)
    with concurrent.futures.ThreadPoolExecutor(workers) as pool:
        parts = pool.map(lambda first: in_process(kind, first, min(first + size, count)), starts)
        return [case for part in parts for case in part]


def table(cases: list[dict[str, Any]]) -> str:
    """Counts by function and outcome, as Markdown; then what was bad, with the number to ask it again."""
    counts = collections.Counter((case["name"], case["outcome"]) for case in cases)
    outcomes = [*GOOD, *sorted({what for _, what in counts} - set(GOOD))]
    rows = [f"| function | {' | '.join(outcomes)} |", "|---" * (len(outcomes) + 1) + "|"]
    for name in dict.fromkeys(case["name"] for case in sorted(cases, key=lambda case: case["name"])):
        rows.append(f"| {name} | {' | '.join(str(counts[name, what]) for what in outcomes)} |")
    totals = collections.Counter(case["outcome"] for case in cases)
    rows.append(f"| all | {' | '.join(str(totals[what]) for what in outcomes)} |")
    bad = [f"{case['case']} {case['name']}: {case['outcome']}: {case['detail']}" for case in failures(cases)]
    return "\n".join([*rows, "", *bad[:60]])


def failures(cases: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Those that are not as they should be."""
    return [case for case in cases if case["outcome"] not in GOOD]


def again(case: str) -> None:
    """One case, with its traceback and warnings."""
    from fuzz_calls import CASES

    kind, number = case.split(":")
    for name, ask in CASES[kind](int(number)):
        print(f"--- {name}")
        try:
            print(ask())
        except Exception:
            traceback.print_exc(limit=-6)


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="a few hundred of each")
    parser.add_argument("--only", choices=sorted(COUNTS), help="media or calls alone")
    parser.add_argument("--case", help="ask one again: media:123 or calls:123")
    parser.add_argument("--worker", nargs=3, help=argparse.SUPPRESS)
    options = parser.parse_args()
    sys.path.insert(0, str(Path(__file__).parent))
    if options.worker:
        kind, first, last = options.worker
        for line in ask_all(kind, int(first), int(last)):
            print(json.dumps(line), flush=True)
    elif options.case:
        again(options.case)
    else:
        for kind, count in (QUICK if options.quick else COUNTS).items():
            if options.only in (None, kind):
                print(f"{count} {kind}\n\n{table(run(kind, count))}\n")


if __name__ == "__main__":
    main()
