"""Linkages without a closed loop, and their placing."""

import presswear as pw
from presswear.physics.equations.chain import Chain, open_chain
from presswear.physics.equations.text import Text


def open_tree(linkage: pw.linkage.Linkage) -> Chain:
    result = open_chain(linkage, Text())
    assert isinstance(result, Chain), result
    return result


def without(linkage: pw.linkage.Linkage, *names: str) -> pw.linkage.Linkage:
    """Return the linkage without some of its joints."""
    return linkage.changed(joints=[j for j in linkage.joints if j.name not in names])
