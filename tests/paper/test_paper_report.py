"""The page of the study ``paper``: all numbers, all claims, one file, and what is missing."""

import html
import re
from collections.abc import Sequence
from pathlib import Path

import pytest
from invented import EVEN, cut, every_evidence, every_result, result, stage

from presswear.paper import run_paper
from presswear.paper.claims import CLAIMS
from presswear.paper.evidence import Evidence
from presswear.paper.figures import drawers
from presswear.paper.printed import PRINTED
from presswear.paper.report import render, words_of
from presswear.paper.report.numbers import numbers_table, ranges_table, ratios_table
from presswear.paper.report.summary import STYLES, findings, headline
from presswear.paper.variants import BASE, WEAR, make_scenes, variant_key
from presswear.paper.verdicts import Verdict, judged
from presswear.paper.words import as_printed
from presswear.show.page import Illustration

FOLDED = ["numbers", "figures", "chosen", "statistics", "origin"]


def words(evidence: Evidence, figures: Sequence[Illustration] = ()) -> str:
    """Text of the page, each run of blanks as one."""
    page = html.unescape(
        re.sub(r"<[^>]*>", " ", render(words_of(list(make_scenes()), evidence), figures))
    )
    return re.sub(r"\s+", " ", page)


def test_every_printed_number_and_claim_is_on_the_page() -> None:
    text = words(every_evidence())
    for item in PRINTED:
        assert re.sub(r"\s+", " ", as_printed(item.value, item.quantity)) in text
        assert all(part in text for part in item.misprint.split("; "))
    assert all(claim.quote in text for claim in CLAIMS)


def test_all_but_summary_and_claims_is_folded_and_links_lead_into_it() -> None:
    page = render(words_of(list(make_scenes()), every_evidence()), [])
    parts = re.split(r'<details class="part">', page)
    assert len(parts) == 6
    assert all(f'<div id="{name}">' in own for name, own in zip(FOLDED, parts[1:], strict=True))
    linked = re.findall(r'href="#(\w+)"', parts[0])
    assert linked == ["claims", *FOLDED]


def test_what_holds_in_part_is_not_coloured_as_what_does_not_hold() -> None:
    styles = {verdict: STYLES[verdict] for verdict in Verdict}
    assert len({styles[Verdict.HOLDS], styles[Verdict.IN_PART], styles[Verdict.FAILS]}) == 3
    page = render(words_of(list(make_scenes()), every_evidence()), [])
    for style in set(styles.values()):
        assert re.search(rf"\.{style} {{ color: #\w+", page)


def test_intervals_stay_on_one_line() -> None:
    page = html.unescape(render(words_of(list(make_scenes()), every_evidence()), []))
    assert re.search(r"\d\N{NO-BREAK SPACE}\(\S+\N{NO-BREAK SPACE}to\N{NO-BREAK SPACE}\S+\)", page)
    assert not re.search(r"\d \([\d.]+ to [\d.]+\)", page)


def test_the_page_needs_no_network() -> None:
    page = render(words_of(list(make_scenes()), every_evidence()), [])
    links = re.findall(r"""(?:src|href|srcset)\s*=\s*["']?([^"'>]*)""", page)
    assert links
    assert all(link.startswith("#") for link in links)


def test_the_first_screen_counts_right() -> None:
    evidence = every_evidence()
    told = map(int, re.findall(r"\d+", headline(evidence, judged(evidence))))
    claims, held, part, failed, rest, _, peaks, inside, above, below = told
    assert held + part + failed + rest == claims == len(CLAIMS)
    assert inside + above + below == peaks
    assert len(findings(evidence, {})) == 5
    assert len(findings(evidence, {"paper-step": "it blew up"})) == 6


def test_findings_follow_the_numbers() -> None:
    told = " ".join(findings(every_evidence(), {}))
    assert "The second wear does not run away" in told
    deep = {
        variant_key(BASE, WEAR): result(
            WEAR, [stage(WEAR, k, k + 1, peak=(20e-6 * 20**k, 8e-6)) for k in range(3)]
        )
    }
    assert "The second wear runs away" in " ".join(findings(Evidence(deep), {}))
    strong = {"A": 1e5, "C": 1e5}
    stages = [stage(WEAR, k, k + 1, [strong if k else EVEN]) for k in range(3)]
    high = findings(Evidence({variant_key(BASE, WEAR): result(WEAR, stages)}), {})
    assert any("of the others are lower than any but the rarest of ours" in one for one in high)


def test_the_tables_show_ours_beside_the_paper() -> None:
    """Made up: 20 um at A after each wear, so 40 um after two and a ratio of two."""
    evidence = every_evidence()
    table, remarks = numbers_table(evidence)
    rows = [row for _, group in table.groups for row in group]
    marks = {int(mark) for row in rows for mark in re.findall(r"\[(\d+)\]", row[0])}
    assert marks == set(range(1, len(remarks) + 1))
    depth = next(
        row for row in rows if row[0].startswith("deepest wear, joint A, after the second")
    )
    assert float(depth[3].split()[0]) == pytest.approx(40.0, rel=0.03)
    assert float(depth[6].split()[0]) == pytest.approx(1178.0 / 40.0, rel=0.03)
    ((_, ratios),) = ratios_table(evidence).groups
    assert float(ratios[0][2].split()[0]) == pytest.approx(2.0, rel=0.03)
    assert len(ratios) == 12
    ((_, ranges),) = ranges_table(evidence).groups
    assert len(ranges) == 4


def test_a_study_that_was_interrupted_says_what_is_missing() -> None:
    some = {key: cut(found, 1) for key, found in list(every_result().items())[:2]}
    text = words(Evidence(some))
    assert f"{len(make_scenes()) - 2} of {len(make_scenes())} runs are missing" in text
    assert "not computed" in text
    assert "Nothing ran far enough to be drawn" in words(Evidence({}))


def test_a_joint_without_clearance_is_left_out() -> None:
    """A person may have closed joint C in all runs: its rows stay, empty."""
    evidence = Evidence({key: cut(found, joints="A") for key, found in every_result().items()})
    drawings = [drawing for draw in drawers(evidence) for drawing in draw()]
    figures = [
        Illustration(drawing.file, drawing.title, drawing.caption, "") for drawing in drawings
    ]
    assert "not computed" in words(evidence, figures)
    rows = [row for _, group in numbers_table(evidence)[0].groups for row in group]
    assert all((row[3] == "–") == ("joint C" in row[0]) for row in rows)


@pytest.mark.slow
def test_the_whole_study_runs_and_is_reported(tmp_path: Path) -> None:
    """Few cycles of everything: too few for many verdicts, enough for every path."""
    folder = tmp_path / "paper"
    _, report = run_paper(folder, engine="dae", quick=True)
    assert report == folder / "report.html"
    assert (folder / "report.html").read_text().count("<figure>") == 18
    assert len(list((folder / "figures").iterdir())) == 18
