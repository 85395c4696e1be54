"""The recipe of CONTRIBUTING.md for a debugger, as it stands there."""

import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_equations_of_a_four_bar_are_stepped_through(tmp_path: Path) -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text()
    recipe = text[
        text.index("**Stepping through the equations") : text.index("## Documentation")
    ]
    (script,) = re.findall(r"```python\n(.*?)```", recipe, re.DOTALL)
    commands = re.findall(r"\(Pdb\) ([^#\n]*)", recipe)
    (tmp_path / "step.py").write_text(script)
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": f"{ROOT}"}
    new = [sys.executable, "-m", "presswear", "new", "four-bar"]
    subprocess.run(new, cwd=tmp_path, env=environment, check=True, capture_output=True)
    show = [sys.executable, "-m", "presswear", "show", "four-bar.toml", "--equations"]
    shown = subprocess.run(
        show, cwd=tmp_path, env=environment, check=True, capture_output=True, text=True
    )
    stepped = subprocess.run(
        [sys.executable, "step.py"],
        input="\n".join([*commands, "quit"]),
        cwd=tmp_path,
        env=environment,
        check=False,
        capture_output=True,
        text=True,
    ).stdout
    # The debugger shows the lines that the command prints, and enters the kernel.
    (line,) = [
        k
        for k, row in enumerate(shown.stdout.splitlines(), 1)
        if "cos_sin(coupler" in row
    ]
    assert re.search(
        rf"<equations \w+>\({line}\)equations\(\)\n-> coupler_cos, ", stepped
    )
    assert "rotation.py" in stepped
    assert re.search(r"\(Pdb\) (np\.float64\()?0\.\d+", stepped)
