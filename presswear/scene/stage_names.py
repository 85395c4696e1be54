"""Names of the stages of a run."""

_ORDINALS = (
    "first",
    "second",
    "third",
    "fourth",
    "fifth",
    "sixth",
    "seventh",
    "eighth",
)


def stage_name(index: int, is_worn: bool = False) -> str:
    """Return the name of a stage, such as ``no wear`` or ``first wear``.

    With ``is_worn`` the stage 0 has initial surfaces, and is named after them.
    """
    if index == 0:
        return "initial surfaces" if is_worn else "no wear"
    if index <= len(_ORDINALS):
        return f"{_ORDINALS[index - 1]} wear"
    return f"wear {index}"
