"""Recipe of CONTRIBUTING.md that steps through the equations in a debugger."""

import re
from pathlib import Path
from typing import Any

from python_process import python

ROOT = Path(__file__).parents[2]


def test_equations_of_a_four_bar_are_stepped_through(tmp_path):
    text = (ROOT / "CONTRIBUTING.md").read_text()
    _, _, rest = text.partition("**Stepping through the equations")
    recipe, _, _ = rest.partition("## Documentation")
    (script,) = re.findall(r"```python\n(.*?)```", recipe, re.DOTALL)
    commands = re.findall(r"\(Pdb\) ([^#\n]*)", recipe)
    (tmp_path / "step.py").write_text(script)

    def run_python(*arguments: str, typed: str = "") -> str:
        variables = {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": f"{ROOT}"}
        options: dict[str, Any] = {"input": typed, "cwd": tmp_path, "check": not typed}
        return python(*arguments, env=variables, **options).stdout

    run_python("-m", "presswear", "new", "four-bar")
    equations = run_python("-m", "presswear", "show", "four-bar.toml", "--equations")
    session = run_python("step.py", typed="\n".join([*commands, "quit"]))
    # The debugger shows the lines that the command prints, and enters the kernel.
    before, _, _ = equations.partition("cos_sin(coupler")
    line = 1 + before.count("\n")
    stop = rf"<equations \w+>\({line}\)equations\(\)\n-> coupler_cos, "
    assert re.search(stop, session)
    assert "rotation.py" in session
    assert re.search(r"\(Pdb\) (np\.float64\()?0\.\d+", session)
