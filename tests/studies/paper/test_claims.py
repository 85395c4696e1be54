"""The claims as data: each comparison can be computed, and is of what its sentence says."""

from invented import every_result

from presswear.studies.paper.choices import early_stop, fit_of, map_distances, moves, sensitivities
from presswear.studies.paper.claims import CLAIMS, depth_ratios
from presswear.studies.paper.evidence import Evidence
from presswear.studies.paper.printed import FRICTION, HIGH_FRICTION, PRINTED
from presswear.studies.paper.variants import BASE, GEOMETRIES, SENSITIVITIES, SETTINGS, cases, make
from presswear.studies.paper.verdicts import Verdict, compared, verdict
from presswear.studies.paper.words import QUANTITIES


def test_every_comparison_can_be_computed() -> None:
    evidence = Evidence.of(every_result())
    for claim in CLAIMS:
        assert claim.parts
        for part in claim.parts:
            assert part.quantity in QUANTITIES
            assert len(part.over) == len(part.under)
            interval = compared(evidence, BASE, part)
            assert interval is not None, claim.quote


def test_known_depths_give_known_verdicts() -> None:
    """Made up: A is 2.5 times as deep as C everywhere, and nothing hangs on friction."""
    evidence = Evidence.of(every_result())
    for claim in CLAIMS:
        words = {verdict(compared(evidence, BASE, part), part) for part in claim.parts}
        if "clearance A is more serious" in claim.quote:
            assert words == {Verdict.HOLDS}
        if claim.quote.startswith("the wear depth at the friction coefficient"):
            assert words == {Verdict.OPEN}


def test_friction_claims_compare_the_higher_with_the_lower_coefficient() -> None:
    parts = [part for claim in CLAIMS if claim.section == "5.4.2" for part in claim.parts]
    for part in parts:
        if len(part.over) == 1:
            assert part.under[0].setting == FRICTION
            assert part.over[0].setting == HIGH_FRICTION


def test_every_figure_and_section_of_the_paper_has_its_claims() -> None:
    sections = {claim.section for claim in CLAIMS}
    assert sections == {"5.3.1", "5.3.2", "5.3.3", "5.4.1", "5.4.2", "5.4.3", "6"}
    figures = {
        int("".join(filter(str.isdigit, figure)))
        for claim in CLAIMS
        for figure in claim.figure.split(",")
    }
    assert figures == set(range(8, 26))
    assert {int(item.figure[:-1]) for item in PRINTED} <= figures


def test_depth_ratios_are_all_printed() -> None:
    found = depth_ratios()
    assert all(part.printed is not None for part in found)
    assert len(set(found)) == len(found) == 12


def test_the_study_runs_what_it_says() -> None:
    study = make()
    keys = [variant.key for variant in study.variants]
    assert len(set(keys)) == len(keys)
    standard = study.variants[0].scene
    assert {v.scene.mechanism.speed for v in study.variants[: len(SETTINGS)]} == {
        SETTINGS[name][1]().mechanism.speed for name in SETTINGS
    }
    assert standard.starts == 3
    assert {case.key for case in cases()} >= {*GEOMETRIES, *SENSITIVITIES}
    for variant in study.variants:
        case = variant.key.partition("--")[0]
        if case in SENSITIVITIES:
            plain = {
                key: value
                for key, value in variant.scene.as_dict().items()
                if key not in ("statuses", "tolerance", "wears", "starts")
            }
            base = standard.as_dict()
            assert sum(plain[key] != base[key] for key in plain) <= 2, case
            assert plain != {key: base[key] for key in plain}, case


def test_a_fit_is_exact_where_one_number_fits() -> None:
    evidence = Evidence.of(every_result())
    fit = fit_of(evidence, BASE)
    assert len(fit.factors) == 10
    assert len(fit.left_out) == 2
    assert len(fit.used) == 8
    assert fit.spread > 1.0


def test_what_is_alike_moves_nothing_and_stops_right() -> None:
    evidence = Evidence.of(every_result())
    for found in sensitivities(evidence):
        assert sum(moves(interval) for interval in found.ratios) <= 2
    stopped = early_stop(evidence)
    assert len(stopped) > 8
    assert all(found.agrees for found in stopped)
    for apart in map_distances(evidence):
        assert apart.distance < 3.0 * apart.expected
