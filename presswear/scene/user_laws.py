"""User laws of a scene: source code of joints, loads and motors, and whether it may be executed."""

from collections.abc import Mapping
from typing import Any

from presswear.linkage.load_laws import LOAD_PARAMETERS, check_load
from presswear.scene.loaded_linkage import LoadedLinkage
from presswear.scene.pin_joints import check_user_friction, check_user_laws
from presswear.tools.compiled_law import check_compiles
from presswear.tools.errors import InputError, shown
from presswear.tools.user_function import UserFunction


class LinkageWithUserLaws(LoadedLinkage):
    """Linkage of a mechanism with the user laws of its joints, loads and motors."""

    def check_user_laws(self) -> None:
        """Raise InputError if a user law returns no number or creates energy; executes the law."""
        self.check_trusted()
        for joint in self.all_loose_joints:
            check_user_laws(self.bearing(joint), joint, self.conventions)
        for joint in self.rigid_bearings:
            check_user_friction(self.bearing(joint), joint)
        for key, law in self.user_laws.items():
            if key.startswith(("loads[", "drives[")):
                check_load(key, law)
                check_compiles(law, key, LOAD_PARAMETERS)

    @property
    def user_laws(self) -> dict[str, UserFunction]:
        """User laws, source code, by keys such as ``A.normal_law`` and ``loads[0].law``."""
        laws: dict[str, Any] = {}
        for joint in self.all_loose_joints:
            bearing = self.bearing(joint)
            laws[f"{joint}.normal_law"] = bearing.normal_law
            laws[f"{joint}.friction_law"] = bearing.friction_law
            laws[f"{joint}.wear_law"] = bearing.wear_law
        for joint in self.rigid_bearings:
            laws[f"{joint}.friction_law"] = self.bearing(joint).friction_law
        linkage = self.mechanism.linkage()
        for k, load in enumerate(linkage.loads):
            laws[f"loads[{k}].law"] = getattr(load, "law", None)
        for k, drive in enumerate(linkage.drives):
            laws[f"drives[{k}].motor.law"] = getattr(drive.motor, "law", None)
        return {key: law for key, law in laws.items() if isinstance(law, UserFunction)}

    @property
    def has_untrusted_loads(self) -> bool:
        """True if ideal torques would execute source code that was read from a result."""
        laws = [law for key, law in self.user_laws.items() if key.startswith("loads[")]
        return not all(law.is_trusted for law in laws)

    @property
    def is_trusted(self) -> bool:
        """True if no source code was read from a result that may not be executed."""
        return all(law.is_trusted for law in self.user_laws.values())

    def check_trusted(self) -> None:
        """Raise UntrustedLaw if a run would execute source code that was read from a result."""
        for key, law in self.user_laws.items():
            law.check_trusted(key)

    def trust(self) -> None:
        """Allow this process to execute the source code of the user laws."""
        for law in self.user_laws.values():
            law.trusted()


def refuse_files(data: Any) -> None:
    """Raise InputError for a stored law that names a file; allowed are names and source code."""
    if isinstance(data, Mapping):
        for key, value in data.items():
            is_law = key in ("normal_law", "friction_law", "law")
            if is_law and isinstance(value, str) and ".py:" in value:
                raise InputError(f"{key} = {shown(value)}: a stored law is source code")
            refuse_files(value)
    elif isinstance(data, list):
        for value in data:
            refuse_files(value)
