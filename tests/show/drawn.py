"""Parts of drawings of a result."""

from matplotlib.figure import Figure as Sheet

import presswear as pw
from presswear.show.figures import drawings


def sheet_of(name: str, result: pw.Result) -> Sheet:
    return next(drawings(result, [name])).sheet


def legend_of(sheet: Sheet) -> list[str]:
    return [text.get_text() for legend in sheet.legends for text in legend.get_texts()]
