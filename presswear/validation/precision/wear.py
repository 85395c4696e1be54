"""Wear against what it is computed with: angles, cycles, amplification, contact model.

Each is varied alone from the scene, under both sets of conventions; everything else, the
method included, stays as it is.
"""

import math
import time as clock
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, Literal

from presswear.campaign.campaign import run_campaign
from presswear.linkage.elements import SurfaceContact
from presswear.recording.sampling import LEAST_SAMPLES, Interval
from presswear.recording.tracker import Progress, Tracker
from presswear.results.stage import SIDES, StageResult
from presswear.scene.bearing import CONVENTIONS
from presswear.scene.scene import Scene
from presswear.tools.errors import InputError, RunFailed
from presswear.validation.runs import Told, part_of

Group = Literal["angles", "cycles", "jump", "contact", "method"]

TITLES: dict[Group, str] = {
    "angles": "angles of a wear map",
    "cycles": "cycles run for a wear",
    "jump": "how a wear is applied",
    "contact": "how worn surfaces meet",
    "method": "how the motion is integrated",
}
TOLERANCE = 1e-7
"""Tolerance of the in-house solver's DOPRI5, with which all runs are made; ``chaos`` says how
honest that is for wear."""


@dataclass(frozen=True)
class Means:
    """Values that are run under one set of conventions.

    Attributes
    ----------
    usual : int
        Cycles of each run where they are not what is varied.
    methods : tuple of str
        Names in METHODS.
    """

    angles: tuple[int, ...]
    cycles: tuple[int, ...]
    usual: int
    methods: tuple[str, ...] = ()


METHODS: dict[str, dict[str, Any]] = {
    "RK4, 1e-4 s (paper)": {"engine": "dae", "integrator": "rk4-paper"},
    "DOPRI5 of dae, 1e-7": {
        "engine": "dae",
        "integrator": "dopri5",
        "integration_tolerance": TOLERANCE,
    },
    "Exudyn, 1e-6": {"engine": "exudyn", "tree_tolerance": 1e-6},
}
"""Engine and numerics by name."""
PAPER_STEP, USUAL = tuple(METHODS)[:2]
QUICK = {
    "paper": Means((90, 360, 1440), (5, 10, 20), 10, (PAPER_STEP, USUAL)),
    "refined": Means((90, 360), (), 5),
}
FULL = {
    "paper": Means((90, 180, 360, 720, 1440), (5, 10, 20, 50, 100, 200), 50, tuple(METHODS)),
    "refined": Means((90, 180, 360, 720, 1440), (5, 10, 20, 50, 100), 20),
}


@dataclass(frozen=True)
class Varied:
    """The one thing that a way of computing the wear of a scene changes.

    Attributes
    ----------
    group : str
        Kind of change.
    conventions : str
        Name of the set.
    value : float or None
        Its value, where it is a number.
    is_default : bool
        True where the scene takes it by itself.
    """

    group: Group
    conventions: str
    label: str
    value: float | None
    is_default: bool


DEEPEST, VOLUME = "deepest wear", "worn volume"
QUANTITIES = {DEEPEST: "m", VOLUME: "m^3"}
"""Units of what one wear takes off a joint: the deepest place of bearing or pin, whichever is
deeper, and the volume of both."""
Wears = Mapping[str, Mapping[str, Interval]]
"""Quantities that a wear takes off, by joint."""


@dataclass(frozen=True)
class WearPoint:
    """The wear that one way of computing it gave.

    Attributes
    ----------
    first, second : Wears
        The first wear as it is applied, and what a second one would take off in a single
        jump; empty where it was not reached.
    steps : int
        Number in which the first wear was applied.
    cycles : int
        Cycles run in all.
    wall : float
        Wall time, warm-up apart, s.
    failure : str
        Why it failed, or nothing.
    """

    varied: Varied
    first: Wears = field(default_factory=dict)
    second: Wears = field(default_factory=dict)
    steps: int = 0
    cycles: int = 0
    wall: float = 0.0
    failure: str = ""


@dataclass(frozen=True)
class WearStudy:
    """Wear of a scene by what it is computed with.

    Attributes
    ----------
    points : tuple of WearPoint
        By group and conventions, from coarse to fine.
    usual : mapping of str to int
        Cycles of each run where they are not what is varied, by conventions.
    method : str
        The method that all ran with.
    """

    points: tuple[WearPoint, ...]
    usual: Mapping[str, int]
    method: str

    def of(self, group: Group, conventions: str) -> tuple[WearPoint, ...]:
        """The points that vary one thing under one set of conventions."""
        wanted = group, conventions
        return tuple(p for p in self.points if (p.varied.group, p.varied.conventions) == wanted)

    @property
    def conventions(self) -> tuple[str, ...]:
        """Names of the sets of conventions."""
        return tuple(dict.fromkeys(point.varied.conventions for point in self.points))

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints that wear."""
        return tuple(dict.fromkeys(joint for point in self.points for joint in point.first))

    @property
    def failed(self) -> dict[str, str]:
        """Why a point failed, by what it varies."""
        return {
            f"{p.varied.conventions}, {TITLES[p.varied.group]}: {p.varied.label}": p.failure
            for p in self.points
            if p.failure
        }


def change(here: Interval, there: Interval) -> Interval:
    """Relative difference of two independent numbers, with its interval."""
    if there.value == 0.0:
        return Interval(math.nan, None, None)
    ratio = here.value / there.value
    ends = [part for one in (here, there) for part in (one.low, one.high)]
    if None in ends or here.value == 0.0:
        return Interval(ratio - 1.0, None, None)
    widths = [0.5 * ((one.high or 0.0) - (one.low or 0.0)) / one.value for one in (here, there)]
    half = abs(ratio) * math.hypot(*widths)
    return Interval(ratio - 1.0, ratio - 1.0 - half, ratio - 1.0 + half)


def cases(scene: Scene, extent: Mapping[str, Means]) -> tuple[tuple[Varied, Scene], ...]:
    """All that is varied, from coarse to fine, with the scene that each runs.

    InputError where the scene has nothing that wears, or allows not every case.
    """
    if not scene.clearance_joints or scene.bearings.materials.wear_coefficient == 0.0:
        raise InputError(f"scene {scene.name}: nothing wears")
    found = []
    for name, means in extent.items():
        conventions = CONVENTIONS[name]
        varied = replace(scene, conventions=conventions, cycles=means.usual, wear_updates=1)
        base = with_method(varied, USUAL)
        bearings = base.bearings
        told: list[tuple[Group, str, float | None, bool, Scene]] = []
        for angles in means.angles:
            apart = {name: replace(own, angles=angles) for name, own in base.apart.items()}
            changed = replace(base, bearings=replace(bearings, angles=angles), apart=apart)
            told.append(("angles", f"{angles}", angles, angles == bearings.angles, changed))
        for cycles in means.cycles:
            changed = replace(base, cycles=cycles)
            told.append(("cycles", f"{cycles}", cycles, cycles == scene.cycles, changed))
        for word, label in (("single", "single jump"), ("steps", "cycle by cycle")):
            is_default = (word == "steps") == base.wears_in_steps
            changed = base if is_default else replace(base, extrapolation=word)
            told.append(("jump", label, None, is_default, changed))
        contacts: tuple[SurfaceContact, ...] = ("radial", "foundation")
        for contact in contacts:
            changed = replace(base, conventions=replace(conventions, contact=contact))
            told.append(("contact", contact, None, contact == conventions.contact, changed))
        for method in means.methods:
            told.append(("method", method, None, False, with_method(varied, method)))
        for group, label, value, is_default, changed in told:
            found.append((Varied(group, name, label, value, is_default), changed))
    return tuple(found)


def with_method(scene: Scene, name: str) -> Scene:
    """Take a scene from a few starts with a method of METHODS."""
    settings = dict(METHODS[name])
    engine = settings.pop("engine")
    numerics = scene.numerics.having(**settings)
    return replace(scene, engine=engine, replicates=LEAST_SAMPLES, numerics=numerics)


def joint_wears(stage: StageResult) -> Wears:
    """Material that the wear after a stage takes off each joint."""
    found = {}
    for name, numbers in stage.statistics.get("joints", {}).items():
        depths = {side: numbers.get(f"wear_depth_max_{side}_m", math.nan) for side in SIDES}
        side = max(depths, key=depths.__getitem__)
        low, high = numbers.get(f"wear_depth_max_{side}_interval_m") or (None, None)
        volume, half = numbers["wear_volume_m3"], numbers["wear_volume_half_width_m3"]
        ends = (None, None) if half is None else (volume - half, volume + half)
        found[name] = {VOLUME: Interval(volume, *ends)}
        # A stage that stood still says nothing of the deepest place of a wear cycle by cycle.
        if not math.isnan(depths[side]):
            found[name][DEEPEST] = Interval(depths[side], low, high)
    return found


class _Stages(Tracker):
    """Keeps the stages of a campaign and hands on which part of it is done."""

    def __init__(self, told: Callable[[float], None]) -> None:
        self.stages: list[StageResult] = []
        self._told = told

    def progress(self, progress: Progress) -> None:
        """Hand the part on."""
        self._told(progress.whole)

    def stage(self, stage: StageResult) -> None:
        """Keep a stage."""
        self.stages.append(stage)


def run_case(varied: Varied, scene: Scene, told: Callable[[float], None]) -> WearPoint:
    """Compute the wear of a scene; one that fails is a point as well."""
    tracker = _Stages(told)
    stages = tracker.stages
    began = clock.perf_counter()
    try:
        status, message, _ = run_campaign(scene, [tracker])
    except (InputError, RunFailed) as error:
        status, message = "failed", str(error)
    wall = clock.perf_counter() - began
    wear_updates = [joint_wears(stage) for stage in stages if not stage.failed]
    # A first wear that was not applied to its end is none.
    whole = wear_updates[: len(wear_updates) if status != "failed" or len(stages) > 1 else 0]
    first, second = (*whole, {}, {})[:2]
    steps = stages[0].wear_steps if stages else ()
    return WearPoint(
        varied,
        first,
        second,
        len(steps),
        sum(stage.cycles for stage in stages) + sum(own.cycles for own in steps[1:]),
        wall,
        message if status == "failed" else "",
    )


def vary(scene: Scene, extent: Mapping[str, Means], told: Told) -> WearStudy:
    """Run every case; what several groups have in common runs once."""
    wanted = cases(scene, extent)
    _warm_up(wanted)
    work = [_work(own) for _, own in wanted]
    known: list[tuple[Scene, WearPoint]] = []
    points = []
    for done, (varied, own) in enumerate(wanted):
        word = f"{varied.conventions}, {varied.group} {varied.label}"
        tell = partial(part_of(told, sum(work[:done]), work[done], sum(work)), word)
        tell(0.0)
        found = next((point for ran, point in known if ran == own), None)
        if found is None:
            found = run_case(varied, own, tell)
            known.append((own, found))
        points.append(replace(found, varied=varied))
    usual = {name: means.usual for name, means in extent.items()}
    return WearStudy(tuple(points), usual, f"dae, DOPRI5 at tolerance {TOLERANCE:g}")


def _work(scene: Scene) -> float:
    """Work of a case, roughly, in cycles on round surfaces."""
    assert scene.cycles is not None
    # Two stages on the surfaces of a jump, or those and a pass and a half between them.
    return scene.cycles * (4.0 if scene.wears_in_steps else 3.0)


def _warm_up(wanted: Sequence[tuple[Varied, Scene]]) -> None:
    """Compile everything that is timed later."""
    firsts = {varied.conventions: (varied, scene) for varied, scene in reversed(wanted)}
    for varied, scene in firsts.values():
        run_case(varied, replace(scene, cycles=1, extrapolation="single"), lambda part: None)
