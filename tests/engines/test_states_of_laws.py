"""Names of kernels, which the equations call by name, and of settings of laws."""

from collections import Counter
from dataclasses import fields

from presswear.linkage.friction_settings import WITH_SETTINGS
from presswear.physics.interactions import kinds


def test_names_of_kernels_and_settings_are_different() -> None:
    """The equations call kernels by name, and a bearing has the settings of all laws."""
    kernels = {kernel for kind in kinds.KINDS for kernel in kind.kernels}
    names = Counter(kernel.__name__ for kernel in kernels)
    names += Counter(
        item.name for law in WITH_SETTINGS.values() for item in fields(law)
    )
    assert [name for name, count in names.items() if count > 1] == []
