"""The engines that a scene may run on, each with its settings."""

from dataclasses import asdict, dataclass, field, fields, replace
from typing import Any

from presswear.engines.settings import USUAL, Engine, ExudynJoints, ExudynTree, InHouse, Purpose
from presswear.tools.serialize import check_fields


@dataclass(frozen=True)
class Numerics:
    """The engines, each with its settings; a run uses one of them."""

    tree: ExudynTree = field(default_factory=ExudynTree)
    joints: ExudynJoints = field(default_factory=ExudynJoints)
    dae: InHouse = field(default_factory=InHouse)

    def __post_init__(self) -> None:
        check_fields(self)
        for item in fields(self):
            check_fields(getattr(self, item.name))

    def resolved(self, purpose: Purpose, known: float = USUAL) -> "Numerics":
        """The same with what is left open as a purpose needs it; see the engines."""
        engines: dict[str, Any] = {item.name: getattr(self, item.name) for item in fields(self)}
        return Numerics(**{name: own.resolved(purpose, known) for name, own in engines.items()})

    def of(self, engine: Engine) -> "Numerics":
        """The same with the settings of one engine."""
        engines: dict[str, Any] = {item.name: getattr(self, item.name) for item in fields(self)}
        place = next(name for name, own in engines.items() if type(own) is type(engine))
        return Numerics(**{**engines, place: engine})

    def having(self, **settings: Any) -> "Numerics":
        """The same with some settings changed, by their own names."""
        changed = {}
        for item in fields(self):
            engine = getattr(self, item.name)
            own = {key: settings.pop(key) for key in asdict(engine).keys() & settings.keys()}
            changed[item.name] = replace(engine, **own)
        if settings:
            raise TypeError(f"no engine has a setting {', '.join(settings)}")
        return Numerics(**changed)
