"""Owns broken and hostile MaterialX documents, each beside a stage that references it."""

import random
from collections.abc import Callable, Iterator

from texts import text_of

STAGE = text_of("hostile_materialx/stage.usda").encode()
_HEAD = '<?xml version="1.0"?><materialx version="1.38" xmlns:xi="http://www.w3.org/2001/XInclude"'
_MATERIAL = """<surfacematerial name="M" type="material">
  <input name="surfaceshader" type="surfaceshader" nodename="S" /></surfacematerial>"""
_SURFACE = text_of("hostile_materialx/_surface.mtlx")
_GRAPH = text_of("hostile_materialx/_graph.mtlx")


def _document(*parts: str, head: str = "") -> bytes:
    return f"{_HEAD} {head}>{''.join(parts)}</materialx>".encode()


def _chain(count: int, step: Callable[[int], str]) -> str:
    nodes = "".join(step(number) for number in range(count))
    return f'<nodegraph name="G">{nodes}<output name="o" type="color3" nodename="n0" /></nodegraph>'


def _sum(number: int, of: tuple[int, int]) -> str:
    inputs = "".join(
        f'<input name="in{place + 1}" type="color3" nodename="n{other}" />'
        for place, other in enumerate(of)
    )
    return f'<add name="n{number}" type="color3">{inputs}</add>'


def documents() -> Iterator[tuple[str, bytes]]:
    """Name and bytes of every document, in a fixed order."""
    good = _document(_GRAPH, _SURFACE, _MATERIAL)
    yield "plain", good
    yield from _written_by_hand()
    chance = random.Random(20260101)
    for number in range(8):
        changed = bytearray(good)
        for _ in range(chance.randrange(1, 12)):
            changed[chance.randrange(len(good))] = chance.randrange(256)
        yield f"flip-{number}", bytes(changed)
    for number in range(4):
        yield f"cut-{number}", good[: chance.randrange(1, len(good))]
    for word in (b"nan", b"-inf", b"1e308", b"-1", b"99999999999", b"0", b"a, b", b""):
        yield (
            f"number-{word.decode()}",
            good.replace(b'"0.75"', b'"' + word + b'"')
            .replace(b'"2, 3"', b'"' + word + b", " + word + b'"')
            .replace(b'value="1"', b'value="' + word + b'"'),
        )
    rows = good.split(b"<")
    for number in range(6):
        mixed = rows[1:]
        for _ in range(4):
            first, last = chance.randrange(len(mixed)), chance.randrange(len(mixed))
            mixed[first], mixed[last] = mixed[last], mixed[first]
        yield f"shuffled-{number}", b"<" + b"<".join(mixed)


def _written_by_hand() -> Iterator[tuple[str, bytes]]:
    """Faults that random damage does not reach."""
    rest = (_SURFACE, _MATERIAL)
    yield "cycle", _document(_chain(2, lambda n: _sum(n, (1 - n, 1 - n))), *rest)
    yield "own-input", _document(_chain(1, lambda n: _sum(n, (n, n))), *rest)
    yield "deep-graph", _document(_chain(5000, lambda n: _sum(n, (n + 1, n + 1))), *rest)
    yield "wide-graph", _document(_chain(30000, lambda n: _sum(n, (n + 1, 2 * n + 1))), *rest)
    yield "deep-xml", _document("<nodegraph>" * 20000 + "</nodegraph>" * 20000, *rest)
    yield "graph-in-graph", _document(f'<nodegraph name="A">{_GRAPH}</nodegraph>', *rest)
    copies = "".join(_MATERIAL.replace('"M"', f'"M{n}"') for n in range(2000))
    wide = _chain(200, lambda n: _sum(n, (n + 1, n + 1)))
    yield "many-materials", _document(wide, *rest, copies)
    yield "same-names", _document(_GRAPH, _GRAPH, _SURFACE, _SURFACE, _MATERIAL, _MATERIAL)
    yield (
        "surface-of-itself",
        _document(
            '<standard_surface name="S" type="surfaceshader">'
            '<input name="base_color" type="color3" nodename="S" /></standard_surface>',
            _MATERIAL,
        ),
    )
    yield "material-of-itself", _document(_MATERIAL.replace('nodename="S"', 'nodename="M"'))
    yield "unknown-surface", _document(_SURFACE.replace("standard_surface", "toon"), _MATERIAL)
    inherits = '<nodedef name="ND_a" node="a" inherit="ND_b"><output name="out" type="color3" />'
    inherits += '</nodedef><nodedef name="ND_b" node="b" inherit="ND_a"/>'
    yield "inheritance", _document(inherits, _GRAPH.replace("<multiply", "<a"), *rest)
    yield "interface", _document(_GRAPH.replace('value="1, 0.5', 'interfacename="tint" x="'), *rest)
    for number, place in enumerate(("../", "/etc/", "file:///etc/", "t.png/../../../")):
        yield f"prefix-{number}", _document(_GRAPH, *rest, head=f'fileprefix="{place}"')
    yield "names", _document(_GRAPH, *rest).replace(b'"G"', b'"../../G:\xc3\xa9 {}[]<1>"')
    yield "entities", b'<!DOCTYPE a [<!ENTITY b "bbbb"><!ENTITY c "&b;&b;">]>' + _document(*rest)
    yield "include-self", _document('<xi:include href="look.mtlx" />', _GRAPH, *rest)
    yield "include-out", _document('<xi:include href="../secret.mtlx" />', _GRAPH, *rest)
    yield "include-device", _document('<xi:include href="/dev/zero" />', _GRAPH, *rest)
    yield "zeros", bytes(4096)
    yield "too-large", _document("<!--" + "x" * (17 << 20) + "-->", _GRAPH, *rest)
