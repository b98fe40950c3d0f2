"""Patterns that MaterialX nodes compute over texture coordinates, written as images.

The nodes belong to the standard library (https://materialx.org/Specification.html).
"""

from __future__ import annotations

import io
import re
from collections.abc import Callable

import numpy as np
from PIL import Image
from pxr import Usd, UsdShade

from .context import producer
from .node_values import PLACES, WIDTHS, NodeValues
from .scene import Array
from .sources import Part, TextureRead, UnfitError, UvRead
from .texture import PNG_COMPRESSION, linear_to_srgb
from .texture_coordinates import end_of_coordinates, step_of_coordinates

SIDE = 1024
"""Pixels across and down of an image."""
_MOST_NODES = 48
"""Nodes of a pattern: values of each are kept, 12 MiB of a color."""
_KIND = re.compile(r"ND_([a-z0-9]+?)_(?:(\w+?)_)?(float|color[34]|vector[234])(FA)?$")
_ONE: dict[str, Callable[[Array], Array]] = {
    "absval": np.abs,
    "ceil": np.ceil,
    "cos": np.cos,
    "dot": np.positive,
    "exp": np.exp,
    "floor": np.floor,
    "fract": lambda values: values - np.floor(values),
    "ln": np.log,
    "round": np.round,
    "sign": np.sign,
    "sin": np.sin,
    "sqrt": np.sqrt,
    "tan": np.tan,
}
_TWO: dict[str, Callable[[Array, Array], Array]] = {
    "add": np.add,
    "divide": np.divide,
    "max": np.maximum,
    "min": np.minimum,
    "modulo": np.mod,
    "multiply": np.multiply,
    "power": np.power,
    "subtract": np.subtract,
}
_OTHERWISE_ONE = ("divide", "modulo", "multiply", "power")
_CHOICES: dict[str, Callable[[Array, Array], Array]] = {
    "ifequal": np.equal,
    "ifgreater": np.greater,
    "ifgreatereq": np.greater_equal,
}


def pattern(values: NodeValues, attribute: Usd.Attribute, most: int) -> TextureRead | None:
    """An image of a node's output over the coordinates 0 to 1; None without coordinates.

    Raises UnfitError, also where there are `most` images.
    """
    rows = _Rows(values)
    node = UsdShade.Shader(attribute.GetPrim())
    try:
        with np.errstate(all="ignore"):  # judged below
            found = rows.output(attribute)
        if not np.isfinite(found).all():
            raise UnfitError(node, "its value is not finite everywhere")
    except UnfitError:
        if rows.uv is None and not rows.is_full():
            return None
        raise
    if rows.uv is None:
        return None
    context = values.reader.context
    if len(context.patterns) == most:
        raise UnfitError(node, f"there are {most} patterns already")
    if found.min() < 0.0 or found.max() > 1.0:
        message = "values of the pattern are outside 0…1, clamped"
        context.ledger.warn("material-value-clamped", node.GetPrim(), message)
    is_color = "color" in _kind(node)
    shown = np.clip(found, 0.0, 1.0)
    if is_color:
        shown[:, :3] = linear_to_srgb(shown[:, :3])
    width = found.shape[1]
    pixels = np.zeros((SIDE * SIDE, max(width, 3)))
    pixels[:, :width] = shown
    stream = io.BytesIO()
    texels = np.round(pixels * 255.0).astype(np.uint8).reshape(SIDE, SIDE, -1)
    Image.fromarray(texels).save(stream, "PNG", compress_level=PNG_COMPRESSION)
    name = f"{attribute.GetPath()}.png"
    context.patterns[name] = stream.getvalue()
    return TextureRead(
        prim=str(node.GetPath()),
        file=name,
        authored_file=name,
        parts=tuple(Part(place) for place in range(width)),
        uv=rows.uv,
        wrap=("repeat", "repeat"),
        color_space="sRGB" if is_color else "raw",
    )


def _kind(node: UsdShade.Shader) -> str:
    """Identifier of a node."""
    return str(node.GetIdAttr().Get() or "")


class _Rows:
    """Values of nodes at the centers of an image's texels, a row each."""

    def __init__(self, values: NodeValues) -> None:
        self.values = values
        self.uv: UvRead | None = None
        self._known: dict[str, Array | None] = {}
        centers = (np.arange(SIDE) + 0.5) / SIDE
        across, down = np.meshgrid(centers, 1.0 - centers)
        self._places = np.column_stack([across.ravel(), down.ravel()]).astype(np.float32)

    def is_full(self) -> bool:
        """Whether no further node may be read."""
        return len(self._known) == _MOST_NODES

    def output(self, attribute: Usd.Attribute) -> Array:
        """Values (n, width) of a node's output; raises UnfitError."""
        node = UsdShade.Shader(attribute.GetPrim())
        self.values.reader.visit(node)
        known = _KIND.match(_kind(node))
        if known is None:
            raise UnfitError(node, "it is no pattern")
        operation, given, kind = known[1], known[2] or known[3], known[3]
        width, many = WIDTHS.get(kind, 1), WIDTHS.get(given, 1)
        path = str(attribute.GetPath())
        found = self._known.get(path)
        if found is None:
            if path in self._known or self.is_full():
                raise UnfitError(node, f"it comes from itself, or from over {_MOST_NODES} nodes")
            self._known[path] = None
            self._known[path] = found = self._value(node, operation, width, many)
        return found

    def _input(self, node: UsdShade.Shader, name: str, default: float, width: int) -> Array:
        attribute, is_output = producer(node, name)
        if is_output:
            found = self.output(attribute)
        else:
            found = np.array([self.values.constant(node, name, (default,) * width)], np.float32)
        if found.shape[1] not in (1, width):
            raise UnfitError(node, f"its '{name}' has another number of values")
        return np.broadcast_to(found, (len(found), width))

    def _value(self, node: UsdShade.Shader, operation: str, width: int, many: int) -> Array:
        def of(name: str, default: float = 0.0, count: int = width) -> Array:
            return self._input(node, name, default, count)

        if operation in ("texcoord", "geompropvalue", "place2d", "rotate2d"):
            return self._coordinates(node, operation)
        if operation in _ONE:
            return _ONE[operation](of("in"))
        if operation in _TWO:
            return _TWO[operation](of("in1"), of("in2", float(operation in _OTHERWISE_ONE)))
        if operation in _CHOICES:
            chosen = _CHOICES[operation](of("value1", 1.0, 1), of("value2", 0.0, 1))
            return np.where(chosen, of("in1"), of("in2"))
        if operation == "constant":
            return of("value")
        if operation == "invert":
            return of("amount", 1.0) - of("in")
        if operation == "clamp":
            return np.clip(of("in"), of("low"), of("high", 1.0))
        if operation == "mix":
            share = of("mix")
            return of("fg") * share + of("bg") * (1.0 - share)
        if operation == "remap":
            low, out = of("inlow"), of("outlow")
            share = (of("in") - low) / (of("inhigh", 1.0) - low)
            return out + share * (of("outhigh", 1.0) - out)
        if operation == "smoothstep":
            low = of("low")
            share = np.clip((of("in") - low) / (of("high", 1.0) - low), 0.0, 1.0)
            return share * share * (3.0 - 2.0 * share)
        return self._rearranged(node, operation, width, many)

    def _rearranged(self, node: UsdShade.Shader, operation: str, width: int, many: int) -> Array:
        if operation in ("combine2", "combine3", "combine4") and many in (1, width):
            parts = (self._input(node, f"in{place + 1}", 0.0, 1) for place in range(width))
            return np.hstack(np.broadcast_arrays(*parts))
        if operation not in ("convert", "extract", "swizzle"):
            raise UnfitError(node, "it is no pattern")
        found = self._input(node, "in", 0.0, many)
        if operation == "convert":
            end = np.full((1, 4), float(_kind(node).endswith("color4")), np.float32)
            wide = [found] * width if many == 1 else [found, np.tile(end, (len(found), 1))]
            return np.hstack(wide)[:, :width]
        if operation == "extract":
            place = int(self.values.constant(node, "index", (0.0,))[0])
            return found[:, [place % many]]
        letters = str(self.values.reader.value(node, "channels", ""))
        if not letters or any(letter not in PLACES for letter in letters):
            raise UnfitError(node, "its channels are unusual")
        return found[:, [min(PLACES[letter], many - 1) for letter in letters]]

    def _coordinates(self, node: UsdShade.Shader, operation: str) -> Array:
        """Coordinates (n, 2) that a node reads or moves."""
        kind = _kind(node).removeprefix("ND_")
        end = end_of_coordinates(self.values, node, kind)
        if end is None:
            step, name = step_of_coordinates(self.values, node, kind)
            found = (
                self._input(node, name, 0.0, 2)
                if node.GetInput(name)
                else self._read(node, UvRead())
            )
            return np.asarray(found @ step[:2, :2].T + step[:2, 2], np.float32)
        if "vector2" not in kind:
            raise UnfitError(node, "it reads a primvar that is no coordinate")
        return self._read(node, end)

    def _read(self, node: UsdShade.Shader, uv: UvRead) -> Array:
        if self.uv not in (None, uv):
            raise UnfitError(node, "it reads another set of coordinates than other nodes")
        self.uv = uv
        return self._places
