"""Formulas of the pages in MathML, which browsers draw themselves."""

import re

from latex2mathml.converter import convert

_FUNCTION = re.compile(r"(</m(?:i|n|sub|sup|frac|sqrt)>)?<m([io])>([a-z]{2,})</m\2>(<mo)?")
_PRIMED = re.compile(r"<m(sub)?sup>((?:<mi>[^<]*</mi>){1,2})<mi>&#x02032;</mi></m(?:sub)?sup>")
_THIN = '<mspace width="0.17em"></mspace>'


def _spaced(found: re.Match[str]) -> str:
    """The name of a function with the spaces of print: none before a bracket."""
    before, _, name, after = (part or "" for part in found.groups())
    spaces = _THIN if before else "", "" if after else _THIN
    return f"{before}<mrow>{spaces[0]}<mi>{name}</mi>{spaces[1]}</mrow>{after}"


def _primed(found: re.Match[str]) -> str:
    """A prime at its own height: small as an exponent it would be read as the dot of a rate."""
    base = f"<msub>{found[2]}</msub>" if found[1] else found[2]
    return f'<mrow>{base}<mo lspace="0" rspace="0">&#x02032;</mo></mrow>'


def mathml_of(text: str, is_block: bool = False) -> str:
    """A formula of TeX in MathML, with the spaces of print; ValueError where it cannot be shown."""
    body = str(convert(text, display="block" if is_block else "inline"))
    if "\\" in body:
        raise ValueError(f"a formula that MathML does not show: {text}")
    body = _FUNCTION.sub(_spaced, body)
    body = body.replace('<mo stretchy="false">&#x0007C;', '<mo lspace="0" rspace="0">&#x0007C;')
    return _PRIMED.sub(_primed, body)
