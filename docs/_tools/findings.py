"""Write the results of the paper's study into findings.md:  python docs/_tools/findings.py FOLDER

Draws its picture of the peak forces and stores its report for the site, too. The folder
is that of a finished study, ``python -m presswear.paper FOLDER --engine dae``.
"""

import re
import shutil
import sys
from dataclasses import replace
from pathlib import Path

import presswear as pw
from presswear.paper.evidence import Evidence
from presswear.paper.figures import drawings
from presswear.paper.printed import HIGHLIGHTS
from presswear.paper.report import failures_of, findings, write_report
from presswear.paper.settings import BASE, make_scenes
from presswear.paper.verdicts import compared
from presswear.show.figures import save
from presswear.show.page import text_of
from presswear.tools.numbers import readable

PAGE = Path(__file__).parents[1] / "findings.md"
REPORT = PAGE.parent / "_outputs" / "paper-report.html"
PICTURE = PAGE.with_name("paper-fig-24.png")
LABELS = {
    "second wear": "ratio of the wear depths at A: second to first wear update",
    "friction, wear": "ratio of the wear depths at A: friction coefficient doubled",
    "friction, force": "ratio of the mean peak forces at A: friction coefficient doubled",
    "speed": "ratio of the wear depths at A: speed doubled",
    "joints": "ratio of the wear depths at A and C: at 8π rad/s",
}


def evidence_of(folder: Path) -> Evidence:
    """Return the results of a study."""
    return Evidence({name: pw.load(folder / name) for name in make_scenes()})


def results_of(evidence: Evidence) -> str:
    """Return the table and the sentences of a study."""
    rows = ["| quantity | paper | presswear |", "|---|---:|---:|"]
    for name, label in LABELS.items():
        comparison = HIGHLIGHTS[name]
        ours = compared(evidence, BASE, comparison)
        rows.append(f"| {label} | {readable(comparison.printed)} | {text_of(ours)} |")
    sentences = enumerate(findings(evidence, failures_of(evidence)), start=1)
    return "\n".join([*rows, "", *(f"{k}. {sentence}" for k, sentence in sentences)])


def fill(folder: Path) -> None:
    """Write table and sentences between their marks."""
    marks = r"(?s)(<!-- result -->\n).*(<!-- end -->)"
    evidence = evidence_of(folder)
    results = results_of(evidence)
    text = PAGE.read_text()
    text = re.sub(marks, lambda match: f"{match[1]}\n{results}\n\n{match[2]}", text)
    PAGE.write_text(text)
    figures = {drawing.file: drawing for drawing in drawings(evidence)}
    peaks = replace(figures["fig-24-peaks.png"], file=PICTURE.name)
    save(peaks, PICTURE.parent)
    _, report = write_report(evidence.results, folder)
    shutil.copyfile(report, REPORT)


if __name__ == "__main__":
    fill(Path(sys.argv[1]))
