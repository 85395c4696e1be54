"""Commands; their texts and arguments are in ``commands.toml``."""

import tomllib
from pathlib import Path
from typing import Any

_FILE = Path(__file__).with_name("commands.toml")
COMMANDS: dict[str, dict[str, Any]] = tomllib.loads(_FILE.read_text(encoding="utf-8"))
TEXTS = COMMANDS.pop("texts")
SHARED = COMMANDS.pop("shared")
