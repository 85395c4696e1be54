"""The study of the second wear: the paper's scene, one reading changed at a time.

Run:  python scenarios/runaway.py
"""

import presswear as pw


def main(folder: str = "results/runaway", **settings: float | str) -> None:
    study = pw.study("runaway", **settings)
    pw.run(study, folder)
    answer, report = pw.write_report(study, folder)
    print(f"{answer}\nreport: {report}")


if __name__ == "__main__":
    main()
