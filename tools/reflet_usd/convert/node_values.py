"""Values of MaterialX node graphs: constants, and textures with a scale and a bias for each number.

The nodes belong to the standard library (https://materialx.org/Specification.html). A node whose
value is neither, such as a noise, is named by a warning.
"""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from pxr import Sdf, Usd, UsdShade

from .context import producer
from .source_arithmetic import (
    Numbers,
    affine,
    joined,
    mapped,
    mixed,
    picked,
    product,
    total,
    widened,
)
from .sources import Constant, Part, PrimvarRead, Source, TextureRead, UnfitError, numbers
from .texture_coordinates import coordinates

if TYPE_CHECKING:
    from .network import NetworkReader

_MOST_NESTED = 64
WIDTHS = {"color3": 3, "vector3": 3, "color4": 4, "vector4": 4, "vector2": 2}
_TYPE = re.compile(r"_(float|color3|vector3|color4|vector4|vector2|integer|boolean)(FA|CF|VF|VV)?$")
_VERSION = re.compile(r"(_\d+)+$")
PLACES = {"r": 0, "g": 1, "b": 2, "a": 3, "x": 0, "y": 1, "z": 2, "w": 3}
_WRAPS = {"periodic": "repeat", "clamp": "clamp", "mirror": "mirror", "constant": "black"}
_IMAGES = ("image", "tiledimage", "gltf_image", "gltf_colorimage", "gltf_normalmap")
_ONE_NUMBER: dict[str, Callable[[float], float]] = {
    "absval": abs,
    "ceil": math.ceil,
    "cos": math.cos,
    "exp": math.exp,
    "floor": math.floor,
    "ln": math.log,
    "sin": math.sin,
    "sqrt": math.sqrt,
}
_TWO_NUMBERS: dict[str, Callable[[float, float], float]] = {
    "max": max,
    "min": min,
    "modulo": operator.mod,
    "power": math.pow,
}


class NodeValues:
    """Values of the outputs of one material's nodes, each found once."""

    def __init__(self, reader: NetworkReader) -> None:
        self.reader = reader
        self._known: dict[str, Source | UnfitError] = {}
        self._under_way: list[str] = []

    def output(self, attribute: Usd.Attribute, color_space: str = "") -> Source:
        """Value of a node's output; raises UnfitError.

        `color_space` is stated by the input that reads an image.
        """
        key, node = str(attribute.GetPath()), UsdShade.Shader(attribute.GetPrim())
        known = self._known.get(key)
        if known is None:
            if key in self._under_way:
                raise UnfitError(node, "its value comes from itself")
            if len(self._under_way) == _MOST_NESTED:
                raise UnfitError(node, f"it is {_MOST_NESTED} nodes away from the surface")
            self._under_way.append(key)
            try:
                known = self._evaluate(node, attribute, color_space)
            except UnfitError as error:
                known = error
            finally:
                self._under_way.pop()
            self._known[key] = known
        if isinstance(known, UnfitError):
            raise known
        return known

    def input(self, node: UsdShade.Shader, name: str, default: Numbers) -> Source:
        """Value of a node's input, as wide as `default`; raises UnfitError."""
        attribute, is_output = producer(node, name)
        if attribute is None:
            return Constant(default)
        if not is_output:
            found = numbers(self.reader.value(node, name, None))
            return widened(Constant(found or default), len(default))
        space = node.GetInput(name).GetAttr().GetColorSpace()
        return widened(self.output(attribute, space), len(default))

    def constant(self, node: UsdShade.Shader, name: str, default: Numbers) -> Numbers:
        """Value of a node's input that must be constant; raises UnfitError."""
        source = self.input(node, name, default)
        if not isinstance(source, Constant):
            raise UnfitError(node, f"its '{name}' is not constant")
        return source.value

    def _evaluate(
        self, node: UsdShade.Shader, attribute: Usd.Attribute, color_space: str
    ) -> Source:
        output = str(UsdShade.Output(attribute).GetBaseName())
        preview = self.reader.preview_node(node, output)
        if preview is not None:
            return preview
        self.reader.visit(node)
        kind = _VERSION.sub("", str(node.GetIdAttr().Get() or "")).removeprefix("ND_")
        found = _TYPE.search(kind)
        width = WIDTHS.get(found[1], 1) if found else 1
        operation = kind[: found.start()] if found else kind
        while (more := _TYPE.search(operation)) is not None:  # the other types of a conversion
            operation = operation[: more.start()]
        if operation in _IMAGES:
            return self._image(node, operation, kind, width, output, color_space)
        if operation in _ONE_NUMBER:
            function = _ONE_NUMBER[operation]
            return mapped(node, function, self.constant(node, "in", (0.0,) * width))
        if operation in _TWO_NUMBERS:
            return self._two_numbers(node, operation, width)
        method = _OPERATIONS.get(operation)
        if method is None:
            raise UnfitError(node, "glTF has nothing like it")
        return method(self, node, width, kind, output)

    def _image(
        self,
        node: UsdShade.Shader,
        operation: str,
        kind: str,
        width: int,
        output: str,
        color_space: str,
    ) -> Source:
        asset = self.reader.value(node, "file", None)
        if not isinstance(asset, Sdf.AssetPath):
            asset = Sdf.AssetPath("")
        encoded = self._encoding(node, color_space) if "_color" in kind else "raw"
        width = 4 if operation == "gltf_colorimage" else width
        fallback = self.constant(node, "default", (0.0,) * width)
        wrap = [str(self.reader.value(node, f"{axis}addressmode", "periodic")) for axis in "uv"]
        image = TextureRead(
            prim=str(node.GetPath()),
            file=asset.resolvedPath,
            authored_file=asset.path,
            parts=tuple(Part(index, fallback=fallback[index]) for index in range(width)),
            uv=coordinates(self, node, operation),
            wrap=(_WRAPS.get(wrap[0], "repeat"), _WRAPS.get(wrap[1], "repeat")),
            color_space=encoded,
        )
        read: Source = self.reader.tiled(node, image)
        if operation == "gltf_normalmap":
            return affine(node, read, (2.0,) * 3, (-1.0,) * 3)
        if operation == "gltf_image" and node.GetInput("factor"):
            read = product(node, read, self.input(node, "factor", (1.0,) * width))
        if operation == "gltf_colorimage":
            for name in ("color", "geomcolor"):
                read = product(node, read, self.input(node, name, (1.0,) * 4))
            return picked(node, read, (3,) if output == "outa" else (0, 1, 2))
        return read

    def _encoding(self, node: UsdShade.Shader, color_space: str) -> str:
        """Whether texels of a color are sRGB or linear; other color spaces give a warning."""
        attribute, _ = producer(node, "file")
        named = color_space or ("" if attribute is None else attribute.GetColorSpace())
        lower = named.lower()
        if lower in ("", "raw", "none", "auto", "data") or lower.startswith(
            ("lin_rec709", "lin_srgb")
        ):
            return "raw"
        if "srgb" not in lower or "p3" in lower:
            taken = "raw" if lower.startswith(("lin_", "aces")) else "sRGB"
            message = f"the color space '{named}' is not converted, taken as {taken}"
            self.reader.context.ledger.warn("color-space-assumed", node.GetPrim(), message)
            return taken
        return "sRGB"

    def _node_constant(self, node: UsdShade.Shader, width: int, *_: str) -> Source:
        return Constant(self.constant(node, "value", (0.0,) * width))

    def _node_dot(self, node: UsdShade.Shader, width: int, *_: str) -> Source:
        return self.input(node, "in", (0.0,) * width)

    def _node_add(self, node: UsdShade.Shader, width: int, *_: str) -> Source:
        pair = (self.input(node, name, (0.0,) * width) for name in ("in1", "in2"))
        return total(node, *pair)

    def _node_subtract(self, node: UsdShade.Shader, width: int, *_: str) -> Source:
        first, last = (self.input(node, name, (0.0,) * width) for name in ("in1", "in2"))
        return total(node, first, affine(node, last, (-1.0,) * width, (0.0,) * width))

    def _node_multiply(self, node: UsdShade.Shader, width: int, *_: str) -> Source:
        first = self.input(node, "in1", (0.0,) * width)
        return product(node, first, self.input(node, "in2", (1.0,) * width))

    def _node_divide(self, node: UsdShade.Shader, width: int, *_: str) -> Source:
        divisor = self.constant(node, "in2", (1.0,) * width)
        if 0.0 in divisor:
            raise UnfitError(node, "it divides by 0")
        factors = tuple(1.0 / number for number in divisor)
        return affine(node, self.input(node, "in1", (0.0,) * width), factors, (0.0,) * width)

    def _node_invert(self, node: UsdShade.Shader, width: int, *_: str) -> Source:
        amount = self.constant(node, "amount", (1.0,) * width)
        return affine(node, self.input(node, "in", (0.0,) * width), (-1.0,) * width, amount)

    def _node_contrast(self, node: UsdShade.Shader, width: int, *_: str) -> Source:
        amount = self.constant(node, "amount", (1.0,) * width)
        pivot = self.constant(node, "pivot", (0.5,) * width)
        bias = tuple(p - p * a for p, a in zip(pivot, amount, strict=True))
        return affine(node, self.input(node, "in", (0.0,) * width), amount, bias)

    def _node_remap(self, node: UsdShade.Shader, width: int, *_: str) -> Source:
        names = {"inlow": 0.0, "inhigh": 1.0, "outlow": 0.0, "outhigh": 1.0}
        low, high, out_low, out_high = (
            np.array(self.constant(node, name, (default,) * width))
            for name, default in names.items()
        )
        if (low == high).any():
            raise UnfitError(node, "its 'inlow' equals its 'inhigh'")
        scale = (out_high - out_low) / (high - low)
        source = self.input(node, "in", (0.0,) * width)
        return affine(node, source, tuple(scale.tolist()), tuple((out_low - low * scale).tolist()))

    def _node_range(self, node: UsdShade.Shader, width: int, *_: str) -> Source:
        if set(self.constant(node, "gamma", (1.0,) * width)) != {1.0}:
            raise UnfitError(node, "its 'gamma' is not 1")
        ends = {*self.constant(node, "outlow", (0.0,)), *self.constant(node, "outhigh", (1.0,))}
        if self.reader.value(node, "doclamp", False) and not ends <= {0.0, 1.0}:
            raise UnfitError(node, "it clamps to other values than 0 and 1")
        return self._node_remap(node, width)

    def _node_clamp(self, node: UsdShade.Shader, width: int, *_: str) -> Source:
        low = self.constant(node, "low", (0.0,) * width)
        high = self.constant(node, "high", (1.0,) * width)
        source = self.input(node, "in", (0.0,) * width)
        if isinstance(source, Constant):
            return Constant(tuple(np.clip(source.value, low, high).tolist()))
        if max(low) > 0.0 or min(high) < 1.0:  # texels are clamped to 0…1 anyway
            raise UnfitError(node, "it clamps a texture to other values than 0 and 1")
        return source

    def _node_mix(self, node: UsdShade.Shader, width: int, *_: str) -> Source:
        ground, figure = (self.input(node, name, (0.0,) * width) for name in ("bg", "fg"))
        return mixed(node, ground, figure, self.input(node, "mix", (0.0,) * width))

    def _node_normalmap(self, node: UsdShade.Shader, _width: int, kind: str, *_: str) -> Source:
        x, y = (self.constant(node, "scale", (1.0,)) * 2)[:2]
        if "vector2" in kind:
            x, y = self.constant(node, "scale", (1.0, 1.0))
        texel = self.input(node, "in", (0.5, 0.5, 1.0))
        return affine(node, texel, (2.0 * x, 2.0 * y, 2.0), (-x, -y, -1.0))

    def _node_convert(self, node: UsdShade.Shader, width: int, kind: str, *_: str) -> Source:
        given = re.match(r"convert_(\w+?)_", kind)
        count = WIDTHS.get(given[1], 1) if given else 1
        source = self.input(node, "in", (0.0,) * count)
        if count == 1:
            return widened(source, width)
        if count >= width:
            return picked(node, source, tuple(range(width)))
        # Alpha is added as 1, other coordinates as 0.
        end = Constant((1.0 if "color4" in kind[-6:] else 0.0,) * (width - count))
        return joined(node, [source, end])

    def _node_extract(self, node: UsdShade.Shader, width: int, *_: str) -> Source:
        index = int(self.constant(node, "index", (0.0,))[0])
        if not 0 <= index < width:
            raise UnfitError(node, f"its index {index} is not there")
        return picked(node, self.input(node, "in", (0.0,) * width), (index,))

    def _node_separate2(self, node: UsdShade.Shader, width: int, _kind: str, output: str) -> Source:
        place = PLACES.get(output.removeprefix("out"))
        if place is None or place >= width:
            raise UnfitError(node, f"its output '{output}' is not there")
        return picked(node, self.input(node, "in", (0.0,) * width), (place,))

    _node_separate3 = _node_separate4 = _node_separate2

    def _node_swizzle(self, node: UsdShade.Shader, _width: int, kind: str, *_: str) -> Source:
        given = re.match(r"swizzle_(\w+?)_", kind)
        count = WIDTHS.get(given[1], 1) if given else 1
        source = self.input(node, "in", (0.0,) * count)
        chosen: list[Source] = []
        for letter in str(self.reader.value(node, "channels", ""))[:4]:
            if letter in "01":
                chosen.append(Constant((float(letter),)))
            else:
                chosen.append(picked(node, source, (min(PLACES.get(letter, 0), count - 1),)))
        if not chosen:
            raise UnfitError(node, "it names no channels")
        return joined(node, chosen)

    def _node_combine2(self, node: UsdShade.Shader, width: int, kind: str, *_: str) -> Source:
        widths = {"color4CF": (3, 1), "vector4VF": (3, 1), "vector4VV": (2, 2)}
        counts = next((w for end, w in widths.items() if kind.endswith(end)), (1,) * width)
        parts = [self.input(node, f"in{n + 1}", (0.0,) * count) for n, count in enumerate(counts)]
        return joined(node, parts)

    _node_combine3 = _node_combine4 = _node_combine2

    def _node_geompropvalue(self, node: UsdShade.Shader, width: int, *_: str) -> Source:
        name = str(self.reader.value(node, "geomprop", ""))
        return PrimvarRead(name, self.constant(node, "default", (0.0,) * width))

    def _node_geomcolor(self, *_: object) -> Source:
        return PrimvarRead("displayColor", None)

    def _two_numbers(self, node: UsdShade.Shader, operation: str, width: int) -> Source:
        first = self.input(node, "in1", (0.0,) * width)
        neutral = 1.0 if operation in ("modulo", "power") else 0.0
        last = self.constant(node, "in2", (neutral,) * width)
        if operation == "power" and set(last) == {1.0}:
            return first
        if not isinstance(first, Constant):
            raise UnfitError(node, f"glTF has no '{operation}' of a texture")
        return mapped(node, _TWO_NUMBERS[operation], first.value, last)


_PREFIX = "_node_"
_OPERATIONS: dict[str, Callable[[NodeValues, UsdShade.Shader, int, str, str], Source]] = {
    name.removeprefix(_PREFIX): method
    for name, method in vars(NodeValues).items()
    if name.startswith(_PREFIX)
}
"""Methods by the node's name, which follows the prefix in theirs."""
