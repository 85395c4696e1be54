"""Studies from the command line: their runs side by side, progress of each, one report."""

import argparse
from collections.abc import Callable
from pathlib import Path

from rich.console import Console
from rich.progress import Progress, TaskID

from presswear.cli.terminal import (
    Foretold,
    check_resumed,
    free_folder,
    go_on_with,
    goes_on,
    jobs_given,
    progress_bar,
    seconds_given,
)
from presswear.recording.tracker import Tracker
from presswear.scene.scene import Scene
from presswear.studies import OF_A_SCENE, STUDIES, make_study, write_report
from presswear.studies.plan import Study, is_study, load_study, unchanged, waiting
from presswear.studies.rows import run_study
from presswear.sweeps.sweep import shard_given
from presswear.tools.errors import InputError
from presswear.tools.stopping import check_stopped


class Board(Tracker):
    """Progress of a study on a terminal: one line for the whole, one for each run at work."""

    def __init__(self, study: Study, bar: Progress) -> None:
        self._bar = bar
        self._variants = {variant.key: variant for variant in study.variants}
        self._parts = dict.fromkeys(self._variants, 0.0)
        self._whole = bar.add_task(study.name, total=sum(own.extent for own in study.variants))
        self._lines: dict[str, TaskID] = {}
        self._foretold = Foretold(self.remark, "this study")
        self._has_begun = False

    def remark(self, line: str) -> None:
        """Print it."""
        self._bar.console.print(line, highlight=False, soft_wrap=True)

    def variant(self, key: str, part: float, word: str) -> None:
        """Show how far a variant is; ends the study where a signal has come."""
        check_stopped()
        label = self._variants[key].label
        is_news = part >= 1.0 > self._parts[key]
        self._parts[key] = max(part, self._parts[key])
        if key not in self._lines and part < 1.0:
            self._lines[key] = self._bar.add_task(label, total=1.0)
        if key in self._lines:
            text = f"{label}{': ' if word else ''}{word}"
            self._bar.update(self._lines[key], completed=self._parts[key], description=text)
        if is_news:
            finished = sum(done >= 1.0 for done in self._parts.values())
            line = f"finished {finished} of {len(self._parts)}: {label}{': ' if word else ''}{word}"
            self._bar.console.print(line, highlight=False, markup=False, soft_wrap=True)
            if key in self._lines:
                self._bar.remove_task(self._lines.pop(key))
        done = sum(own.extent * self._parts[key] for key, own in self._variants.items())
        self._bar.update(self._whole, completed=done)
        # Those that are finished from before are no measure, nor is the part of a run whose slow
        # cycles come last.
        begins = 0.0 < part < 1.0 and not self._has_begun
        if begins or (is_news and self._has_begun):
            self._has_begun = True
            self._foretold.hear(done / sum(own.extent for own in self._variants.values()))


def run(
    arguments: argparse.Namespace,
    console: Console,
    change: Callable[[Scene], Scene] | None,
) -> int:
    """Run a study into one folder, with a change that a person asked for.

    Parameters
    ----------
    change : callable or None
        None: none was asked for, and a study that is gone on with is the one in its folder.
    """
    study = stored_study(arguments, arguments.scene) if change is None else None
    study = study or make_study(arguments.scene, change or unchanged)
    run_into(study, arguments, console)
    return 0


def stored_study(arguments: argparse.Namespace, name: str) -> Study | None:
    """The study to go on with; None where none is there.  InputError where it is another."""
    if not (arguments.resume and arguments.out is not None and is_study(arguments.out)):
        return None
    study = load_study(arguments.out)
    if study.name != name:
        raise InputError(f"--out {arguments.out}: it holds the study {study.name}, not {name}")
    if arguments.trust:
        for variant in study.variants:
            variant.scene.trust()
    return study


def run_into(study: Study, arguments: argparse.Namespace, console: Console) -> None:
    """Run a study into one folder, or go on with it, and write its report once all is there."""
    jobs = jobs_given(arguments.jobs)
    interval = seconds_given("--checkpoint", arguments.checkpoint)
    part = shard_given(arguments.shard or "1/1")
    check_resumed(arguments.resume, arguments.out)
    folder = arguments.out or free_folder(study.name)
    has_laws = any(variant.scene.user_laws for variant in study.variants)
    go_on = go_on_with(arguments.scene, folder, arguments.command, has_laws)
    # All jobs of an array begin together, in a folder that one of them makes.
    resume = arguments.resume or arguments.shard is not None
    kept = "finished runs are kept, the others go on where they stood"
    with goes_on(go_on, folder, lambda: kept), progress_bar(console) as bar:
        trackers = [Board(study, bar)]
        run_study(study, folder, jobs, resume, trackers, interval, arguments.on, part)
    left = [] if part[1] == 1 else waiting(study, folder, resume=True)
    if left:
        told = f"{len(left)} of {len(study.variants)} are still to run by others: "
        console.print(f"{told}presswear report {folder} behind them", highlight=False)
    else:
        report(folder, console)


def check_study(study: Study, folder: Path) -> None:
    """InputError where a stored study is not one that this version can tell about."""
    if study.name in OF_A_SCENE:
        return
    if study.name not in STUDIES:
        raise InputError(f"{folder} holds the study {study.name!r}; known are {', '.join(STUDIES)}")
    wanted = {variant.key for variant in make_study(study.name, unchanged).variants}
    differs = sorted(wanted ^ {variant.key for variant in study.variants})
    if differs:
        raise InputError(
            f"{folder} holds the study {study.name} with other variants than this version's: "
            f"{differs[0]!r} differs"
        )


def report(folder: Path, console: Console) -> int:
    """Write the report of a study's folder anew."""
    study = load_study(folder)
    check_study(study, folder)
    answer, path = write_report(study, folder)
    console.print(answer, highlight=False)
    console.print(f"results in {folder}, report in {path}", highlight=False)
    return 0
