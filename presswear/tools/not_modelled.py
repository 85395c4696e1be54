"""Answers on things of machines that presswear does not model, or has under another name.

A user who types such a word gets the answer in place of "unknown key". Words and
answers are in ``not_modelled.toml``.
"""

import re
from functools import cache
from pathlib import Path
from typing import Any

PAGE = "docs/theory/not-modelled.md"
NOT_MODELLED = "Not modelled: "  # begins the answers of the first table


@cache
def answers() -> dict[str, list[dict[str, Any]]]:
    """Return the tables ``not_modelled`` and ``other_names``: words and their answers."""
    import tomllib  # slow to import

    return tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))


def not_modelled(name: str) -> str:
    """Return a sentence about a word for what is not modelled or named otherwise, or nothing."""
    words = re.findall(r"[a-z0-9]+", name.lower())
    singular = {word.removesuffix("s") for word in words} | set(words)
    for row in answers()["not_modelled"]:
        if not singular.isdisjoint(row["words"]):
            return f"{NOT_MODELLED}{row['answer']}; see {PAGE}"
    for row in answers()["other_names"]:
        if not singular.isdisjoint(row["words"]):
            answer: str = row["answer"]
            return f"{answer[0].upper()}{answer[1:]}"
    return ""
