"""The report of the study ``paper``: one HTML file with every number, claim and figure."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from presswear.figures.paper import paper_drawings
from presswear.figures.parts import drawn
from presswear.paper.evidence import Evidence
from presswear.report.page import Illustration, render_page
from presswear.report.paper.chosen import (
    distances_table,
    fit_table,
    geometry_table,
    sensitivity_table,
    stopped_table,
)
from presswear.report.paper.numbers import numbers_table, ranges_table, ratios_table
from presswear.report.paper.runs import conventions_table, paper_step, provenance_table, runs_table
from presswear.report.paper.summary import counts_table, findings
from presswear.report.paper.trends import judged
from presswear.results import StoredResult, write_bytes
from presswear.studies import Study, results_of
