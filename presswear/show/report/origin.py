"""Tables of where the numbers come from: parameters, conventions, versions, solver."""

from dataclasses import fields
from functools import partial

from presswear.results.result import SCHEMA, Result
from presswear.results.stage import StageResult
from presswear.scene.bearing import CONVENTIONS, Conventions
from presswear.scene.catalog import changes_of, named_scene
from presswear.scene.settings import Setting, settings_of
from presswear.show.report.parts import Table, stage_table
from presswear.tools.numbers import given, readable, whole
from presswear.tools.quantities import Choice

_CONVENTIONS = {item.name for item in fields(Conventions)}


def _value(setting: Setting) -> str:
    if setting.value is None:
        return "none"
    return given(setting.value) if isinstance(setting.value, int | float) else str(setting.value)


def _origin(setting: Setting) -> tuple[str, str]:
    """Unit and status of a setting; a choice has its allowed words instead."""
    meaning = setting.meaning
    if isinstance(meaning, Choice):
        return "", f"{'one of ' if meaning.words else ''}{', '.join(meaning.allowed())}"
    return meaning.unit.replace("^2", "²"), meaning.origin


def parameters(result: Result) -> Table:
    """Every value that a person can set, but the conventions."""
    rows = tuple(
        (setting.key, _value(setting), *_origin(setting), setting.meaning.text)
        for setting in settings_of(result.scene)
        if setting.key not in _CONVENTIONS
    )
    return Table(("key", "value", "unit", "status", "meaning"), (("", rows),), numeric=False)


def convention_set(chosen: Conventions) -> str:
    """Name of a set of conventions."""
    known = (f"the “{name}” set" for name, preset in CONVENTIONS.items() if chosen == preset)
    return next(known, "a set of its own")


def conventions(result: Result) -> Table:
    """Each convention, its choice and what it decides."""
    rows = tuple(
        (setting.key, _value(setting), " or ".join(setting.meaning.words), setting.meaning.text)
        for setting in settings_of(result.scene)
        if setting.key in _CONVENTIONS and isinstance(setting.meaning, Choice)
    )
    head = ("convention", "chosen", "can be", "which means, in that order")
    return Table(head, (("", rows),), numeric=False)


def provenance(result: Result) -> Table:
    """Versions, machine and time that the numbers come from."""
    origin = result.provenance
    packages = ", ".join(f"{name} {number}" for name, number in origin["packages"].items())
    rows = (
        ("engine", result.scene.engine),
        ("source revision", origin["revision"]),
        ("packages", packages),
        ("Python", origin["python"]),
        ("machine", origin["machine"]),
        ("started", origin["started"]),
        ("wall time", f"{readable(result.wall_s)} s"),
        ("schema of the result", str(SCHEMA)),
    )
    return Table(("", ""), (("", rows),), numeric=False)


def diagnostics(result: Result) -> Table:
    """Numbers and words of the solver on each stage."""
    keys = dict.fromkeys(key for stage in result.stages for key in stage.diagnostics)
    rows = {_spelled(key): partial(_diagnostic, key) for key in keys if key != "model"}
    return stage_table(result, "", {"": rows})


def _spelled(key: str) -> str:
    words = key.replace("_", " ")
    return f"{words[:-2]} (s)" if key.endswith("_s") else words


def _diagnostic(key: str, stage: StageResult) -> str:
    value = stage.diagnostics.get(key)
    if isinstance(value, str):
        return value
    return whole(value) if isinstance(value, int) else readable(value)


def changed_values(result: Result) -> tuple[str, Table | None]:
    """A sentence on what was changed, and the values beside what they were."""
    scene = result.scene
    base, changes = named_scene(scene), changes_of(scene)
    of = "the defaults" if base is None else f"the named scene {base.name}"
    if not changes:
        return f"Nothing differs from {of}.", None
    rows = tuple((own.key, own.value, own.was, own.unit, own.meaning) for own in changes)
    table = Table(("key", "value", "was", "unit", "meaning"), (("", rows),), numeric=False)
    return f"What differs from {of}:", table
