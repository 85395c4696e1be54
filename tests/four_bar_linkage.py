"""The four-bar linkage of many tests."""

from presswear.linkage.mechanisms import FourBar

FOUR_BAR = FourBar(speed=30.0).linkage()
