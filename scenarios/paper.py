"""The whole paper: every scene, number, claim and figure beside ours (some minutes).

Run:  python scenarios/paper.py
"""

import presswear as pw


def main(folder: str = "results/paper", **settings: float | str) -> None:
    study = pw.study("paper", **settings)
    pw.run(study, folder)
    answer, report = pw.write_report(study, folder)
    print(f"{answer}\nreport: {report}")


if __name__ == "__main__":
    main()
