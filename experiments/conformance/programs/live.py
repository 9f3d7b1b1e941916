"""Live runs: an environment for each program, its adapter in it, and the file of what was answered when."""

from __future__ import annotations

import datetime
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

from .stacks import Program, questions

ANSWERS = Path(__file__).parent / "answers.json"
ADAPTERS = Path(__file__).parent / "adapters"
#: By how much the answers of one version may differ between machines, relative to the larger of 1 and themselves.
SAME = 1e-10


def interpreter(oldest: tuple[int, int]) -> str:
    """This Python, or the first newer one that runs."""
    if sys.version_info[:2] >= oldest:
        return sys.executable
    pyenv = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")) / "versions"
    for minor in range(oldest[1], 40):
        for candidate in (shutil.which(f"python3.{minor}"), *sorted(pyenv.glob(f"3.{minor}.*/bin/python"))):
            if (
                candidate
                and subprocess.run([candidate, "-c", "import venv"], capture_output=True, check=False).returncode == 0
            ):
                return str(candidate)
    raise SystemExit(f"expected Python {oldest[0]}.{oldest[1]} or newer, found none")


def environment(program: Program, folder: Path) -> Path:
    """The Python of an environment with the program, made if there is none."""
    python = folder / program.name / ("Scripts" if os.name == "nt" else "bin") / "python"
    if not python.exists():
        subprocess.run([interpreter(program.python), "-m", "venv", str(folder / program.name)], check=True)
    packages = [f"{program.name}=={program.version}", *program.undeclared]
    subprocess.run([str(python), "-m", "pip", "install", "-q", *packages], check=True, stdout=sys.stderr)
    return python


def run(program: Program, folder: Path) -> dict[str, list]:
    """What the program answers, now."""
    script = [str(environment(program, folder)), str(ADAPTERS / f"with_{program.name.lower()}.py")]
    asked = json.dumps(questions(program))
    done = subprocess.run(script, input=asked, stdout=subprocess.PIPE, text=True, check=True, timeout=600)
    return json.loads(done.stdout)


def stored() -> dict[str, dict]:
    """By program: version, date, answers."""
    return json.loads(ANSWERS.read_text(encoding="utf-8"))


def store(fresh: dict[str, tuple[str, dict[str, list]]]) -> None:
    """Replace the answers of some programs, with their versions and today's date."""
    today = datetime.date.today().isoformat()
    entries = {name: {"version": v, "date": today, "answers": answers} for name, (v, answers) in fresh.items()}
    old = stored() if ANSWERS.exists() else {}
    text = json.dumps(old | entries, indent=1, ensure_ascii=False, sort_keys=True)
    ANSWERS.write_text(text + "\n", encoding="utf-8")


def changed(name: str, answers: dict[str, list]) -> list[str]:
    """The questions that a program answers otherwise than is stored."""
    old = stored().get(name, {"answers": {}})["answers"]
    return [f"{name}: {question}" for question in answers | old if not same(answers.get(question), old.get(question))]


def same(a: list | None, b: list | None) -> bool:
    """Whether two answers, r and t, agree."""
    if a is None or b is None:
        return False
    pairs = [(complex(*x), complex(*y)) for x, y in zip(a, b, strict=True)]
    return all(abs(x - y) <= SAME * max(1, abs(y)) for x, y in pairs)
