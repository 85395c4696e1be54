"""Reference problems and hard cases: every check passes, and a miss is reported."""

import math
from collections import Counter
from collections.abc import Iterator
from typing import Any, cast

import hard_impacts
import pytest
from hard_case import HardCase, energy_check, outcomes, run_sound, sound
from hard_cases import hard_cases
from hard_press import law_cases, profile_cases, state_cases

import presswear as pw
from presswear.validation import cases, reference_problems

HARD = list(hard_cases())
REFERENCES = reference_problems.reference_cases()
SLOW = (  # some ten seconds each
    "deeper than c, radial",
    "deeper than c, foundation",
    "at rest, met at 0.14 mm/s",
    "pin at rest in the middle",
    "clearance at A alone",
    "100 cycles at 40 pi",
)
# 3 to 11 s; other engines run them always
SLOW_IN = {
    ("both joints touch at once", "exudyn-joints"),
    ("start in contact, 1e-06 m deep", "exudyn-joints"),
    ("start in contact, 1e-12 m deep", "exudyn-joints"),
    ("ce = 1", "dae"),  # equations without friction and without damping have one case
    ("c_f = 0", "dae"),
}
# The in-house engine runs every case of the press always, the tree these. Laws and friction
# run in the tree in test_laws_in_scenes, too.
PRESS = {
    case.name for make in (law_cases, profile_cases, state_cases) for case in make()
}
IN_TREE = {
    "E = 1 GPa",
    "c = 5 mm",
    "c = 1e-06 m",
    "c = 1e-09 m",
    "speed 40 pi",
    "hunt-crossley, ce = 0",
    "shallow notch, foundation",
    "all deeper than c, radial",
    "start in contact, 1e-12 m deep",
    "both joints touch at once",
    "rod as long as the crank",
}
TIGHT = reference_problems.TIGHT


def _marked(case: HardCase) -> object:
    is_in_tree = case.engine == "exudyn-tree" and case.name in PRESS
    is_slow = case.is_long or case.name in SLOW or (case.name, case.engine) in SLOW_IN
    is_slow |= is_in_tree and case.name not in IN_TREE
    marks = [pytest.mark.slow] if is_slow else []
    return pytest.param(case, id=f"{case.name}, {case.engine}", marks=marks)


@pytest.mark.parametrize("case", REFERENCES, ids=[case.name for case in REFERENCES])
def test_reference_is_met(case):
    results = list(cases.outcomes(case))
    assert results
    assert [f"{each.label} {each.check}" for each in results if not each.passed] == []


@pytest.mark.parametrize("case", [_marked(case) for case in HARD])
def test_case_is_within_its_bounds_or_refused(case):
    results = list(outcomes(case))
    assert results
    assert [
        f"{each.label} {each.check}" for each in results if each.verdict == "MISS"
    ] == []
    assert all((each.verdict == "refused") == bool(case.refusal) for each in results)


def test_cases_have_unique_names():
    counts = Counter((case.name, case.engine) for case in HARD)
    assert [name for name, count in counts.items() if count > 1] == []
    assert len(HARD) == 155


def test_a_worse_engine_misses(monkeypatch):
    coarse = pw.engines.InHouse("rk4", equal_step=5e-6)
    monkeypatch.setattr(reference_problems, "TIGHT", coarse)
    missed = [
        check.quantity
        for check in reference_problems.impact_checks()
        if not check.passed
    ]
    assert "restitution, nominal 0.9, dae" in missed
    assert "restitution, nominal 0.9, Exudyn, 50 steps" not in missed
    checks = hard_impacts.strikes(coarse, 8e-4, 0.25, 8e-4, 0.9)
    assert [check.passed for check in checks] == [False, False]


def test_lost_energy_contacts_and_numbers_miss():
    plan = cases.guarded(0.01)
    run = run_sound(*hard_impacts.twins(), TIGHT, plan)
    run.diagnostics["drive_exchange_J"] = 1.0
    run.diagnostics["energy_residual_J"] = -1e-5
    assert not energy_check(run, "dae").passed
    assert energy_check(run, "exudyn-joints").passed
    with pytest.raises(pw.RunFailed, match=r"ended at 0.01 s, not at 0.02 s"):
        sound(run, cases.guarded(0.02))
    run.recorder.records.counters["unresolved"][1] = 1
    with pytest.raises(pw.RunFailed, match="1 of 2 contacts unresolved"):
        sound(run, plan)
    run.recorder.rows[1, 2] = math.nan
    with pytest.raises(pw.RunFailed, match="not finite: series"):
        sound(run, plan)


def test_a_run_that_takes_too_long_is_stopped():
    plan = cases.guarded(1.0, patience=-1.0)
    with pytest.raises(pw.RunFailed, match=r"stopped after -1 s of CPU time at 20 %"):
        plan.report(0.2, cast(Any, None))
    cases.guarded(1.0, patience=60.0).report(0.2, cast(Any, None))


def test_the_order_is_the_slope():
    assert cases.order_of([0.1, 0.05, 0.01], [3e-2, 0.75e-2, 3e-4]) == pytest.approx(
        2.0
    )
    for steps, errors in (
        ((1, 2), [math.inf, 1e-6]),
        ((1, 2), [0.0, 1e-6]),
        ((1, 1), [1e-6] * 2),
    ):
        assert math.isnan(cases.order_of(steps, errors))


def _checks(error: Exception | None, value: float) -> Iterator[cases.Check]:
    if error is not None:
        raise error
    yield cases.Check("x", value, 1.0)


def _case(
    refusal: str = "", *, error: Exception | None = None, value: float = 0.5
) -> HardCase:
    return HardCase(
        "made up", "nothing", "none", lambda: _checks(error, value), refusal
    )


REFUSED = pw.InputError("c = 0 m: allowed is 1 to 2 m")


@pytest.mark.parametrize(
    ("case", "verdict"),
    [
        (_case(), "pass"),
        (_case(value=-1.0), "pass"),
        (_case(value=-1.1), "MISS"),
        (_case(value=math.nan), "MISS"),
        (_case(error=pw.RunFailed("the step vanished")), "MISS"),
        (_case(error=ZeroDivisionError("division by zero")), "MISS"),
        (_case(error=REFUSED), "MISS"),
        (_case("c = 0 m", error=REFUSED), "refused"),
        (_case("c = 1 m", error=REFUSED), "MISS"),
        (
            _case("c = 0 m", error=pw.RunFailed("c = 0 m: the state ran away")),
            "refused",
        ),
        (_case("c = 0 m", error=pw.RunFailed("the step vanished")), "MISS"),
        (_case("c = 0 m"), "MISS"),
    ],
)
def test_verdicts(case, verdict):
    assert [outcome.verdict for outcome in outcomes(case)] == [verdict]


def test_the_command_prints_the_cases_and_fails_on_a_miss(monkeypatch, command):
    monkeypatch.setenv("COLUMNS", "100")
    name = "restitution, nominal 0.8, Exudyn, 100 steps"
    checks = [cases.Check.against(name, -15.75637105984, -15.756371, 1e-3)]
    problems = [cases.Case("one", "", lambda: iter(checks))]
    monkeypatch.setattr(reference_problems, "reference_cases", lambda: problems)
    out = command("verify")
    assert all(words in out for words in (name, "-15.7563711", "pass", "1 of 1"))
    assert max(len(line.rstrip()) for line in out.splitlines()) <= 100
    error = pw.RunFailed("the step vanished (t = 0.1 s)")
    problems.append(cases.Case("two", "", lambda: _checks(error, 0.5)))
    problems.append(cases.Case("three", "", lambda: _checks(None, 2.0)))
    out = command("verify", 1)
    assert all(
        words in out for words in ("MISS", "1 of 3", "the step vanished (t = 0.1 s)")
    )
