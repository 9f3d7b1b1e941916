"""Random media and calls, a few hundred of each and always the same: answers, and ValueErrors that name an argument."""

import sys

import fuzz
import fuzz_calls
import pytest

import beamprop as bp

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="processes are not limited there")


@pytest.mark.parametrize("kind", fuzz.QUICK)
def test_nothing_else_comes_out(kind):
    """No other error, no warning of NumPy, no NaN without a warning, nothing slow or large, no end of the process."""
    cases = fuzz.run(kind, fuzz.QUICK[kind])
    assert len(cases) >= fuzz.QUICK[kind]
    assert sum(case["outcome"] == "answer" for case in cases) > len(cases) / 3
    assert fuzz.failures(cases) == []


def _named():
    """What is public and can be called, as the table of calls names it."""
    modules = {name: getattr(bp, name) for name in ("plot", "fem")}
    public = {name for name in bp.__all__ if callable(getattr(bp, name)) and not name.endswith("Warning")}
    return (
        public
        | {
            f"plot.{n}"
            for n in ("animate", "bloch", "comparison", "cut", "field", "modes", "scattering", "sweep", "width")
        }
        | {f"fem.{n}" for n in vars(modules["fem"]) if n in ("field", "plan")}
    )


def test_every_public_function_is_called():
    """The table of calls has all that is public."""
    assert _named() <= set(fuzz_calls.CALLS)


@pytest.mark.parametrize(
    ("ask", "said"),
    [
        (lambda: 1 / 0, "ZeroDivisionError"),
        (lambda: bp.scattering(bp.Slab(bp.lmmd_cell()), 2500.0, kx=0.0) * float("nan"), "unannounced NaN or infinity"),
        (lambda: (_ for _ in ()).throw(ValueError("what")), "ValueError without a name"),
        (lambda: (_ for _ in ()).throw(ValueError("x: expected this, got that")), "ValueError"),
        (lambda: __import__("numpy").float64(1e300) * 1e300, "leaked warning"),
        (lambda: (_ for _ in ()).throw(MemoryError()), "MemoryError"),
        (lambda: 1, "answer"),
    ],
    ids=lambda v: v if isinstance(v, str) else "",
)
def test_outcomes_are_told_apart(ask, said):
    """What is bad is seen to be bad (or the tests above would hold by themselves)."""
    assert fuzz.outcome("bloch", ask)[0] == said


def test_an_end_of_a_process_is_counted(monkeypatch):
    """A process that ends is the outcome of the case at which it ended; the others are asked all the same."""
    monkeypatch.setattr(
        fuzz, "_limited", lambda: __import__("resource").setrlimit(__import__("resource").RLIMIT_CPU, (0, 0))
    )
    cases = fuzz.in_process("media", 3, 5)
    assert [case["case"] for case in cases] == ["media:3", "media:4"]
    assert all(case["outcome"].startswith("end of the process") for case in cases)
