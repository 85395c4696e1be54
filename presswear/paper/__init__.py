"""Study of the paper: settings, printed numbers, claims and figures, compared with this program."""

import time
from pathlib import Path

import presswear as pw
from presswear.paper.report import write_report
from presswear.paper.settings import LONGEST, make_scenes, run_label


def run_paper(
    folder: str | Path,
    engine: str | None = None,
    jobs: int | None = None,
    quick: bool = False,
) -> tuple[str, Path]:
    """Run every scene of the paper, or resume, and write the report.

    Parameters
    ----------
    folder : path
        Folder of all runs and of the report.
    engine : str or None
        Engine of all runs; None: ``exudyn``.
    jobs : int or None
        Runs at a time; None: as many as there are cores.
    quick : bool
        Run a few cycles of each stage instead of as many as the paper has.

    Returns
    -------
    tuple of str and Path
        Result of the comparison in a few sentences, and path of the report.
    """
    scenes = make_scenes(engine, quick)
    started = time.perf_counter()
    ended = set[str]()

    def show(name: str, fraction: float, words: str) -> None:
        if fraction == 1.0 and name not in ended:
            ended.add(name)
            elapsed = (time.perf_counter() - started) / 60.0  # min
            remaining = elapsed * (len(scenes) / len(ended) - 1.0)
            count = f"{len(ended)} of {len(scenes)}"
            print(
                f"{count}: {run_label(name)}: {words}; about {remaining:.1f} min left",
                flush=True,
            )

    # The longest runs start first, so that no process waits long for the last run.
    ordered = sorted(scenes, key=lambda name: not name.startswith(LONGEST))
    results = pw.run_scenes(
        {name: scenes[name] for name in ordered}, folder, jobs=jobs, on_progress=show
    )
    return write_report({name: results[name] for name in scenes}, Path(folder))
