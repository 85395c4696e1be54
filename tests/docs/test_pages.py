"""Commands, names and links in the documentation exist."""

import ast
import inspect
import json
import re
import shlex
import tomllib
import unicodedata
from collections.abc import Iterator
from dataclasses import fields, replace
from importlib import import_module
from importlib.metadata import version
from itertools import takewhile
from pathlib import Path

import pytest
import speed
from columns import PAGE, filled
from lines import PAGES, TABLES, all_lines, lines_in_cells, lines_of
from public_names import NAMES, missing_names
from refusals import refused

import presswear as pw
from presswear.cli import COMMANDS
from presswear.cli.parser import parser_for, with_joined_command
from presswear.cli.terminal import parse_settings
from presswear.recording.columns import DRIVE_CYCLE
from presswear.results.life import LifeResult
from presswear.scene.settings import changed
from presswear.show import figures
from presswear.show.key_numbers import key_numbers
from presswear.show.limits import limit_lines

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
THEORY = sorted((DOCS / "theory").glob("*.md"))
TUTORIALS = sorted((DOCS / "tutorials").glob("*.md"))
PAGES_WITH_CODE = [page for page in PAGES if "```{code-cell}" in page.read_text()]
REFUSED = "clearence"  # a tutorial shows this mistake
COMMAND_LINES = [(page, line) for page in PAGES for line in lines_of(page.read_text())]


def test_commands_are_found():
    assert len({page for page, _ in COMMAND_LINES}) >= 10
    called = {line.split()[0] for _, line in COMMAND_LINES}
    assert {"run", "list", "life", "replay", "crosscheck", "export"} <= called


@pytest.mark.parametrize(
    "line",
    [
        pytest.param(line, id=f"{page.stem}: {line[:40]}")
        for page, line in COMMAND_LINES
    ],
)
def test_command_line_is_valid(line, tmp_path, monkeypatch):
    (tmp_path / "laws.py").write_text(TABLES["laws.py"])
    monkeypatch.chdir(tmp_path)
    words = list(takewhile(lambda word: word != ">", shlex.split(line, comments=True)))
    words = with_joined_command(words)
    arguments = parser_for(words).parse_args(words)
    scene = getattr(arguments, "scene", None)
    settings = getattr(arguments, "set", None)
    if scene not in pw.scenes.SCENES or not settings:
        return
    if REFUSED in line:
        with refused(REFUSED):
            changed(pw.scenes.SCENES[scene].make(), parse_settings(settings))
    else:
        changed(pw.scenes.SCENES[scene].make(), parse_settings(settings))


def test_nothing_is_installed_by_the_name_of_the_package():
    """It is not on PyPI; an extra is installed from the folder of the sources."""
    for file in [*PAGES, *(ROOT / "presswear").rglob("*.py")]:
        if file.name != "CHANGELOG.md":
            assert not re.search(
                r"pip install \S*presswear\b|presswear\[", file.read_text()
            ), file


def test_scripts_for_slurm_pass_the_cores_on():
    """``srun`` has not inherited ``--cpus-per-task`` since Slurm 22.05."""
    lines = [
        line
        for page in PAGES
        for line in re.findall(r"(?m)^srun .*$", page.read_text())
    ]
    assert lines
    assert all("--cpus-per-task=$SLURM_CPUS_PER_TASK" in line for line in lines)


def test_commands_in_prose_exist():
    for page in PAGES:
        for name in re.findall(r"`presswear ([a-z]+)", page.read_text()):
            assert name in {*COMMANDS, "help"}, f"{page.name}: presswear {name}"


@pytest.mark.parametrize("page", TUTORIALS, ids=lambda page: page.stem)
def test_all_commands_of_a_tutorial_are_in_cells(page):
    text = page.read_text()
    assert list(lines_of(text)) == lines_in_cells(text)


def test_the_build_runs_all_other_commands():
    ran = {line for lines in all_lines().values() for line in lines}
    ran |= {line for page in PAGES for line in lines_in_cells(page.read_text())}
    assert {line for _, line in COMMAND_LINES} <= ran
    assert all_lines()["help"]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_names_imported_by_a_page_exist(page, monkeypatch):
    for folder in (ROOT / "tests", ROOT / "tests" / "literature"):
        monkeypatch.syspath_prepend(folder)
    for cell in re.findall(
        r"(?s)```\{code-cell\} ipython3\n(?!%%)(.*?)```", page.read_text()
    ):
        for node in ast.walk(ast.parse(re.sub(r"^:tags.*\n", "", cell))):
            if isinstance(node, ast.ImportFrom) and node.module:
                module = import_module(node.module)
                assert all(hasattr(module, item.name) for item in node.names), (
                    node.module
                )


@pytest.mark.parametrize("page", TUTORIALS, ids=lambda page: page.stem)
def test_tutorial_links_to_its_notebook(page):
    """Jupytext needs the display name of the kernel."""
    text = page.read_text()
    links = re.findall(r"\{nb-download\}`[^<]+<(\w+)\.ipynb>`", text)
    assert links == ([page.stem] if "{code-cell}" in text else [])
    assert ("\n  display_name: Python 3\n" in text) is bool(links)


@pytest.mark.parametrize("page", PAGES_WITH_CODE, ids=lambda page: page.stem)
def test_stored_outputs_are_those_of_the_code_of_a_page(page):
    cells = re.findall(
        r"(?s)```\{code-cell\} ipython3\n(?::tags:.*?\n)?(.*?)```", page.read_text()
    )
    file = (
        DOCS / "_outputs" / "-".join(page.relative_to(DOCS).with_suffix(".ipynb").parts)
    )
    stored = json.loads(file.read_text())["cells"]
    assert ["".join(cell["source"]) for cell in stored] == [
        cell.strip() for cell in cells
    ]
    assert any(cell["outputs"] for cell in stored)


def test_the_report_of_the_study_is_on_the_site():
    """It is that of this version; ``python docs/_tools/findings.py`` stores it."""
    report = DOCS / "_outputs" / "paper-report.html"
    assert f'"_outputs/{report.name}"' in (DOCS / "conf.py").read_text()
    for page in ("index.md", "findings.md"):
        assert f'<a href="{report.name}">' in (DOCS / page).read_text()
    text = report.read_text()
    assert re.search(
        rf"presswear.paper, presswear {version('presswear')}, 20\d\d-\d\d-\d\d ", text
    )
    assert len(text) < 2_000_000
    assert not re.search(r"/(?:home|root|tmp|work|opt|usr)/", text)


def functions_named(page: Path) -> set[str]:
    return set(re.findall(r"`((?:[a-z_]+\.)+[A-Za-z_0-9]+)`", page.read_text()))


def is_module(path: Path) -> bool:
    """Return whether a file or a folder of the package can be imported."""
    return path.with_suffix(".py").exists() or (path / "__init__.py").exists()


@pytest.mark.parametrize("page", THEORY, ids=lambda page: page.stem)
def test_functions_named_in_the_theory_exist(page):
    for name in functions_named(page):
        if name.endswith(".md"):
            continue
        parts = name.split(".")
        while not is_module(ROOT / "presswear" / "/".join(parts)):
            parts.pop()
            assert parts, f"{page.name}: {name} does not exist"
        owner: object = import_module(f"presswear.{'.'.join(parts)}")
        for part in name.split(".")[len(parts) :]:
            assert hasattr(owner, part), f"{page.name}: {name} does not exist"
            owner = getattr(owner, part)


def test_theory_names_functions_of_every_room():
    named = {
        name.partition(".")[0] for page in THEORY for name in functions_named(page)
    }
    assert {"physics", "linkage", "recording", "campaign", "engines"} <= named


def test_sources_with_a_year_are_in_the_references():
    def plain(text: str) -> str:
        return unicodedata.normalize("NFD", text).encode("ascii", "ignore").decode()

    references = plain((DOCS / "theory" / "references.md").read_text()).split("\n- ")
    sources = [*(ROOT / "presswear").rglob("*.py"), *(DOCS / "theory").glob("*.md")]
    between = r"(?:,? (?:and|others|et al\.?|[A-Z]\w+|de)){0,7},? ?\(?"
    cited = {
        pair
        for source in sources
        for pair in re.findall(
            rf"([A-Z]\w\w+){between}((?:18|19|20)\d\d)\b", plain(source.read_text())
        )
    }
    listed = {
        pair
        for pair in cited
        for text in references
        if all(part in text for part in pair)
    }
    assert len(cited) > 20
    assert sorted(cited - listed) == []


def numbers_explained() -> str:
    """Return the first column of the table of numbers in a report."""
    page = (DOCS / "theory" / "index.md").read_text()
    table = page[page.index("| number in the report |") :]
    return "\n".join(re.findall(r"(?m)^\| ([^|]+) \|", table))


def test_key_numbers_of_a_report_have_a_formula():
    life = LifeResult("at_most", "", 1e6, None, None, 0.0, (), (), ())
    settings = {
        "conventions": "refined",
        "cycles": 4,
        "replicates": 2,
        "wear_updates": 0,
    }
    result = pw.run(pw.scenes.press_blanking(**settings, engine="dae"))
    names = {
        number.name
        for each in (result, replace(result, life=life))
        for number in key_numbers(each)
    }
    names |= {line.number.name for line in limit_lines(result.scene, result.stages[-1])}
    assert len(names) == 15
    assert [name for name in names if name not in numbers_explained()] == []


def test_rows_of_a_report_have_a_formula():
    """Names that a template fills in are left out; ``how-to/results.md`` has those of means."""
    file = ROOT / "presswear" / "show" / "templates" / "tables.toml"
    text = re.sub(r"(?s)\{%.*?%\}", "", file.read_text())
    content = tomllib.loads(re.sub(r"\{\{.*?\}\}", "…", text))
    names = "joints", "bottom", "tonnage", "elastic_pins", "drives", "growth", "motion"
    rows = [row for name in names for lines in content[name].values() for row in lines]
    rows += [
        row
        for name in ("endings", "limits", "wear_rates")
        for row in content["columns"][name]
    ]
    parts = {
        part.strip()
        for label, *_ in rows
        for part in re.split(r"…|, |: | \(|\)", label)
    }
    known = {part for part in parts if len(part) > 2}
    assert len(known) > 60
    assert [part for part in sorted(known) if part not in numbers_explained()] == []


def test_help_of_a_bearing_states_units_ranges_and_defaults():
    text = inspect.getdoc(pw.Bearing) or ""
    names = re.findall(r"(?m)^(\w+) : .*, default ", text)
    assert names == [item.name for item in fields(pw.Bearing)]
    assert "clearance : 0 to 1 m, default 0.0003\n    radial clearance" in text


def test_reference_lists_all_public_names():
    listed = re.findall(r"(?m)^   ([\w.]+)$", (DOCS / "api.md").read_text())
    assert sorted(listed) == sorted(NAMES)


def test_public_names_in_texts_exist():
    """Of pages, scenarios, and docstrings, messages and templates of the program."""
    made_up = missing_names("pw.Sceen(), pw.run(), pw.linkage.Body.")
    assert made_up == ["Sceen", "linkage.Body"]
    package = (ROOT / "presswear").rglob("*")
    files = [file for file in package if file.suffix in {".py", ".toml", ".html"}]
    files += [*PAGES, *(ROOT / "scenarios").glob("*.py")]
    wrong = {file: missing_names(file.read_text()) for file in files}
    assert {file: names for file, names in wrong.items() if names} == {}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_links_lead_to_existing_files(page):
    for target in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", page.read_text()):
        drawn = "_drawn" in target  # by the build, from docs/_tools/draw.py
        assert drawn or "://" in target or (page.parent / target).exists(), target


def texts(tree: ast.AST) -> Iterator[str]:
    """Yield the texts in a module; values in them are the character 0."""
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr):
            parts = [
                part.value if isinstance(part, ast.Constant) else "\0"
                for part in node.values
            ]
            yield "".join(map(str, parts))
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value


def test_files_named_for_contributors_exist():
    text = (ROOT / "CONTRIBUTING.md").read_text()
    names = set(re.findall(r"`([\w/.-]+\.(?:py|pyi|toml|md|html|json))`", text))
    written_by_readers = {"physics/interactions/NAME.py", "step.py"}
    names -= written_by_readers
    assert len(names) > 50
    packaged = ROOT / "presswear"
    missing = {
        name
        for name in names
        if not (ROOT / name).exists()
        and not (packaged / name).exists()
        and ("/" in name or not any(packaged.rglob(name)))
    }
    assert missing == set()


def test_messages_on_the_page_are_in_the_package():
    page = (DOCS / "how-to" / "messages.md").read_text()
    messages = re.findall(r"(?m)^\| `([^`]+)` \|", page)
    assert len(messages) >= 20
    sources = [path.read_text() for path in (ROOT / "presswear").rglob("*.py")]
    known = "\n".join(text for source in sources for text in texts(ast.parse(source)))
    for message in messages:
        for part in filter(None, re.split(r" ?…[:;,]? ?", message)):
            assert part in known, f"{message}: {part!r}"


# arrays of joints with different bins, elastic joints, and linkages with a motor
OF_OTHERS = {"J_angle", "stretch", "pin_stretch"}
OF_OTHERS |= {"clock", "nominal_rate", "drive_angle", "drive_speed"}


def test_arrays_on_the_page_are_those_of_a_stage():
    changes = {"drive_torque": "on", "sections": 2, "engine": "dae", "wear_updates": 0}
    stage = pw.run(pw.scenes.clearance_c(cycles=3, replicates=2, **changes)).stages[0]
    page = (DOCS / "how-to" / "results.md").read_text()
    rows = re.findall(r"(?m)^\| (`.+?) \| ([\w, ]+) \| .+ \| .+ \|$", page)
    sizes: dict[str, int] = {}
    listed = set()
    for names, shape in rows:
        for name in re.findall(r"`(\w+)`", names):
            if (array := stage.arrays.get(name.replace("J_", "C_"))) is None:
                assert name in OF_OTHERS or name.startswith("G_")
                continue
            listed.add(name.replace("J_", "C_"))
            for word, size in zip(shape.split(", "), array.shape, strict=True):
                expected = int(word) if word.isdigit() else sizes.setdefault(word, size)
                assert size == expected or word == "columns", f"{name}: {word}"
    assert listed == set(stage.arrays)


def test_numbers_of_each_cycle_on_the_page_are_those_that_are_declared():
    """``python docs/_tools/columns.py`` writes them."""
    page = PAGE.read_text()
    assert filled(page) == page
    assert page.count("| each drive |") == len(DRIVE_CYCLE)


def test_examples_of_the_reference_run(tmp_path, monkeypatch):
    """Every public name is in an example."""
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"(?s)```python\n(.*?)```", (DOCS / "api.md").read_text())
    code = "\n".join(blocks)
    exec(code, {})
    named = set(re.findall(r"\bpw\.([\w.]+)", code))
    assert set(NAMES) <= named
    assert any(name.startswith("scenes.") for name in named)
    assert "statistics.half_width" in named


def test_tables_of_speed_are_those_of_the_stored_measurements():
    """``python docs/_tools/speed.py fill`` writes them."""
    pages = [page.read_text() for page in speed.PAGES]
    assert [speed.filled(page) for page in pages] == pages
    marks = re.findall(r"<!-- speed: (\w+) -->", "".join(pages))
    assert sorted(marks) == sorted(speed.TABLES)


def test_names_of_the_figures_are_listed():
    for text in ((DOCS / "how-to" / "results.md").read_text(), pw.Result.plot.__doc__):
        assert set(figures.NAMES) <= set(re.findall(r"\w+", text or ""))
