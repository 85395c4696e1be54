"""Hard cases: each is within its bounds or refused by name, and a miss is told."""

import math
from collections import Counter
from collections.abc import Iterator

import pytest

from presswear.__main__ import main
from presswear.engines.settings import InHouse
from presswear.linkage.laws import FrictionLaw
from presswear.tools.errors import InputError, RunFailed
from presswear.validation import hard
from presswear.validation.hard import bodies, hard_cases
from presswear.validation.hard.case import HardCase, energy_of, outcomes, ran, sound
from presswear.validation.runs import Check, guarded
from presswear.validation.verify.references import block
from presswear.validation.verify.verify import GRAVITY, TIGHT

CASES = list(hard_cases())
SLOW = (
    "deeper than c, radial",
    "deeper than c, foundation",
    "at rest, met at 0.14 mm/s",
    "pin at rest in the middle",
    "clearance at A alone",
    "100 cycles at 40 pi",
)
"""Cases of some ten seconds."""


def _marked(case: HardCase) -> object:
    marks = []
    if case.long or case.name in SLOW:
        marks.append(pytest.mark.slow)
    return pytest.param(case, id=f"{case.name}, {case.engine}", marks=marks)


@pytest.mark.parametrize("case", [_marked(case) for case in CASES])
def test_case_is_within_its_bounds_or_refused(case: HardCase) -> None:
    found = list(outcomes(case))
    told = [f"{o.message or o.check} {o.verdict}" for o in found if o.verdict == "MISS"]
    assert told == []
    assert found
    assert all((o.verdict == "refused") == bool(case.refusal) for o in found)


def test_names_differ() -> None:
    counts = Counter((case.name, case.engine) for case in CASES)
    assert [name for name, count in counts.items() if count > 1] == []


def test_a_worse_engine_misses(monkeypatch: pytest.MonkeyPatch) -> None:
    coarse = InHouse("rk4", equal_step=1e-5)
    found = list(bodies.strikes(coarse, 8e-4, 0.25, None, 0.9))
    assert [finding.passed for finding in found] == [False, False]


def test_a_law_that_is_off_misses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bodies, "ONSET_SPEED_FLOOR", 2e-6)
    assert not next(iter(bodies.strikes(TIGHT, 8e-4, 1e-6, 1e-10, 0.9))).passed
    monkeypatch.setattr(bodies, "FRICTION", FrictionLaw(0.1001, 1e-4, 1e-3))
    linkage, start = block(0.0, GRAVITY, FrictionLaw(0.1, 1e-4, 1e-3), 0.0)
    monkeypatch.setattr(bodies, "on_incline", lambda *arguments: (linkage, start))
    assert not next(iter(bodies.creeps(TIGHT, 0.05))).passed


def test_lost_energy_contacts_and_numbers_miss() -> None:
    plan = guarded(0.01)
    run = ran(*bodies.twins(), TIGHT, plan)
    sound(run, plan)
    run.diagnostics["drive_exchange_J"] = 1.0
    run.diagnostics["energy_residual_J"] = -1e-5
    assert not energy_of(run, "dae").passed
    assert energy_of(run, "exudyn-joints").passed
    with pytest.raises(RunFailed, match=r"ended at 0.01 s, not at 0.02 s"):
        sound(run, guarded(0.02))
    run.recorder.book.tally["unresolved"][1] = 1
    with pytest.raises(RunFailed, match="1 of 2 contacts unresolved"):
        sound(run, plan)
    run.recorder.rows[1, 2] = math.nan
    with pytest.raises(RunFailed, match="not finite: series"):
        sound(run, plan)


def _case(refusal: str = "", *, error: Exception | None = None, figure: float = 0.5) -> HardCase:
    def findings() -> Iterator[Check]:
        if error is not None:
            raise error
        yield Check("x", figure, 1.0)

    return HardCase("made up", "nothing", "none", findings, refusal)


@pytest.mark.parametrize(
    ("case", "verdict"),
    [
        (_case(), "pass"),
        (_case(figure=-1.0), "pass"),
        (_case(figure=-1.1), "MISS"),
        (_case(figure=math.nan), "MISS"),
        (_case(figure=math.inf), "MISS"),
        (_case(error=RunFailed("the step vanished")), "MISS"),
        (_case(error=ZeroDivisionError("division by zero")), "MISS"),
        (_case(error=InputError("c = 0 m: allowed is 1 to 2 m")), "MISS"),
        (_case("c = 0 m", error=InputError("c = 0 m: allowed is 1 to 2 m")), "refused"),
        (_case("c = 1 m", error=InputError("c = 0 m: allowed is 1 to 2 m")), "MISS"),
        (_case("c = 0 m", error=RunFailed("c = 0 m: the state ran away")), "refused"),
        (_case("c = 0 m", error=RunFailed("the step vanished")), "MISS"),
        (_case("c = 0 m"), "MISS"),
    ],
)
def test_verdicts(case: HardCase, verdict: str) -> None:
    assert [outcome.verdict for outcome in outcomes(case)] == [verdict]


def test_command_prints_the_table_and_fails_on_a_miss(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    cases = [_case(), _case("c = 0 m", error=InputError("c = 0 m: allowed is 1 to 2 m"))]
    monkeypatch.setattr(hard, "hard_cases", lambda: iter(cases))
    assert main(["verify", "--hard"]) == 0
    assert "refused" in capsys.readouterr().out
    cases.append(_case(figure=2.0))
    assert main(["verify", "--hard"]) == 1
    out = capsys.readouterr().out
    assert "MISS" in out
    assert "1 of 3 within their bounds, 1 refused by name, 1 missed" in out
    assert max(len(line.rstrip()) for line in out.splitlines()) <= 100
