"""Imports point downwards; names and docstrings are plain English."""

import ast
import re
import subprocess
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
TOP_LEVEL = {".ci", ".gitignore", "CHANGELOG.md", "CITATION.cff", "CONTRIBUTING.md"}
TOP_LEVEL |= {"LICENSE", "README.md", "docs", "presswear", "pyproject.toml"}
TOP_LEVEL |= {"scenarios", "tests"}
UPWARD = {("results", "show")}  # Result.plot and Result.report
BEGINNINGS = {"Of", "What", "Where", "Whether", "Which", "How", "Who", "That", "Those"}
# Calls of ``import_module``, which linters do not see, by file: their module is chosen at
# run time, slow to import, or above the file (``UPWARD``).
IMPORTED_BY_NAME = {
    "__init__.py": ["'importlib.metadata'", "'presswear.scene.catalog'"],
    "__main__.py": ["f'presswear.cli.{module}'"],
    "engines/settings.py": ["'presswear.engines.driver'", "self.module"],
    "physics/interactions/friction.py": ["f'presswear.physics.interactions.{name}'"],
    "results/frames.py": ["name"],
    "results/result.py": [
        "'presswear.show.figures'",
        "'presswear.show.notebook'",
        "'presswear.show.report'",
    ],
    "show/figures/__init__.py": ["_PYPLOT"],
    "sweeps/runner.py": ["module"],
    "tools/exudyn.py": ["'exudyn'"],
    "tools/kernel_compiler.py": ["'presswear.tools.constant_places'"],
    "tools/lazy_names.py": [
        "'presswear.tools.errors'",
        "'presswear.tools.serialize'",
        "f'{package}.{name}'",
        "f'{package}.{submodule}'",
        "modules[name]",
    ],
    "tools/processes.py": ["'presswear'", "name"],
}
NAMES = {"own", "told", "tell", "asked", "found", "known", "given", "other", "begun"}
NAMES |= {"taken", "kept", "gone", "apart", "borne", "felt", "bed", "look"}


@cache
def parsed(file: Path) -> ast.Module:
    return ast.parse(file.read_text())


def test_no_scratch_file_is_in_the_repository():
    command = ["git", "ls-files"]
    listed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True).stdout
    assert {Path(file).parts[0] for file in listed.decode().splitlines()} == TOP_LEVEL


def test_rooms_import_only_rooms_below_them():
    """Floors are those of the table in CONTRIBUTING.md."""
    floors: dict[str, int] = {}
    for line in (ROOT / "CONTRIBUTING.md").read_text().splitlines():
        if row := re.match(r"\| (\d+) \| (.*?) \|", line):
            rooms = re.findall(r"`presswear/(\w+)/`", row[2])
            floors |= dict.fromkeys(rooms, int(row[1]))
            if "`presswear/__init__.py`" in row[2]:
                floors[""] = int(row[1])
    assert max(floors.values()) <= 12
    assert set(floors) == {""} | {
        path.parent.name for path in ROOT.glob("presswear/*/__init__.py")
    }
    begin = r'(?:(?:from|import) presswear\b\.?|import_module\("presswear\.)(\w*)'
    for file in [*ROOT.glob("presswear/*/**/*.py"), *ROOT.glob("presswear/*/*.pyi")]:
        room = file.relative_to(ROOT).parts[1]
        for name in re.findall(begin, file.read_text()):
            is_below = name == room or floors.get(name, 99) < floors[room]
            assert is_below or (room, name) in UPWARD, f"{file}: {name}"


def test_imports_by_name_are_listed():
    calls: dict[str, list[str]] = {}
    package = ROOT / "presswear"
    for file in package.rglob("*.py"):
        for node in ast.walk(parsed(file)):
            if not isinstance(node, ast.Call):
                continue
            function = ast.unparse(node.func).split(".")[-1]
            if function in {"import_module", "__import__"}:
                name = str(file.relative_to(package))
                calls.setdefault(name, []).append(ast.unparse(node.args[0]))
    assert {name: sorted(each) for name, each in calls.items()} == IMPORTED_BY_NAME


@pytest.mark.parametrize(
    "room", sorted(path.name for path in (ROOT / "presswear").iterdir())
)
def test_names_and_docstrings_are_plain(room):
    path = ROOT / "presswear" / room
    wrong = []
    for file in [path] if path.is_file() else path.rglob("*.py"):
        if file.suffix not in {".py", ".pyi"}:
            continue
        for node in ast.walk(parsed(file)):
            if isinstance(node, ast.ClassDef | ast.FunctionDef | ast.Module):
                first = (ast.get_docstring(node) or "").split("\n")[0]
                if first.split(" ")[0] in BEGINNINGS or first.startswith("The same"):
                    wrong.append(f"{file}: {first}")
            name = node.arg if isinstance(node, ast.arg) else ""
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
                name = node.id
            if name in NAMES:
                wrong.append(f"{file}:{getattr(node, 'lineno', 0)}: {name}")
    assert not wrong


def test_kernels_make_no_array_and_raise_no_error():
    makers = {"zeros", "empty", "full", "ones", "array", "arange", "copy"}
    kernels = 0
    wrong = []
    for file in (ROOT / "presswear").rglob("*.py"):
        for function in ast.walk(parsed(file)):
            if not isinstance(function, ast.FunctionDef):
                continue
            decorators = map(ast.unparse, function.decorator_list)
            if not any(
                re.match(r"(lazily_)?compiled|inlined", decorator)
                for decorator in decorators
            ):
                continue
            kernels += 1
            for node in ast.walk(function):
                called = node.func if isinstance(node, ast.Call) else None
                is_maker = isinstance(called, ast.Attribute) and called.attr in makers
                if is_maker or isinstance(node, ast.Raise):
                    wrong.append(f"{file}:{function.lineno}: {function.name}")
    assert kernels > 100
    assert not wrong


def test_no_public_name_is_a_module_of_its_package():
    """After an import of the module, a function of the same name would be the module."""
    for stub in (ROOT / "presswear").rglob("__init__.pyi"):
        imports = re.findall(
            r"from presswear(\.[\w.]+)? import (\w+) as", stub.read_text()
        )
        names = {name for module, name in imports if module}
        modules = {file.stem for file in stub.parent.glob("*.py")}
        assert not names & modules, stub
