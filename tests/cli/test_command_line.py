"""The commands as a person types them."""

import io
import json
import logging
import re
import shutil
import signal
import subprocess
import sys
import sysconfig
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from python_process import python

import presswear as pw
from presswear.__main__ import main
from presswear.campaign import runs
from presswear.cli import COMMANDS, scenes
from presswear.cli.parser import parser_for
from presswear.cli.terminal import logging_to_stderr
from presswear.results.folder import ResultFolder
from presswear.scene.files import example_file, scene_from
from presswear.scene.setting_list import applicable_settings_of
from presswear.show import report

Command = Callable[..., str]


def test_a_folder_of_several_runs_names_them(tmp_path, command):
    for key in ("a", "b", "c", "runs/d"):
        (tmp_path / key).mkdir(parents=True)
        (tmp_path / key / "result.json").touch()
    named = ", ".join(str(tmp_path / key) for key in "abc")
    message = command(f"replay {tmp_path} --still {tmp_path / 'a.png'}", 2)
    assert f"name one that it holds: {named}\n" in message


def test_list_names_scenes(command):
    lines = command("list").splitlines()
    assert [line.split()[0] for line in lines] == list(pw.scenes.SCENES)


def test_run_ideal_and_report(tmp_path, command):
    folder = tmp_path / "ideal"
    page = folder / "report.html"
    command(f"run ideal --cycles 1 --out {folder} --no-report")
    assert not page.exists()
    command(f"run ideal --resume --out {folder}")
    assert json.loads((folder / "result.json").read_text())["status"] == "completed"
    assert page.stat().st_size > 10_000
    assert "not empty" in command(f"run ideal --out {folder}", 2)


@pytest.mark.parametrize("is_verbose", [True, False])
def test_verbose_logs_the_stages(is_verbose, capsys):
    with logging_to_stderr(is_verbose):
        runs.run(replace(pw.scenes.ideal(), cycles=1, engine="dae"))
    lines = capsys.readouterr().err.splitlines()
    assert bool(lines) == is_verbose
    assert all(re.match(r"\d\d:\d\d:\d\d presswear(\.\w+)+: ", line) for line in lines)
    for words in ("stage 0 begins: no wear", "stage 0 ends: completed, 1 cycles")[
        : len(lines)
    ]:
        assert (
            len([line for line in lines if f".campaign.campaign: {words}" in line]) == 1
        )
    assert not logging.getLogger("presswear").handlers
    for words in ("-v list ideal", "list ideal --verbose", "list ideal"):
        arguments = parser_for(words.split()).parse_args(words.split())
        assert ("verbose" in arguments) == (words != "list ideal")


def test_all_settings_are_listed_in_groups(command):
    groups: dict[str, list[str]] = {}
    for line in command("list press-blanking --all").splitlines():
        if line.endswith(":"):
            keys = groups.setdefault(line[:-1], [])
        elif line:
            keys.append(line.split()[0])
    scene = pw.scenes.press_blanking()
    expected = sorted(setting.key for setting in applicable_settings_of(scene))
    assert sorted(key for keys in groups.values() for key in keys) == expected
    assert "length_3" in groups["Mechanism"]
    shorter = command("list press-blanking").splitlines()
    count = len(expected) - sum("  " in line for line in shorter)
    assert shorter[-1].startswith(f"{count} more with --all: ")


@pytest.mark.parametrize("name", ["", *COMMANDS])
def test_every_help_has_an_example(name, capsys):
    with pytest.raises(SystemExit) as ended:
        main([*name.split(), "--help"])
    assert ended.value.code == 0
    text = capsys.readouterr().out
    assert "example: presswear" in text
    with pytest.raises(SystemExit):
        main(["help", *name.split()] if name else [])
    assert capsys.readouterr().out == text


INTERRUPTED = """
import signal, sys
class Interrupts:
    def find_spec(self, name, *_):
        if name == %r:
            signal.raise_signal(signal.SIGINT)
sys.meta_path.insert(0, Interrupts())
from presswear.__main__ import main
sys.exit(main(["list"]))
"""


@pytest.mark.parametrize("module", ["numpy", "rich", "presswear.tools.errors"])
def test_interrupt_of_the_first_imports_is_no_traceback(module):
    ended = python("-c", INTERRUPTED % module)
    assert (ended.returncode, ended.stdout, ended.stderr) == (
        130,
        "",
        "presswear: interrupted\n",
    )


@pytest.mark.parametrize(
    "error",
    [
        MemoryError(),
        ImportError("_core.so: failed to map segment from shared object"),
        RuntimeError("can't start new thread"),
    ],
)
def test_memory_that_runs_out_is_one_line(error, monkeypatch, command):
    def listed(arguments: object, console: object) -> int:
        raise error

    monkeypatch.setattr(scenes, "list_scenes", listed)
    assert command("list", 1) == "presswear: memory ran out\n"


def test_interrupt_that_became_error(monkeypatch, command):
    def listed(arguments: object, console: object) -> int:
        try:
            signal.raise_signal(signal.SIGTERM)
        except KeyboardInterrupt:
            raise RuntimeError("Error calling __set_name__") from None
        return 0

    monkeypatch.setattr(scenes, "list_scenes", listed)
    assert command("list", 143) == "presswear: interrupted\n"
    monkeypatch.setattr(scenes, "list_scenes", lambda arguments, console: 1 // 0)
    with pytest.raises(ZeroDivisionError):
        command("list")


@pytest.mark.parametrize(("kind", "key"), [("press", "length_2"), ("points", "cycle")])
def test_a_new_file_is_listed_drawn_and_run(kind, key, tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    assert f"wrote {kind}.toml" in command(f"new {kind}")
    command(f"new {kind} mine.toml")
    written = Path("mine.toml").read_bytes()
    assert "mine.toml exists; name a new file" in command(f"new {kind} mine.toml", 2)
    assert Path("mine.toml").read_bytes() == written
    lines = command("list mine.toml").splitlines()
    keys = [line.split()[0] for line in lines if "  " in line]
    assert len(keys) == len(set(keys))
    assert {key, "clearance", "wear_updates"} <= set(keys)
    assert not {"exponent", "rows_per_cycle", "integrator"} & set(keys)
    command("show mine.toml --at 10ms")
    assert Path("mine.png").read_bytes().startswith(b"\x89PNG")
    equations = command("show mine.toml --equations")
    assert equations.startswith("def equations(")
    compile(equations, "mine.toml", "exec")
    options = "--engine dae --cycles 1 --wear-updates 0 --set replicates=1 --no-report"
    assert "results in out" in command(f"run mine.toml --out out {options}")


def test_a_run_is_resumed_without_the_files_that_it_started_with(
    tmp_path, monkeypatch, command
):
    """Its folder holds the mechanism and the text of the law, which --trust executes."""
    monkeypatch.chdir(tmp_path)
    law = "def soft(penetration):\n    return 1e7 * penetration\n"
    Path("laws.py").write_text(law)
    changed = 'wear_updates = 0\nnormal_law = "laws.py:soft"'
    Path("mine.toml").write_text(
        example_file("four-bar").replace("wear_updates = 1", changed)
    )
    scene = scene_from(Path("mine.toml"))
    with ResultFolder(Path("out"), scene) as folder:
        folder.interrupt()
    Path("laws.py").unlink()
    line = "run mine.toml --resume --out out --trust"
    resumed: list[pw.Scene] = []

    def run_into(store: ResultFolder, scene: pw.Scene, *more: object) -> None:
        resumed.append(scene)
        store.interrupt()

    monkeypatch.setattr(runs, "run_into", run_into)
    monkeypatch.setattr(report, "write_report", lambda *arguments, **options: "")
    assert "has changed" not in command(line)
    Path("laws.py").write_text(law)
    assert "has changed" not in command(line)
    text = Path("mine.toml").read_text()
    Path("mine.toml").write_text(text.replace("friction = 0.02", "friction = 0.1"))
    assert "mine.toml has changed: friction = 0.1, stored is 0.02." in command(line)
    Path("mine.toml").unlink()
    command(line)
    command("run out --resume --out out --trust")
    assert resumed == [scene] * 5
    assert "mine.toml: there is no such file" in command(f"{line} --cycles 3", 2)


def test_a_new_run_names_the_unfinished_one_before_it(tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    line = "run ideal --engine dae --cycles 1 --no-report"
    with ResultFolder(Path("results/ideal"), pw.scenes.ideal()) as folder:
        folder.interrupt()
    words = "results/ideal holds an unfinished run; continue with: presswear run ideal --resume"
    assert f"{words} --out results/ideal\n" in command(line)
    assert "unfinished" not in command(line)  # results/ideal-2 is complete
    assert Path("results/ideal-3").is_dir()


@pytest.mark.parametrize("line", ["list ideal", "--help", "--version"])
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no full device")
def test_a_full_standard_output_is_named_in_one_line(line, tmp_path):
    for unbuffered in ("", "1") if line == "list ideal" else ("",):
        environment = {"PYTHONUNBUFFERED": unbuffered}
        with Path("/dev/full").open("w") as full:
            pipes = {"capture_output": False, "stdout": full, "stderr": subprocess.PIPE}
            done = python("-m", "presswear", *line.split(), env=environment, **pipes)
        assert done.returncode == 2
        output = (
            "presswear: standard output cannot be written: No space left on device\n"
        )
        assert done.stderr == output


def test_a_terminal_without_a_character_shows_an_escape(tmp_path, monkeypatch):
    file = tmp_path / "mine.toml"
    file.write_text(
        example_file("four-bar").replace("My four-bar", "Ø 30 µm ±"), encoding="utf-8"
    )
    streams = {name: io.BytesIO() for name in ("stdout", "stderr")}
    for name, stream in streams.items():
        monkeypatch.setattr(sys, name, io.TextIOWrapper(stream, encoding="ascii"))
    line = ["run", f"{file}", "--out", f"{tmp_path / 'out'}", "--engine", "dae"]
    assert main([*line, "--no-report", "--set", "joints=none"]) == 0
    assert main([*line, "--no-report", "--set", "joints=µ"]) == 2
    sys.stderr.flush()
    assert rb"\xd8 30 \xb5m \xb1" in streams["stdout"].getvalue()
    assert rb"joints = '\xb5'" in streams["stderr"].getvalue()


def test_lives_are_compared_and_resumed(tmp_path, command):
    file = tmp_path / "four-bar.toml"
    out = tmp_path / "lives"
    command(f"new four-bar {file}")
    line = (
        f"life {file} --engine dae --cycles 1 --jobs 1 --until B.depth>2um --no-report"
    )
    line += " --tolerance 1 --set life.max_cycles=40 --set replicates=2"
    line += " --compare wear_coefficient=9e-13/Pa"
    first = command(f"{line} --out {out}")
    names = {path.parent.name for path in out.glob("*/result.json")}
    assert names == {"plain", "wear_coefficient=9e-13-Pa"}
    assert " times as long, longer with a probability of " in first
    assert first.startswith("each life needs at least about ")
    assert "plain: the life needs " in first
    assert "add --resume" in command(f"{line} --out {out}", 2)
    again = command(f"{line} --out {out} --resume")
    lines = [
        line for line in first.splitlines() if line.startswith(("plain: ", "wear_"))
    ]
    lines = [line for line in lines if "the life needs" not in line]
    assert len(lines) == 2
    assert all(line in again for line in lines)


def test_a_quick_life_has_two_rates(tmp_path, command):
    command(f"new four-bar {tmp_path / 'four-bar.toml'}")
    line = f"life {tmp_path / 'four-bar.toml'} --quick --cycles 3 --jobs 1 --until B.depth>8um"
    output = command(f"{line} --set replicates=2 --no-report --out {tmp_path / 'life'}")
    assert "quick life: " in output
    assert "without an interval: wear rates of the new surfaces" in output
    stored = json.loads((tmp_path / "life" / "result.json").read_text())["life"]
    assert (stored["ended"], stored["step"]) == ("quick", None)
    assert stored["message"].startswith("without an interval")


def test_dynamics_of_a_result_and_of_a_scene(tmp_path, command):
    pw.run(pw.scenes.slider_crank(cycles=4), tmp_path / "run", engine="dae", jobs=1)
    output = command(f"dynamics {tmp_path / 'run'}")
    for word in (
        "free flight",
        "impact",
        "sustained contact",
        "sticking",
        "no period within 1 %",
    ):
        assert word in output
    assert "largest Lyapunov exponent" in command("dynamics slider-crank --exponent 3")
    line = f"dynamics {tmp_path / 'run'} --over 'clearance=0.01:0.02:2 mm'"
    line += " --cycles 12 --exponent 0"
    output = command(f"{line} --jobs 1 --out {tmp_path / 'd'}")
    assert "periodic at 2 of 2 values" in output
    assert (tmp_path / "d" / "diagram.png").stat().st_size > 10_000


def test_final_motions_of_a_scene_over_a_parameter(tmp_path, command):
    line = f"dynamics settle slider-crank --starts 2 --cycles 20 --jobs 1 --out {tmp_path / 's'}"
    output = command(f"{line} --over 'speed=100:200:2 rad/s'")
    for speed in (100, 200):
        assert (
            f"speed = {speed} rad/s: none of 2 starts settled in 20 cycles: half-life"
            in output
        )
    lines = (tmp_path / "s" / "half-life.csv").read_text().splitlines()
    assert lines[0].startswith(
        "speed (rad/s),starts,settled,irregular,failed,half_life (cycles)"
    )
    assert [line.split(",")[:5] for line in lines[1:]] == [
        ["100.0", "2", "0", "2", "0"],
        ["200.0", "2", "0", "2", "0"],
    ]
    assert (tmp_path / "s" / "half-life.png").stat().st_size > 10_000
    again = command(f"{line} --over 'speed=100:200:2 rad/s' --resume")
    assert again == output


_TRY = """
source script.sh
complete -p presswear > registered
COMP_WORDS=("$@")
COMP_CWORD=$(( $# - 1 ))
_shtab_presswear presswear "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD-1]}"
echo "${COMPREPLY[@]}"
"""


@pytest.mark.skipif(shutil.which("bash") is None, reason="bash is missing")
def test_completion_of_commands_options_and_names(tmp_path, command):
    assert command("completion zsh").startswith("#compdef presswear\n")
    (tmp_path / "script.sh").write_text(command("completion bash"))
    (tmp_path / "first").mkdir()
    (tmp_path / "file.csv").touch()
    for line, words in {
        "r": {"run", "report", "replay"},
        "run wear": {"wear-times"},
        "run wear-times --con": {"--conventions"},
        "run wear-times --engine exudyn-": {"exudyn-tree", "exudyn-joints"},
        "report f": {"first"},
    }.items():
        call = ["bash", "-c", _TRY, "bash", "presswear", *line.split()]
        output = subprocess.run(
            call, cwd=tmp_path, capture_output=True, text=True, check=True
        )
        assert set(output.stdout.split()) == words, line
        assert not output.stderr


def test_files_of_the_user_are_no_modules(tmp_path):
    """Numba imports ``coverage`` where it finds it."""
    (tmp_path / "coverage").mkdir()
    (tmp_path / "statistics.py").write_text("raise SystemExit")
    program = Path(sysconfig.get_path("scripts")) / "presswear"
    options = "--engine dae --cycles 1 --wear-updates 0 --set replicates=2 --jobs 2 --no-report"
    command = [str(program), "run", "wear-times", *options.split()]
    ended = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
