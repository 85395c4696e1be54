"""Command lines that are refused in one line, with exit code 2."""

from collections.abc import Callable

import pytest

Command = Callable[..., str]

# Line, and the words that its message contains, separated by " & ".
BAD_INPUT = r"""
reprot nowhere: 'reprot'; did you mean report?
list nonsense: nonsense & ideal
run: scene
run nonsense: nonsense & wear-times
run x.toml: x.toml: there is no such file
run wear-times --set colour=red: unknown key 'colour'; presswear list SCENE --all shows all keys
run press.txt: press.txt: expected a scene of presswear list, a file NAME.toml, or a result
report /dev/null: /dev/null: it is not a folder
run .: .: expected a scene of presswear list
run six-bar: six-bar is a mechanism; write a file of it with: presswear new six-bar
run study.py: study.py is a Python script; run it with: python study.py
new: name the kind of mechanism: press, slider-crank, four-bar, six-bar, & link-drive, & points
run wear-times --set clearance 1mm: --set KEY=VALUE
run wear-times --cycels 5: --cycels 5; did you mean --cycles?
run wear-times --engine exudyntree: did you mean exudyn-tree?
run wear-times --clearance 1mm: use --set clearance=1mm
run wear-times clearance=0.5mm: --set clearance=0.5mm
run wear-times --jobs 0: --jobs 0: must be a whole number from 1 to 256
run wear-times --resume: --out
run wear-times --resume --out nowhere: --resume --out nowhere: there is no such folder
help rum: 'rum'; did you mean run?
sweep wear-times --wear-updates 0 --set wear_updates=1: --wear-updates and --set wear_updates
sweep wear-times --resume --out nowhere: --resume --out nowhere: there is no such folder
run wear-times --checkpoint soon: --checkpoint soon: must be a number of seconds
run wear-times --surfaces nowhere:1: nowhere: there is no such folder
run wear-times --surfaces here:two: here:two & a stage, 0, 1, 2 ...
run ideal --cycles 1 --set cycles=2: --cycles and --set cycles
run ideal --out '': --out & name is expected
run ideal --out /dev/null/x: /dev/null & not a folder
run ideal --set 'fric\ntion=1': fric\ntion
life press-blanking --until 'deth > 1 mm': deth & did you mean depth
life press-blanking --compare clearance=0.8mm: changes nothing
life press-blanking --conventions paper: wear_distribution & arc
life press-blanking --at-most 5 --set life.at_most=6: --at-most and --set life.at_most cannot be
life ideal: none has clearance
life press-blanking --readings nowhere.csv: nowhere.csv: there is no such file
life press-blanking --readings x.csv --materials: --readings & cannot be combined with
sweep wear-times 'speed=60 rpm': --set 'speed=60 rpm'
dynamics slider-crnk: did you mean slider-crank
dynamics slider-crank --exponent 0: --exponent 0 needs --over
dynamics slider-crank --cycles 60: --cycles needs --over
dynamics slider-crank --out here: --out needs --over
dynamics slider-crank --set engine=exudyn: engine = dae
dynamics slider-crank --engine exudyn: engine = dae
dynamics slider-crank --set wear_updates=1: no wear updates
dynamics slider-crank --over speed=1:2: FIRST:LAST:COUNT
dynamics slider-crank --over 'speed=20:30:2 rad/s' --stored 100: stored = 100
dynamics ideal: no motion is free
dynamics settle: SCENE|DIR & presswear dynamics settle --help
dynamics settle slider-crnk: did you mean slider-crank
dynamics settle ideal: need a joint with clearance: no motion is free
dynamics settle slider-crank --starts 0: --starts 0: must be a whole number from 1
dynamics settle slider-crank --cycles 5: cycles = 5: must be at least 12
dynamics settle slider-crank --set engine=exudyn: dynamics settle uses engine = dae
dynamics settle slider-crank --over clearance=1:2: FIRST:LAST:COUNT
dynamics settle slider-crank --set run_up=2: --set run_up=0
dynamics settle slider-crank --resume: --resume needs the folder
crosscheck nonsense: nonsense
crosscheck --duration nan: --duration nan
crosscheck --duration 1e300: --duration 1e+300 & 100 cycles
crosscheck --until 1: --until needs --against
crosscheck --against theirs.csv: needs the result folder
crosscheck . --against theirs.txt: .csv or .npz
crosscheck nowhere --against theirs.csv: nowhere: there is no such folder
crosscheck nowhere --against theirs.csv --set cycles=3: --set cannot be combined with --against
benchmark ideal: no clearance
benchmark --features --set joints=A: clearance at A and C
report nowhere: nowhere & no such folder
replay nowhere: nowhere: there is no such folder
replay nowhere --size one: --size one: must be WIDTHxHEIGHT
replay nowhere --size 10x10: 160 to 4096
new fourbar x.toml: unknown mechanism 'fourbar'; did you mean four-bar?
new press no/x.toml: no/x.toml cannot be written: No such file or directory
show wear-times --at 3: --at = '3' has no unit
show wear-times --out x.pdf: x.pdf: the name must end in .png
show wear-times --out no/x.png: there is no folder no
show ideal --equations: ideal: no equations & the drives hold every body
completion bsh: unknown shell 'bsh'; did you mean bash?
"""


@pytest.mark.parametrize("case", BAD_INPUT.strip().splitlines())
def test_bad_input_is_one_line_and_exit_code_2(case, tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    line, _, words = case.partition(": ")
    message = command(line.replace("\\n", "\n"), 2)
    assert message.startswith("presswear: ")
    assert all(part in message for part in words.split(" & "))
    assert list(tmp_path.iterdir()) == []
