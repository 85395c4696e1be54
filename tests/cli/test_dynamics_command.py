"""``presswear dynamics``: results, exponents and diagrams from the command line."""

from pathlib import Path

import pytest

import presswear as pw
from presswear.__main__ import main


def test_modes_and_periods_of_a_result(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pw.run(pw.scenes.slider_crank(cycles=4), tmp_path / "run", engine="dae", jobs=1)
    assert main(["dynamics", str(tmp_path / "run")]) == 0
    output = capsys.readouterr().out
    for word in ("free flight", "impact", "sustained contact", "sticking", "no period within 1 %"):
        assert word in output


def test_an_exponent_and_a_diagram(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["dynamics", "slider-crank", "--exponent", "3"]) == 0
    assert "largest Lyapunov exponent" in capsys.readouterr().out
    line = ["dynamics", "slider-crank", "--over", "clearance=0.01:0.02:2 mm", "--cycles", "12"]
    line += [
        "--stored",
        "4",
        "--exponent",
        "0",
        "--orders",
        "2",
        "--jobs",
        "1",
        "--out",
        str(tmp_path / "d"),
    ]
    assert main(line) == 0
    assert "periodic at 2 of 2 values" in capsys.readouterr().out
    for name in ("diagram.png", "orders.png"):
        assert (tmp_path / "d" / name).stat().st_size > 10_000


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["slider-crnk"], "did you mean slider-crank"),
        (["slider-crank", "--exponent", "0"], "--exponent 0 needs --over"),
        (["slider-crank", "--orders", "4"], "--orders needs --over"),
        (["slider-crank", "--orders", "four"], "--orders four: must be a whole number"),
        (["slider-crank", "--over", "speed=1:2"], "FIRST:LAST:COUNT"),
        (["slider-crank", "--over", "speed=20:30:2 rad/s", "--stored", "100"], "stored = 100"),
        (["ideal"], "no motion is free"),
    ],
)
def test_bad_lines_end_in_one(
    words: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["dynamics", *words]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
