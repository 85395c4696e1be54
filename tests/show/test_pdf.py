"""Report as a PDF, the example of a figure for a paper, and the export for MATLAB."""

import re
from dataclasses import replace
from pathlib import Path

import made_up_result as made
import matplotlib
import numpy as np
from made_up_result import made_up
from refusals import refused
from scipy.io import loadmat

import presswear as pw
from presswear.results.export import write_table
from presswear.show.pdf import write_pdf

PAGE = Path(__file__).parents[2] / "docs/how-to/results.md"


def pages_in(data: bytes) -> int:
    return len(re.findall(rb"/Type /Page\b", data))


def test_pdf_has_a_page_for_each_figure_and_fonts_to_edit(tmp_path):
    result = replace(made_up(made.IDEAL, 1), path=tmp_path)
    file = write_pdf(result)
    assert file == tmp_path / "report.pdf"
    data = file.read_bytes()
    figures = 2  # of the mechanism and of the motion
    assert 1 <= pages_in(data) - figures <= 6
    assert b"/FontFile2" in data
    assert b"/Type3" not in data
    assert write_pdf(result).read_bytes() == data
    with refused("ran in memory"):
        write_pdf(replace(result, path=None))


def test_example_of_a_figure_for_a_paper(tmp_path, monkeypatch, command):
    (code,) = re.findall(
        r"## Figures for a paper.*?```python\n(.*?)```", PAGE.read_text(), re.DOTALL
    )
    folder = tmp_path / "results" / "mine"
    scene = pw.scenes.wear_times(engine="dae", cycles=1, wear_updates=0, replicates=1)
    pw.run(scene, folder, jobs=1)
    monkeypatch.chdir(tmp_path)
    with matplotlib.rc_context({"backend": "agg"}):
        exec(code, {})
    data = (tmp_path / "force.pdf").read_bytes()
    assert b"/FontFile2" in data
    assert b"/Type3" not in data
    assert "report.pdf" in command("report results/mine --format pdf")
    report = (folder / "report.pdf").read_bytes()
    assert pages_in(report) > 5
    assert b"/Type3" not in report
    assert b"/Subtype /Image" not in report
    widths = [float(width) for width in re.findall(rb"/MediaBox \[ 0 0 (\S+)", report)]
    # Pages with text are A4 and wider than the figures.
    figures = [width for width in widths if width != max(widths)]
    assert 6.0 * 72.0 < max(figures) <= 7.0 * 72.0
    assert "no wear: " in command("export results/mine mine.mat")
    variables = loadmat(tmp_path / "mine.mat")
    assert variables["A_normal_force"].shape == variables["time"].shape
    assert variables["units"][0, 0]["A_normal_force"][0] == "N"


def test_spaces_in_names_of_columns_are_underscores_in_matlab(tmp_path):
    numbers = np.array([0.0, 0.1])
    file = tmp_path / "table.mat"
    write_table(file, {"time": numbers, "guide top left_sliding": numbers})
    variables = loadmat(file)
    np.testing.assert_array_equal(
        variables["guide_top_left_sliding"], numbers[:, np.newaxis]
    )
    assert variables["units"][0, 0]["guide_top_left_sliding"][0] == "m/s"
