"""``presswear run`` and ``life``: a scene, or its service life, into a result folder."""

import argparse
import logging
import sys
import time as clock
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager, nullcontext, suppress
from functools import partial
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.progress import Progress as ProgressBar

from presswear.cli import terminal
from presswear.linkage.laws import MATERIALS, listed_pair
from presswear.recording.observer import COMPILING, Observer, Progress
from presswear.recording.statistics import Estimate
from presswear.scene.catalog import title_of
from presswear.scene.files import SUFFIX
from presswear.scene.options import Life
from presswear.scene.plausible import doubts
from presswear.scene.scene import Scene
from presswear.scene.settings import SET, changed, changes_from, on_surfaces
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.files import name_for
from presswear.tools.numbers import counted, large, lasting, unit_scale
from presswear.tools.processes import check_stopped, cores

if TYPE_CHECKING:
    from presswear.results.life import LifeResult
    from presswear.results.result import Result
    from presswear.results.stage import StageResult

LOGGER = logging.getLogger(__name__)
OPTIONS = ("conventions", "engine", "cycles", "wear_updates", "tolerance")
LIVE_SIZE = (960, 640)  # of the window, pixels
LINE_INTERVAL = 60.0  # between lines with the progress where there is no terminal, s
LONG_LIFE = 600.0  # s, from which a user is asked before a service life goes on
BAR_DELAY = 3.0  # of the bar of a run in Python, s
SHOWN_JOINTS = 3  # in the lines of a stage
WEAR_UPDATES = "2"  # stages through the life of a scene that does not specify them
LIFE = "life,"  # start of the description of a step that follows a service life


def has_no_options(arguments: argparse.Namespace) -> bool:
    """Return whether no option changes the scene."""
    values = (arguments.surfaces, *(getattr(arguments, key) for key in OPTIONS))
    return not arguments.set and all(value is None for value in values)


def with_options(scene: Scene, arguments: argparse.Namespace, **more: Any) -> Scene:
    """Return the scene changed by the options, and by ``more`` settings; checked."""
    options = {key: getattr(arguments, key) for key in OPTIONS} | more
    settings = terminal.parse_settings(arguments.set)
    scene = changed(scene, terminal.merge_options(settings, options))
    if arguments.surfaces is not None:
        from presswear.results.result import read_surfaces

        scene = on_surfaces(
            scene, read_surfaces(arguments.surfaces), arguments.surfaces
        )
    scene.check()
    return scene


def run(arguments: argparse.Namespace, console: Console) -> int:
    """Run a scene into its result folder."""
    change = (
        None
        if has_no_options(arguments)
        else partial(with_options, arguments=arguments)
    )
    return run_scene(arguments, console, change)


def run_scene(
    arguments: argparse.Namespace,
    console: Console,
    change: Callable[[Scene], Scene] | None,
) -> int:
    """Run or resume a scene, write its report, and return the exit code.

    ``change`` applies the options; without options a resumed run uses its stored scene
    and needs no scene file.
    """
    terminal.check_resume(arguments.resume, arguments.out)
    is_stored = arguments.resume and (arguments.out / "result.json").exists()
    if is_stored and change is None:
        scene, remarks = _stored_scene(arguments)
    else:
        remarks = []
        scene = terminal.load_scene(arguments.scene)
        scene = scene if change is None else change(scene)
    name = f"{scene.name}-life" if scene.life else scene.name
    folder = arguments.out or terminal.free_folder(name)
    unfinished = None if arguments.out else terminal.unfinished_folder(name)
    from presswear.campaign.campaign import run_into, workers_of
    from presswear.campaign.wear_histories import fewest_cycles_of
    from presswear.results.folder import ResultFolder
    from presswear.results.result import load

    window: Any = nullcontext()
    if getattr(arguments, "live", False):
        from presswear.show.replay.output import Live

        window = closing(Live(scene, LIVE_SIZE))
    with window as live:
        store = ResultFolder(folder, scene, arguments.checkpoint, arguments.resume)
        warnings = [f"warning: {doubt}" for doubt in doubts(scene)]
        terminal.print_lines(
            console, title_of(scene), *warnings, *store.remarks, *remarks
        )
        if scene.life and not (scene.is_quick or store.is_finished or store.resumed):
            terminal.print_lines(
                console, f"the life {_least_need(fewest_cycles_of(scene))}"
            )
        if unfinished:
            advice = terminal.resume_command(arguments, unfinished, scene)
            terminal.print_lines(
                console, f"{unfinished} holds an unfinished run; {advice}"
            )
        if store.is_finished:
            terminal.print_lines(console, f"the run in {folder} is already complete")
        command = terminal.resume_command(arguments, folder, scene)
        try:
            with (
                terminal.resumable(command, folder, lambda: store.stored_part),
                terminal.progress_bar(console) as bar,
            ):
                shown = RunObserver(bar, scene, arguments.yes)
                observers = [shown, *([live] if live else [])]
                with workers_of(
                    scene, arguments.jobs, observers, store.interval
                ) as workers:
                    if workers.count > 1 and not (
                        arguments.no_report or store.is_finished
                    ):
                        Thread(
                            target=_prepare_report, args=(scene,), daemon=True
                        ).start()
                    run_into(store, scene, observers, workers)
        except InputError as error:
            raise InputError(f"{arguments.scene}: {error}") from None
    return _finish(load(folder), arguments, console)


def _finish(result: "Result", arguments: argparse.Namespace, console: Console) -> int:
    """Write the report of a stored run, print what it tells at the end, return the exit code."""
    from presswear.results.contact_warnings import contact_warnings

    folder = result.path
    readings = getattr(arguments, "readings", None)
    if readings is not None and folder is not None:
        from presswear.results.readings import store_readings

        store_readings(folder, readings)
    if arguments.no_report:
        terminal.print_lines(console, f"results in {folder}")
    else:
        from presswear.show.report import write_report

        with console.status("drawing the figures") as line:
            report = write_report(
                result,
                lambda count: line.update(f"drawing {count} figures"),
                has_all_figures=False,
            )
        terminal.print_lines(console, f"results in {folder}, report in {report}")
    terminal.print_lines(console, *contact_warnings(result.scene, result.stages))
    if result.status == "failed":
        raise RunFailed(result.message)
    if result.status == "unconverged":
        terminal.print_lines(console, f"not converged: {result.message}")
    if readings is not None:
        from presswear.results.remaining_life import remaining_life

        terminal.print_lines(console, *remaining_life(result, readings).lines)
    return 0


def _prepare_report(scene: Scene) -> None:
    """Import and compile what the report needs, while other processes run the scene."""
    with suppress(Exception):  # the report itself tells of a problem
        from presswear.show.report import prepare

        prepare(scene)


def _stored_scene(arguments: argparse.Namespace) -> tuple[Scene, list[str]]:
    """Return the scene of the folder, and a remark if the scene that is named has changed."""
    from presswear.results.result import stored_scene

    scene, _ = stored_scene(arguments.out)
    if arguments.trust:
        scene.trust()
    if Path(arguments.scene) == arguments.out:
        return scene, []
    if scene.name != Path(arguments.scene).name.removesuffix(SUFFIX):
        raise InputError(
            f"--out {arguments.out}: it holds a run of {scene.name}, not of {arguments.scene}"
        )
    with suppress(InputError):  # the file may be gone
        changes = changes_from(scene, terminal.load_scene(arguments.scene))
        # An option of the command that started the run is no change of the file.
        one = next(
            (each for each in changes if scene.origins.get(each.key) != SET), None
        )
        if one is not None:
            unit = f" {one.unit}".rstrip()
            text = f"{arguments.scene} has changed: {one.key} = {one.value}{unit}, stored is "
            text += f"{one.was}{unit}. The stored scene is run. For a new run omit --resume and "
            return scene, [f"{text}--out"]
    return scene, []


class RunObserver(Observer):
    """Observer that shows the progress of a run and prints each finished stage."""

    def __init__(
        self, bar: ProgressBar, scene: Scene, is_confirmed: bool = True
    ) -> None:
        self._bar = bar
        self._scene = scene
        self._is_confirmed = is_confirmed
        self._compile_time = 0.0  # within this stage, s
        self._compiled = 0.0  # of all stages, s, with the time before the first report
        self._compile_start: float | None = None
        # completed part at the first report, of a resumed run
        self._start: float | None = None
        self._task = bar.add_task(step_text(scene, 0, ""), total=1.0)
        self._printed = clock.perf_counter()

    def on_progress(self, progress: Progress) -> None:
        """Update the progress bar; raise KeyboardInterrupt after a signal.

        The time in which kernels are compiled does not count as computing time.
        """
        if progress.word == COMPILING:
            self._compile_start = self._compile_start or clock.perf_counter()
            self._bar.update(self._task, description="compiling, once")
            return
        check_stopped()
        text = step_text(self._scene, progress.stage, progress.word)
        if self._compile_start is not None:
            took = clock.perf_counter() - self._compile_start
            self._compiled += took
            # The time of a stage does not include the wear update after it.
            if not text.startswith("applying"):
                self._compile_time += took
            self._compile_start = None
        done = progress.whole
        share = progress.estimate or progress.whole
        if self._start is None:
            self._start, self._compiled = share, clock.perf_counter() - self._printed
        fields: Any = {"idle": self._compiled, "share": share, "start": self._start}
        self._bar.update(self._task, description=text, completed=done, **fields)
        if self._bar.disable and clock.perf_counter() > self._printed + LINE_INTERVAL:
            self._printed = clock.perf_counter()
            left = terminal.time_left(self._bar.tasks[self._task])
            terminal.print_lines(
                self._bar.console, f"{text}, {100.0 * done:.0f} % {left}".rstrip()
            )

    def on_life_start(self, cycles: float, seconds: float) -> None:
        """Print what a life will take; ask a user at a terminal before a long one."""
        terminal.print_lines(self._bar.console, f"the life {_need(cycles, seconds)}")
        started = clock.perf_counter()
        if not self._is_confirmed:
            _confirm(self._bar, seconds)
        self._compiled += clock.perf_counter() - started

    def on_life(self, life: "LifeResult") -> None:
        """Print the service life."""
        terminal.print_lines(self._bar.console, f"{life}")
        self._compile_time = 0.0  # it belongs to no stage

    def on_stage(self, stage: "StageResult") -> None:
        """Print the cost of a stage, and peak forces and wear of the joints most loaded."""
        model = stage.diagnostics["model"]
        solver = stage.diagnostics["solver"]
        LOGGER.info("%s: %s. %s", stage.name, model, solver)
        wall = stage.wall_s - self._compile_time
        speed = wall / stage.simulated_s if stage.simulated_s > 0.0 else float("nan")
        cycles = f"{counted(stage.statistics.cycles, 'cycle')} of all replicates"
        lines = [f"{stage.name}: {cycles}, {speed:.2f} s per simulated second"]
        joints = stage.statistics.joints.items()
        forces = {name: joint.peak_force_per_cycle for name, joint in joints}
        per_million = 1e6 / stage.cycles_per_update
        volumes = {
            name: joint.wear_volume.scaled(per_million)
            for name, joint in joints
            if not joint.is_unworn
        }
        lines += _largest("mean peak force", "N", forces)
        wear = _largest("wear per 10⁶ strokes", "m^3", volumes)
        remark = self._scene.bin_remark
        lines += [f"{line} ({remark})" if remark else line for line in wear]
        terminal.print_lines(self._bar.console, *lines)
        self._compile_time = 0.0


def _need(cycles: float, seconds: float) -> str:
    """Return what a life will still take, in words."""
    count = large(cycles, digits=2)
    return f"needs about {count} cycles of all replicates, {lasting(seconds)} more"


def _least_need(cycles: float) -> str:
    """Return what a life takes at least, in words, before anything has run."""
    count = large(cycles, digits=1)
    text = f"needs at least about {count} cycles of all replicates"
    return f"{text}; after its first strokes follow a closer number and the time"


def _confirm(bar: ProgressBar, seconds: float) -> None:
    """Ask a user at a terminal before a long life goes on; KeyboardInterrupt if it does not."""
    if not (bar.console.is_terminal and sys.stdin.isatty()) or seconds <= LONG_LIFE:
        return
    bar.stop()
    answer = input("continue? [y/N] (--yes: do not ask) ")
    if answer.strip().lower() not in ("y", "yes"):
        raise KeyboardInterrupt
    bar.start()


@contextmanager
def late_bar(scene: Scene) -> Iterator[Observer]:
    """Yield an observer that shows a progress bar while a run lasts, after a few seconds."""
    bar = terminal.progress_bar(Console(stderr=True))
    bar.live.transient = True
    inner = RunObserver(bar, scene)
    start = clock.perf_counter()

    class Late(Observer):
        def on_progress(self, progress: Progress) -> None:
            inner.on_progress(progress)
            if clock.perf_counter() > start + BAR_DELAY:
                bar.start()

    try:
        yield Late()
    finally:
        bar.stop()


def _largest(words: str, unit: str, values: dict[str, Estimate]) -> list[str]:
    """Return a line with the largest of the values of joints; none if all are zero."""
    names = sorted(values, key=lambda name: -values[name].mean)
    if not names or not values[names[0]].mean:
        return []
    factor, display = unit_scale(unit, values[names[0]].mean)
    texts = [f"{name} {values[name].scaled(factor)}" for name in names[:SHOWN_JOINTS]]
    more = f", {len(names) - SHOWN_JOINTS} more" if len(names) > SHOWN_JOINTS else ""
    return [f"  {words}, {display}: {', '.join(texts)}{more}"]


def step_text(scene: Scene, stage: int, step: str) -> str:
    """Return a description of the present step of a run, from ``Progress.word``."""
    if step.startswith(LIFE):
        return step
    if step.startswith(scene.stage_name(stage + 1)):
        return f"applying the {step}"
    name = f"after the {scene.stage_name(stage)}" if stage else scene.stage_name(stage)
    return f"{name}: {step}" if step else name


def life(arguments: argparse.Namespace, console: Console) -> int:
    """Run a service life, or compare several."""
    change: Callable[[Scene], Scene] = partial(_with_life, arguments=arguments)
    if arguments.readings is not None:
        change = partial(_with_readings, arguments=arguments)
    if arguments.replace or arguments.turn or arguments.compare or arguments.materials:
        return _compare(
            change(terminal.load_scene(arguments.scene)), arguments, console
        )
    is_plain = has_no_options(arguments) and not (arguments.until or arguments.quick)
    is_plain = is_plain and arguments.at_most is None
    is_resumed = arguments.resume and arguments.out is not None
    is_folder = (Path(arguments.scene) / "result.json").exists()
    if arguments.readings is not None and is_plain and is_folder:
        result = terminal.load_result(Path(arguments.scene), console)
        from presswear.results.remaining_life import remaining_life

        remaining_life(result, arguments.readings)  # nothing is stored if it is wrong
        return _finish(result, arguments, console)
    return run_scene(arguments, console, None if is_plain and is_resumed else change)


def _with_life(scene: Scene, arguments: argparse.Namespace) -> Scene:
    """Return the scene with the life and the defaults of this command."""
    specified = {key for key, origin in scene.origins.items() if origin.startswith(SET)}
    specified |= terminal.parse_settings(arguments.set).keys()
    wear = {"conventions", "wear_distribution", "contact"}
    if arguments.conventions is None and not specified & wear:
        scene = changed(scene, {"conventions": "refined"})
    is_open = arguments.wear_updates is None and "wear_updates" not in specified
    if is_open and (arguments.quick or scene.wear_updates == 0):
        scene = changed(
            scene, {"wear_updates": "1" if arguments.quick else WEAR_UPDATES}
        )
    limits = ", ".join(arguments.until) or None
    life = {"life": Life.kind, "life.until": limits, "life.at_most": arguments.at_most}
    life["life.quick"] = "on" if arguments.quick else None
    return with_options(scene, arguments, **life)


def _with_readings(scene: Scene, arguments: argparse.Namespace) -> Scene:
    """Return the scene with the life of this command, checked for the readings."""
    from presswear.results.readings import read_readings
    from presswear.results.remaining_life import check_for_life

    if arguments.replace or arguments.turn or arguments.compare or arguments.materials:
        raise InputError(
            "--readings is of one life: it cannot be combined with --replace, --turn, "
            "--compare or --materials"
        )
    readings = read_readings(arguments.readings)
    scene = _with_life(scene, arguments)
    check_for_life(scene, readings)
    return scene


def _variants(scene: Scene, arguments: argparse.Namespace) -> dict[str, dict[str, str]]:
    """Return the settings of the lives to compare with, by label."""
    variants = {
        f"bush replaced: {each}": {"life.replaced": each} for each in arguments.replace
    }
    variants |= {
        f"bush turned: {each}": {"life.turned": each} for each in arguments.turn
    }
    variants |= {
        each: terminal.parse_settings(each.split(",")) for each in arguments.compare
    }
    for joint in scene.loose_pins if arguments.materials else ():
        for name in MATERIALS:
            if name != listed_pair(scene.bearing(joint).materials):
                variants[f"{joint}.materials={name}"] = {f"{joint}.materials": name}
    return variants


def _compare(scene: Scene, arguments: argparse.Namespace, console: Console) -> int:
    """Run the life of a scene and of its variants, and print all of them."""
    from presswear.campaign.campaign import run_scenes
    from presswear.campaign.wear_histories import fewest_cycles_of
    from presswear.results.life import life_ratio

    scenes = {"plain": scene}
    for label, settings in _variants(scene, arguments).items():
        variant = changed(scene, settings)
        if variant.modelled() == scene.modelled():
            raise InputError(
                f"{label}: changes nothing, so there is nothing to compare"
            )
        scenes[name_for(label)] = variant
    folder = terminal.output_folder(arguments, "lives")
    if not scene.is_quick:
        terminal.print_lines(
            console, f"each life {_least_need(fewest_cycles_of(scene))}"
        )
    with _several_runs(console, "lives", folder, len(scenes)) as (show, bar):
        together = min(arguments.jobs or cores(), len(scenes))
        announce = _announcing(bar, len(scenes) / together, arguments.yes)
        results = run_scenes(scenes, folder, None, arguments.jobs, show, announce)
    plain = results["plain"].life
    for name, result in results.items():
        life = result.life
        line = result.message if life is None else f"{life}"
        if life is not None and plain is not None and name != "plain":
            ratio, longer = life_ratio(life, plain)
            if ratio:
                line = f"{ratio} times as long, longer with a probability of {longer}; {line}"
        terminal.print_lines(console, f"{name}: {line}")
    terminal.print_lines(
        console, f"results in {folder}; presswear report FOLDER writes a report"
    )
    return 0


def _announcing(
    bar: ProgressBar, turns: float, is_confirmed: bool
) -> Callable[[str, float, float], None]:
    """Return a function for ``run_scenes`` that prints what each of several lives will take.

    All of them take about ``turns`` times as long as one. A user at a terminal is asked
    once.
    """
    has_answer = is_confirmed

    def announce(name: str, cycles: float, seconds: float) -> None:
        nonlocal has_answer
        whole = turns * seconds
        words = f"{name}: the life {_need(cycles, seconds)}; all lives take about {lasting(whole)}"
        terminal.print_lines(bar.console, words)
        if not has_answer and whole > LONG_LIFE:
            has_answer = True
            _confirm(bar, whole)

    return announce


@contextmanager
def _several_runs(
    console: Console, name: str, folder: Path, count: int
) -> Iterator[tuple[Callable[[str, float, str], None], ProgressBar]]:
    """Show the progress of several runs in a folder; yield a function for ``run_scenes``."""
    shares: dict[str, float] = {}
    command = f"the same command with --resume --out {folder} continues"
    with (
        terminal.resumable(command, folder, lambda: "finished runs are stored"),
        terminal.progress_bar(console) as bar,
    ):
        task = bar.add_task(name, total=1.0)

        def show(run: str, share: float, words: str) -> None:
            check_stopped()
            shares[run] = share
            finished = sum(share == 1.0 for share in shares.values())
            text = f"{name}: {finished} of {count} finished"
            bar.update(task, description=text, completed=sum(shares.values()) / count)
            if share == 1.0:
                terminal.print_lines(console, f"finished {run}: {words}")

        yield show, bar


def improve(arguments: argparse.Namespace, console: Console) -> int:
    """Change each joint in one way at a time, and rank the changes."""
    from presswear.show.figures import save
    from presswear.sweeps.improve import changes_of, improve

    scene = terminal.load_scene(arguments.scene)
    options = {"engine": arguments.engine, "cycles": arguments.cycles}
    settings = terminal.parse_settings(arguments.set)
    scene = changed(scene, terminal.merge_options(settings, options))
    folder = terminal.output_folder(arguments, f"{scene.name}-improve")
    with _several_runs(console, "improve", folder, 1 + len(changes_of(scene))) as (
        show,
        _,
    ):
        improvement = improve(scene, folder, arguments.jobs, show)
    for key, items in improvement.effects.items():
        lines = (f"  {item}" for item in items)
        terminal.print_lines(console, f"{improvement.heading(key)}:", *lines)
    for change, reason in improvement.failures.items():
        terminal.print_lines(console, f"{change}: the run fails: {reason}")
    terminal.print_lines(console, *improvement.sentences)
    terminal.print_lines(console, f"picture in {save(improvement.draw(), folder)}")
    return 0
