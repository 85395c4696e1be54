"""Bad input of sweeps: one line, exit code 2, and nothing is written."""

import shlex
from pathlib import Path

import pytest

from presswear.__main__ import main

# Options of ``presswear sweep wear-times``, and words of the message.
BAD_INPUT = r"""
--vary clearence=1mm | did you mean clearance
--vary clearance= | expected KEY=VALUES
--vary clearance=0.4,0.5 | clearance = '0.4' has no unit
--vary clearance=1mm:3m:4 | clearance = 3 m: allowed is
--vary engine=dae,exudyntree | did you mean exudyn-tree
--vary friction=0.1,0.1 | a value is repeated
--vary 'A.friction=0.1,0.2 & C.friction=0.1' | as many values of each key, got 2 and 1
--vary friction=0.1 --vary friction=0.2 | friction varies twice
--vary seed=1,2 --replicates 2 | cannot be combined
--vary length_3=0.1m,0.11m | no scene of this plan can be made
--vary friction=0:0.1:10000 --vary clearance=0.1mm:1mm:10000 | the plan has 100000000 rows
--sample sobol:8 | --sample and --range must be used together
--sample sobol --range friction=0:0.1 | expected KIND:SIZE
--sample sobel:8 --range friction=0:0.1 | did you mean sobol
--sample sobol:500 --range friction=0:0.1 | must be a power of two, 256 or 512
--sample morris:0 --range friction=0:0.1 | a size and a number of parameters of at least 1
--sample sobol:8 --range engine=dae | engine is not a number
--sample sobol:8 --range friction | expected KEY=DISTRIBUTION
--sample sobol:8 --range 'clearance=nromal(0.8mm, 0.05mm)' | did you mean normal
--sample sobol:8 --range clearance=0.8mm | expected a range such as
--sample sobol:8 --range 'clearance=normal(0.8mm)' | expected normal(MEAN, DEVIATION)
--sample sobol:8 --range 'clearance=normal(0.8, 0.05mm)' | has no unit
--sample sobol:8 --range 'clearance=normal(0.8mm, 0.5mm)' | of it lies outside the allowed range
--sample sobol:8 --range clearance=0.2mm:2m | allowed is
--sample sobol:8 --range clearance=1mm:0.2mm | the first end must be below the second
--sample sobol:8 --range 'clearance=lognormal(0.8mm, 0.5)' | a factor such as x1.6
--sample sobol:8 --range 'friction=lognormal(0, 50%)' | the median must be positive
--sample sobol:8 --range 'clearance=table(nowhere.csv)' | no such file
--vary clearance=1mm --response A.forcemax | did you mean A.force_max
--vary clearance=1mm --response B.depth | unknown response 'B.depth'
--vary clearance=1mm --response A.depth@3 | the stage must be 0 to wear_updates = 2
--vary clearance=1mm --response A.depth@x | NAME@STAGE
--vary clearance=1mm --response A.depth,A.depth | is repeated
--vary clearance=1mm --limit 'bdc_error<1mm' | expected RESPONSE>=VALUE or RESPONSE<=VALUE
--vary clearance=1mm --limit 'bdc_eror>=1mm' | did you mean bdc_
--vary clearance=1mm --limit 'A.force_max<=15' | has no unit
--vary clearance=1mm --limit 'bdc_error>=1mm' --limit 'bdc_error<=2mm' | already has a limit
--vary clearance=1mm --on dsk | MODULE:FACTORY
--vary clearance=1mm --on nowhere:Executor | nowhere
--vary clearance=1mm --on builtins:dict | dict is not an Executor
--vary clearance=1mm --on dask://nowhere | expected dask://HOST:PORT
--vary clearance=1mm --shard 3/2 | expected K/N
--vary clearance=1mm --replicates few | --replicates few
--vary clearance=1mm --replicates 10001 | replicates = 10001: must be 1 to 10000
--vary clearance=1mm --seed -1 | must be a whole number from 0
--vary clearance=1mm --keep most | allowed is one of responses, results
--vary clearance=1mm --set colour=red | unknown key 'colour'
--vary clearance=1mm --cycles 1 --set cycles=2 | cannot be combined
--resume | --resume needs the folder
--resume --out . | is not the folder of a sweep
"""


@pytest.mark.parametrize("case", ["| nothing varies", *BAD_INPUT.strip().splitlines()])
def test_bad_input_is_one_line_and_writes_nothing(
    case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    words, _, message = case.rpartition("| ")
    assert main(["sweep", "wear-times", *shlex.split(words)]) == 2
    line = capsys.readouterr().err
    assert line.startswith("presswear: ")
    assert line.count("\n") == 1
    assert message in line
    assert not list(tmp_path.iterdir())


FILE = '[sweep]\nscene = "wear-times"\nvary = ["clearance=0.4mm"]\nreplicates = 2\n'


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (FILE.replace("vary", "varry"), "unknown key of [sweep] in my.toml"),
        (FILE.replace("= 2", '= "2"'), "replicates"),
        (FILE.replace("wear-times", "wear-time"), "did you mean wear-times"),
        (FILE + '\n[mechanism]\nkind = "x"\n', "the file describes one"),
        ("sweep = 3\n", "a table is expected"),
    ],
)
def test_a_wrong_file_is_refused(
    text: str,
    message: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("my.toml").write_text(text)
    assert main(["sweep", "my.toml"]) == 2
    assert message in capsys.readouterr().err
