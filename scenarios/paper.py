"""The whole paper: every scene, number, claim and figure beside ours (some minutes).

Run:  python scenarios/paper.py
"""

from pathlib import Path

from presswear.campaign.study import run_study
from presswear.studies.paper.report import write_paper_report
from presswear.studies.paper.variants import paper


def main() -> None:
    study = paper()
    folder = Path("results/paper-script")
    told: set[str] = set()

    def progress(key: str, part: float, word: str) -> None:
        if part >= 1.0 and key not in told:
            told.add(key)
            print(f"finished {len(told)} of {len(study.variants)}: {key}")

    run_study(study, folder, jobs=2, resume=folder.exists(), told=progress)
    answer, report = write_paper_report(study, folder)
    print(answer)
    print("report:", report)


if __name__ == "__main__":
    main()
