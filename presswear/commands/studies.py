"""Studies from the command line: their runs side by side, progress of each, one report."""

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.progress import Progress, TaskID

from presswear.campaign.parallel import run_study
from presswear.campaign.study import (
    Study,
    Variant,
    is_study,
    load_study,
    unchanged,
    waiting,
)
from presswear.commands.terminal import (
    free_folder,
    go_on_with,
    jobs_given,
    progress_bar,
    seconds_given,
)
from presswear.record.tracker import Tracker
from presswear.scene.scene import Scene
from presswear.studies import STUDIES, make_study, write_report
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.stopping import check_stopped


@dataclass
class Board(Tracker):
    """Progress of a study on a terminal: one line for the whole, one for each run at work.

    Attributes
    ----------
    parts : dict
        Part done 0 .. 1 by key of the variant.
    """

    bar: Progress
    variants: dict[str, Variant]
    parts: dict[str, float]
    whole: TaskID
    lines: dict[str, TaskID]

    @staticmethod
    def of(study: Study, bar: Progress) -> "Board":
        """A board on which nothing has been done yet."""
        variants = {variant.key: variant for variant in study.variants}
        total = sum(variant.extent for variant in study.variants)
        whole = bar.add_task(study.name, total=total)
        return Board(bar, variants, dict.fromkeys(variants, 0.0), whole, {})

    def variant(self, key: str, part: float, word: str) -> None:
        """Show how far a variant is; ends the study where a signal has come."""
        check_stopped()
        label = self.variants[key].label
        is_news = part >= 1.0 > self.parts[key]
        self.parts[key] = max(part, self.parts[key])
        if key not in self.lines and part < 1.0:
            self.lines[key] = self.bar.add_task(label, total=1.0)
        if key in self.lines:
            text = f"{label}{': ' if word else ''}{word}"
            self.bar.update(self.lines[key], completed=self.parts[key], description=text)
        if is_news:
            finished = sum(done >= 1.0 for done in self.parts.values())
            self.bar.console.print(
                f"finished {finished} of {len(self.parts)}: {label}", highlight=False
            )
            if key in self.lines:
                self.bar.remove_task(self.lines.pop(key))
        done = sum(variant.extent * self.parts[key] for key, variant in self.variants.items())
        self.bar.update(self.whole, completed=done)


def run(
    arguments: argparse.Namespace, console: Console, change: Callable[[Scene], Scene] | None
) -> int:
    """Run a study into one folder, with a change that a person asked for.

    Parameters
    ----------
    change : callable or None
        None: none was asked for, and a study that is gone on with is the one in its folder.
    """
    jobs = jobs_given(arguments.jobs)
    interval = seconds_given("--checkpoint", arguments.checkpoint)
    if arguments.resume and arguments.out is None:
        raise InputError("--resume needs the folder to go on with: --out DIR")
    if change is None and arguments.resume and is_study(arguments.out):
        study = load_study(arguments.out)
        if study.name != arguments.scene:
            raise InputError(
                f"--out {arguments.out}: it holds the study {study.name}, not {arguments.scene}"
            )
    else:
        study = make_study(arguments.scene, change or unchanged)
    folder = arguments.out if arguments.out is not None else free_folder(study.name)
    go_on = go_on_with(study.name, folder)
    waiting(study, folder, arguments.resume)
    try:
        with progress_bar(console) as bar:
            board = Board.of(study, bar)
            run_study(study, folder, jobs, arguments.resume, [board], interval)
    except KeyboardInterrupt:
        raise KeyboardInterrupt(
            f"interrupted; finished runs are kept, the others go on where they stood; {go_on}"
        ) from None
    except RunFailed as error:
        raise RunFailed(f"{error}; {go_on}") from error
    return report(folder, console)


def check_study(study: Study, folder: Path) -> None:
    """InputError where a stored study is not one that this version can tell about."""
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
