"""The study of the second wear: the paper's scene, one reading changed at a time.

Run:  python scenarios/runaway.py
"""

from pathlib import Path

from presswear.campaign.study import run_study
from presswear.studies.runaway.report import write_runaway_report
from presswear.studies.runaway.variants import runaway


def main() -> None:
    study = runaway()
    folder = Path("results/runaway-script")
    told: set[str] = set()

    def progress(key: str, part: float, word: str) -> None:
        if part >= 1.0 and key not in told:
            told.add(key)
            print(f"finished {len(told)} of {len(study.variants)}: {key}")

    run_study(study, folder, jobs=2, resume=folder.exists(), told=progress)
    answer, report = write_runaway_report(study, folder)
    print(answer)
    print("report:", report)


if __name__ == "__main__":
    main()
