"""Do intervals of 95 % contain the true value?  Run: pytest -m coverage."""

from pathlib import Path

import pytest

import presswear as pw
from intervals.coverage import (
    HEADER,
    SUBJECTS,
    scenes_of,
    table,
)

FOLDER = Path("results/coverage")  # finished runs in it are not repeated
FEW = 6  # tries of --quick, which show that the command runs


@pytest.mark.coverage
@pytest.mark.parametrize("name", SUBJECTS)
def test_intervals_contain_the_true_value(name, request):
    """Tries with seeds of their own against long runs; the table is printed and stored."""
    is_quick = bool(request.config.getoption("--quick"))
    scenes = scenes_of(SUBJECTS[name], FEW if is_quick else None)
    jobs = request.config.getoption("--jobs")
    results = pw.run_scenes(scenes, FOLDER / name, jobs=int(jobs) if jobs else None)
    failures = []
    for stage in range(SUBJECTS[name].scene.wear_updates + 1):
        rows = table(results, stage)
        text = "\n".join([HEADER, *(f"| {row} |" for row in rows)])
        (FOLDER / f"{name}-{stage}.md").write_text(f"{text}\n", encoding="utf-8")
        print(f"{name}, stage {stage}\n{text}")
        failures += [f"stage {stage}: {row}" for row in rows if not row.passes]
    assert is_quick or not failures, failures
