"""Whether a window can be opened here.

Exudyn aborts the process where it finds no display, so it is asked before.
"""

import ctypes
import ctypes.util
import os
import sys


def missing_display() -> str:
    """Why no window can be opened, or nothing.

    Elsewhere than on Linux a display is taken for granted.
    """
    if not sys.platform.startswith("linux"):
        return ""
    name = os.environ.get("DISPLAY", "")
    if not name:
        return "DISPLAY is not set"
    library = ctypes.util.find_library("X11")
    if library is None:
        return "libX11 is missing"
    x11 = ctypes.CDLL(library)
    x11.XOpenDisplay.restype = ctypes.c_void_p
    x11.XCloseDisplay.argtypes = [ctypes.c_void_p]
    display = x11.XOpenDisplay(name.encode())
    if not display:
        return f"nothing answers at DISPLAY={name}"
    x11.XCloseDisplay(display)
    return ""
