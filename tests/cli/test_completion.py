"""The script for shells, as bash itself takes it."""

import shutil
import subprocess
from pathlib import Path

import pytest

from presswear.__main__ import main

_TRY = """
source script.sh
complete -p presswear > registered
COMP_WORDS=("$@")
COMP_CWORD=$(( $# - 1 ))
_shtab_presswear presswear "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD-1]}"
echo "${COMPREPLY[@]}"
"""


@pytest.mark.skipif(shutil.which("bash") is None, reason="bash is missing")
def test_bash_completes_commands_options_names_and_folders(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["completion", "bash"]) == 0
    (tmp_path / "script.sh").write_text(capsys.readouterr().out)
    (tmp_path / "first").mkdir()
    (tmp_path / "file.csv").touch()
    for line, words in {
        "r": {"run", "report", "replay"},
        "run wear": {"wear-times"},
        "run wear-times --con": {"--conventions"},
        "run wear-times --engine exudyn-": {"exudyn-tree", "exudyn-joints"},
        "report f": {"first"},
    }.items():
        command = ["bash", "-c", _TRY, "bash", "presswear", *line.split()]
        output = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
        assert set(output.stdout.split()) == words, line
        assert not output.stderr


def test_zsh_gets_a_script_of_its_own(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["completion", "zsh"]) == 0
    output = capsys.readouterr().out
    assert output.startswith("#compdef presswear\n")
    assert "life:'service life: strokes until a limit is exceeded, with an interval'" in output


def test_an_unknown_shell_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["completion", "bsh"]) == 2
    assert "unknown shell 'bsh'; did you mean bash?" in capsys.readouterr().err
