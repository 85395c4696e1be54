"""``presswear verify``: what it compares, and that a miss is told."""

import math
from collections.abc import Iterator

import pytest

from presswear.__main__ import main
from presswear.engines.settings import InHouse
from presswear.tools.errors import RunFailed
from presswear.validation.verify import verify as module
from presswear.validation.verify.verify import Problem, Verified, impact_rows, stiff_limit, verify


def test_row_passes_up_to_its_bound() -> None:
    assert Verified.of("x", 1.0, 0.75, 0.25).passed
    assert not Verified.of("x", 1.0, 1.2500001, 0.25).passed
    assert not Verified.of("x", 1.0, math.nan, 0.25).passed


def test_limit() -> None:
    values = [5.0 + 3.0 * stiffness**-0.4 for stiffness in (1e3, 8e3)]
    assert stiff_limit(values, 8.0) == pytest.approx(5.0, rel=1e-14)


def test_everything_is_within_its_bound() -> None:
    told: list[tuple[str, float]] = []
    rows = verify(lambda name, part: told.append((name, part)))
    assert [row.quantity for row in rows if not row.passed] == []
    assert len({row.quantity for row in rows}) == len(rows) == 29
    assert [part for _, part in told] == sorted(part for _, part in told)
    assert told[-1] == ("done", 1.0)


def test_a_worse_engine_misses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "TIGHT", InHouse("rk4", equal_step=5e-6))
    missed = [row.quantity for row in impact_rows() if not row.passed]
    assert "restitution, nominal 0.9, dae" in missed
    assert "restitution, nominal 0.9, Exudyn, 50 steps" not in missed


def test_the_command_prints_a_table_that_fits_and_fails_on_a_miss(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    name = "restitution, nominal 0.8, Exudyn, 100 steps"
    rows = [Verified.of(name, -15.75637105984, -15.756371, 1e-3)]
    monkeypatch.setattr(module, "PROBLEMS", {"one": Problem(lambda: iter(rows), "")})
    assert main(["verify"]) == 0
    out = capsys.readouterr().out
    for words in (name, "-15.7563711", "pass", "1 of 1"):
        assert words in out
    assert max(len(line.rstrip()) for line in out.splitlines()) <= 100
    rows.append(Verified.of("bad", 1.0, 2.0, 0.1))
    assert main(["verify"]) == 1
    out = capsys.readouterr().out
    assert "MISS" in out
    assert "1 of 2" in out


def test_the_command_fails_when_a_run_fails(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def group() -> Iterator[Verified]:
        raise RunFailed("the step vanished (t = 0.1 s)")

    monkeypatch.setattr(module, "PROBLEMS", {"one": Problem(group, "")})
    assert main(["verify"]) == 1
    assert capsys.readouterr().err == "presswear: the step vanished (t = 0.1 s)\n"
