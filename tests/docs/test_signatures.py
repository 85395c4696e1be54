"""Signatures of the Python reference."""

import re

import pytest
from public_names import PUBLIC

import presswear as pw

pytest.importorskip("sphinx")
from typing import Any

from signatures import signature_of

NO_APP: Any = None


def test_signatures_have_types_and_defaults_without_modules():
    parameters, result = signature_of(NO_APP, "function", "", pw.run) or ("", "")
    assert parameters.startswith("(scene: Scene, folder: str | Path | None = None, ")
    assert result == "Result"
    parameters, result = signature_of(NO_APP, "class", "", pw.Bearing) or ("", "")
    assert parameters.startswith(
        "(clearance: float = 0.0003, bearing_radius: float = 0.015"
    )
    assert "materials: Materials | Any = ..." in parameters
    assert result == ""


def test_every_public_class_and_function_has_a_signature():
    for name, one in PUBLIC.items():
        if callable(one):
            what = "class" if isinstance(one, type) else "function"
            parameters, _ = signature_of(NO_APP, what, name, one) or ("", "")
            assert parameters.startswith("("), name
            assert not re.search(r"presswear\.|Quantity\(", parameters), name
