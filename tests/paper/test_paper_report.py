"""Report of the paper's study: printed numbers, claims, figures, and what is missing."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import html
import re

import matplotlib
import numpy as np
import pytest
from known_results import EVEN, every_evidence, every_result, evidence_of, stage

from presswear.paper import report, run_paper
from presswear.paper.__main__ import main
from presswear.paper.evidence import QUANTITIES, Evidence
from presswear.paper.figures import drawings
from presswear.paper.printed import CLAIMS, DOUBTFUL, PRINTED, Place
from presswear.paper.settings import BASE, WEAR
from presswear.paper.tables import depth_factors, fit, number_table, ratio_table
from presswear.paper.verdicts import compared, judge, verdict
from presswear.paper.words import printed_text
from presswear.show.page import FirstScreen, render_page
from presswear.tools.numbers import readable


def text_of(evidence: Evidence) -> str:
    sections = report.page_sections(evidence, judge(evidence))
    page = html.unescape(
        re.sub(r"<[^>]*>", " ", render_page("", FirstScreen(), sections))
    )
    return re.sub(r"\s+", " ", page)


def test_every_printed_number_and_claim_is_on_the_page():
    text = text_of(every_evidence())
    for item in PRINTED:
        assert re.sub(r"\s+", " ", printed_text(item)) in text
        assert item.misprint in text
    assert all(claim.quote in text for claim in CLAIMS)


def test_known_depths_give_known_verdicts():
    """A is 2.5 times as deep as C everywhere, and friction has no effect."""
    for claim in CLAIMS:
        words = set()
        for part in claim.comparisons:
            assert part.quantity in QUANTITIES
            assert len(part.over) == len(part.under)
            ours = compared(every_evidence(), BASE, part)
            assert ours is not None, claim.quote
            words.add(verdict(ours, part))
        assert words
        if "clearance A is more serious" in claim.quote:
            assert words == {"holds"}
        if claim.quote.startswith("the wear depth at the friction coefficient"):
            assert words == {"no effect"}


def test_the_answer_counts_right_and_findings_follow_the_numbers():
    evidence = every_evidence()
    counts = map(int, re.findall(r"\d+", report.headline(evidence, judge(evidence))))
    claims, held, part, failed, same, rest, _, peaks, inside, above, below = counts
    assert held + part + failed + same + rest == claims == len(CLAIMS)
    assert inside + above + below == peaks
    assert len(report.findings(evidence, {"paper-step": "it blew up"})) == 6
    assert "the depth does not grow by orders" in " ".join(
        report.findings(evidence, {})
    )
    deep = [stage(WEAR, k, k + 1, peak=(20e-6 * 20**k, 8e-6)) for k in range(3)]
    strong = [
        stage(WEAR, k, k + 1, [{"A": 1e5, "C": 1e5} if k else EVEN]) for k in range(3)
    ]
    lower = r", [1-9]\d* are lower "
    for stages, words in ((deep, "the depth grows by orders"), (strong, lower)):
        assert re.search(
            words, " ".join(report.findings(evidence_of(WEAR, *stages), {}))
        )


def test_tables_show_ours_beside_the_paper():
    """The depth at A is 20 um after each wear, so 40 um after two and a ratio of two."""
    rows = {
        row[0]: row
        for _, group in number_table(every_evidence()).groups
        for row in group
    }
    assert len(rows) == len(PRINTED) + 6  # six are compared at two stages
    depth = rows["3.5π: deepest wear, joint A, after the second wear (µm), Fig. 8a"]
    assert float(depth[2].split()[0]) == pytest.approx(40.0, rel=0.03)
    assert float(depth[5].split()[0]) == pytest.approx(1178.0 / 40.0, rel=0.03)
    ((_, ratios),) = ratio_table(every_evidence()).groups
    assert float(ratios[0][2].split()[0]) == pytest.approx(2.0, rel=0.03)


def test_a_computed_sentence_holds_for_every_depth_of_its_table():
    """No printed depth is farther from ours than the largest factor that the sentence names."""
    evidence = every_evidence()
    factors = depth_factors(evidence, BASE)
    best, typical, largest = fit(factors)
    off = [
        max(one / best, best / one)
        for place, one in factors.items()
        if place not in DOUBTFUL
    ]
    assert max(off) == pytest.approx(largest)
    assert typical < largest
    text = " ".join(report.findings(evidence, {}))
    assert f"at most by {readable(largest)};" in text
    assert "agree within" not in text


def test_missing_runs_leave_the_rest():
    first, *_ = every_result().items()
    assert "not computed" in text_of(Evidence(dict([first])))
    assert not [*drawings(Evidence({}))]


def test_every_figure_has_its_counterpart_with_the_printed_values():
    before = dict(matplotlib.rcParams)
    figures = [*drawings(every_evidence())]
    assert dict(matplotlib.rcParams) == before
    assert {int(drawing.title.split()[1]) for drawing in figures} == set(range(8, 26))
    for drawing in figures:
        number = int(drawing.title.split()[1])
        if number not in (8, 11, 14) and "peaks" not in drawing.file:
            continue
        lines = [line for axes in drawing.sheet.axes for line in axes.get_lines()]
        marked = [line for line in lines if line.get_gid() == "printed"]
        values = [float(np.ravel(line.get_xdata())[0]) for line in marked]
        quantity = "angle" if number < 17 else ""
        shown = [entry for entry in PRINTED if entry.figure[:-1] == f"{number}"]
        printed = [entry.value for entry in shown if quantity in ("", entry.quantity)]
        expected = np.degrees(printed) if quantity else np.array(printed)
        np.testing.assert_allclose(sorted(values), sorted(expected))
    worn = every_evidence().wear_map(BASE, Place(WEAR, 1, "A"))
    curve = np.ravel(figures[0].sheet.axes[0].get_lines()[0].get_ydata())
    is_worn = worn.mean > 1e-6
    np.testing.assert_allclose(curve[is_worn], 1e6 * worn.mean[is_worn])


def test_bad_input_is_one_line(tmp_path, capsys):
    assert main([str(tmp_path / "paper"), "--engine", "exudyntree"]) == 2
    assert "did you mean exudyn-tree" in capsys.readouterr().err


@pytest.mark.slow
def test_the_whole_study_runs_and_is_reported(tmp_path):
    """Few cycles of everything: too few for many verdicts, enough for every path."""
    answer, page = run_paper(tmp_path / "paper", engine="dae", quick=True)
    assert answer.startswith("Of 49 claims on trends")
    assert answer in html.unescape(page.read_text())
