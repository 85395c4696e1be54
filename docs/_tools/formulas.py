"""Convert formulas of the pages to MathML, which browsers display without scripts."""

import re

from latex2mathml.converter import convert

_FUNCTION = re.compile(
    r"(</m(?:i|n|sub|sup|frac|sqrt)>)?<m([io])>([a-z]{2,})</m\2>(<mo)?"
)
_PRIMED = re.compile(
    r"<m(sub)?sup>((?:<mi>[^<]*</mi>){1,2})<mi>&#x02032;</mi></m(?:sub)?sup>"
)
_THIN = '<mspace width="0.17em"></mspace>'


def _spaced(match: re.Match[str]) -> str:
    """Return a function name with thin spaces, but none before a bracket."""
    before = match[1] or ""  # end of a variable, a number, a root or a fraction
    after = match[4] or ""  # start of an operator, such as a bracket
    name = f"<mi>{match[3]}</mi>"
    if before:
        name = f"{_THIN}{name}"
    if not after:
        name = f"{name}{_THIN}"
    return f"{before}<mrow>{name}</mrow>{after}"


def _primed(match: re.Match[str]) -> str:
    """Return a prime at full size; a small one looks like the dot of a time derivative."""
    base = f"<msub>{match[2]}</msub>" if match[1] else match[2]
    return f'<mrow>{base}<mo lspace="0" rspace="0">&#x02032;</mo></mrow>'


def mathml_of(text: str, is_block: bool = False) -> str:
    """Convert a TeX formula to MathML; raise ValueError if a command is unknown."""
    body = str(convert(text, display="block" if is_block else "inline"))
    if "\\" in body:
        raise ValueError(f"formula cannot be converted to MathML: {text}")
    body = _FUNCTION.sub(_spaced, body)
    body = body.replace(
        '<mo stretchy="false">&#x0007C;', '<mo lspace="0" rspace="0">&#x0007C;'
    )
    return _PRIMED.sub(_primed, body)
