"""Owns evaluating MaterialX node graphs at texture coordinates, number by number."""

import re
from collections.abc import Callable

import numpy as np
from pxr import Sdf, Usd, UsdShade

from .images import Texels, sample
from .scene_data import Array
from .usd_material import TIME, input_value, load_texture, producer

_WIDTH = {"float": 1, "integer": 1, "boolean": 1, "vector2": 2, "color4": 4, "vector4": 4}
_LETTERS = "rgbaxyzw"
_WRAPS = {"clamp": "clamp", "constant": "clamp", "mirror": "mirror"}
_DEEPEST = 64
_TWO: dict[str, Callable[[Array, Array], Array]] = {
    "add": np.add,
    "subtract": np.subtract,
    "multiply": np.multiply,
    "divide": np.divide,
    "min": np.minimum,
    "max": np.maximum,
    "power": np.power,
}


class UnknownError(Exception):
    """A value that is not evaluated."""


class NodeValues:
    """Values of a material's nodes; every primvar has the coordinates `st`."""

    def __init__(self, roots: tuple[str, ...]) -> None:
        self.roots = roots
        self.primvars: set[str] = set()
        """Primvars that gave coordinates so far."""
        self.images: set[str] = set()
        """Paths of the image nodes that were read so far."""
        self.sizes: set[tuple[int, int]] = set()
        """Sizes of their images."""
        self.nodes: set[str] = set()
        """Paths of all nodes that were read so far."""
        self._depth = 0
        self._read: tuple[str, Texels | None] = ("", None)
        """The image that was read last, some 0.5 GiB where it is large."""

    def _texels(self, path: str) -> Texels | None:
        if path != self._read[0]:
            self._read = ("", None)
            self._read = (path, load_texture(path, self.roots))
        return self._read[1]

    def value(
        self, node: UsdShade.Shader, name: str, default: tuple[float, ...], st: Array
    ) -> Array:
        """Values (n, len(default)) of an input; raises UnknownError."""
        attribute = producer(node.GetInput(name))
        count = len(st)
        if attribute is None:
            return np.tile(np.array(default, dtype=np.float64), (count, 1))
        if UsdShade.Input.IsInput(attribute):
            found = attribute.Get(TIME)
            row = default if found is None else np.array(found, dtype=np.float64).reshape(-1)
            row = np.array(row if np.isfinite(row).all() else default)
            return np.tile(np.resize(row, len(default)), (count, 1))
        self._depth += 1
        if self._depth > _DEEPEST:
            raise UnknownError("too many nodes")
        try:
            values = self._output(attribute, node.GetInput(name).GetAttr().GetColorSpace(), st)
        finally:
            self._depth -= 1
        return np.resize(values.T, (len(default), count)).T if values.shape[1] == 1 else values

    def _output(self, attribute: Usd.Attribute, space: str, st: Array) -> Array:
        node = UsdShade.Shader(attribute.GetPrim())
        self.nodes.add(str(node.GetPath()))
        kind = re.sub(r"(_\d+)+$", "", str(node.GetIdAttr().Get())).removeprefix("ND_")
        base, _, types = kind.partition("_")
        if kind.startswith("gltf_"):
            base, _, types = kind.removeprefix("gltf_").partition("_")
            base = f"gltf_{base}"
        last = re.sub(r"(FA|CF|VF|VV)$", "", types.rpartition("_")[2])
        width = _WIDTH.get(last, 3)
        output = str(UsdShade.Output(attribute).GetBaseName())
        zero, one = (0.0,) * width, (1.0,) * width
        if base in ("image", "tiledimage", "gltf_image", "gltf_colorimage", "gltf_normalmap"):
            return self._image(node, base, types, output, space, st)
        if base in ("texcoord", "geompropvalue"):
            index = int(input_value(node, "index", 0))
            named = str(input_value(node, "geomprop", f"st{index}" if index else "st"))
            if width != 2:
                raise UnknownError("a primvar that is no coordinate")
            self.primvars.add(named)
            return st
        if base in _TWO:
            first = self.value(node, "in1", zero, st)
            second = one if base in ("multiply", "divide", "power") else zero
            return _TWO[base](first, self.value(node, "in2", second, st))
        if base == "constant":
            return self.value(node, "value", zero, st)
        if base in ("place2d", "rotate2d"):
            return self._placed(node, base, st)
        if base.startswith(("combine", "separate")) or base in ("extract", "convert", "swizzle"):
            return self._rearranged(node, base, types, width, output, st)
        return self._adjusted(node, base, types, width, st)

    def _adjusted(
        self, node: UsdShade.Shader, base: str, types: str, width: int, st: Array
    ) -> Array:
        zero, one = (0.0,) * width, (1.0,) * width

        def of(name: str, default: tuple[float, ...]) -> Array:
            return self.value(node, name, default, st)

        if base == "dot":
            return of("in", zero)
        if base == "invert":
            return of("amount", one) - of("in", zero)
        if base == "mix":
            share = of("mix", zero)
            return of("fg", zero) * share + of("bg", zero) * (1.0 - share)
        if base == "clamp":
            return np.clip(of("in", zero), of("low", zero), of("high", one))
        if base == "contrast":
            pivot = of("pivot", (0.5,) * width)
            return (of("in", zero) - pivot) * of("amount", one) + pivot
        if base in ("remap", "range"):
            low, high = of("inlow", zero), of("inhigh", one)
            share = (of("in", zero) - low) / (high - low)
            return of("outlow", zero) + share * (of("outhigh", one) - of("outlow", zero))
        if base == "normalmap":
            size = (1.0, 1.0) if "vector2" in types else (1.0,)
            scale = np.resize(of("scale", size).T, (2, len(st))).T
            return (of("in", (0.5, 0.5, 1.0)) * 2.0 - 1.0) * np.column_stack([scale, st[:, 0] ** 0])
        raise UnknownError(f"the node {base}")

    def _rearranged(
        self, node: UsdShade.Shader, base: str, types: str, width: int, output: str, st: Array
    ) -> Array:
        if base.startswith("combine"):
            count = int(base[-1])
            pieces = {"CF": (3, 1), "VF": (3, 1), "VV": (2, 2)}.get(types[-2:], (1,) * count)
            parts = (self.value(node, f"in{i + 1}", (0.0,) * n, st) for i, n in enumerate(pieces))
            return np.column_stack(list(parts))
        given = _WIDTH.get(types.split("_")[0], 3)
        values = self.value(node, "in", (0.0,) * given, st)
        if base.startswith("separate"):
            return values[:, [_LETTERS.index(output.removeprefix("out")) % 4]]
        if base == "extract":
            return values[:, [int(input_value(node, "index", 0))]]
        if base == "convert":
            if given == 1:
                return np.repeat(values, width, axis=1)
            end = float(types.endswith("color4"))
            return np.column_stack([values, np.full((len(st), width), end)])[:, :width]
        letters = str(input_value(node, "channels", ""))
        constants = np.column_stack([values, np.zeros(len(st)), np.ones(len(st))])
        places = [given + int(c) if c in "01" else _LETTERS.index(c) % 4 for c in letters]
        return constants[:, places]

    def _placed(self, node: UsdShade.Shader, base: str, st: Array, gltf: bool = False) -> Array:
        def of(name: str, default: tuple[float, ...]) -> Array:
            return self.value(node, name, default, st)

        if base == "rotate2d":
            return _turned(of("in", (0.0, 0.0)), of("amount", (0.0,)))
        pivot = of("pivot", (0.0, 1.0) if gltf else (0.0, 0.0))
        uv = (of("texcoord", (0.0, 0.0)) if node.GetInput("texcoord") else st) - pivot
        scale, turn, move = of("scale", (1.0, 1.0)), of("rotate", (0.0,)), of("offset", (0.0, 0.0))
        if gltf:
            scale, turn, move = 1.0 / scale, -turn, move * (-1.0, 1.0)
        if int(input_value(node, "operationorder", 0)):
            return _turned(uv - move, turn) / scale + pivot
        return _turned(uv / scale, turn) - move + pivot

    def _image(
        self, node: UsdShade.Shader, base: str, types: str, output: str, space: str, st: Array
    ) -> Array:
        width = _WIDTH.get(types.rpartition("_")[2], 3)
        source = producer(node.GetInput("file"))
        asset = source.Get(TIME) if source is not None else None
        path = asset.resolvedPath if isinstance(asset, Sdf.AssetPath) else ""
        texels = self._texels(path)
        self.images.add(str(node.GetPath()))
        if texels is None or "<UDIM>" in path:
            raise UnknownError("its image cannot be read")
        self.sizes.add(texels.size)
        if base.startswith("gltf_"):
            uv = self._placed(node, "place2d", st, gltf=True)
        else:
            uv = self.value(node, "texcoord", (0.0, 0.0), st) if node.GetInput("texcoord") else st
        if not node.GetInput("texcoord"):
            self.primvars.add("st")
        if base == "tiledimage":
            uv = uv * self.value(node, "uvtiling", (1.0, 1.0), st)
            uv = uv - self.value(node, "uvoffset", (0.0, 0.0), st)
            uv = uv / self.value(node, "realworldimagesize", (1.0, 1.0), st)
            uv = uv * self.value(node, "realworldtilesize", (1.0, 1.0), st)
        modes = [str(input_value(node, f"{axis}addressmode", "periodic")) for axis in "uv"]
        first, second = (_WRAPS.get(mode, "repeat") for mode in modes)
        named = (space or (source.GetColorSpace() if source else "")).lower()
        color = base == "gltf_colorimage" or "color" in types
        down = np.column_stack([uv[:, 0], 1.0 - uv[:, 1]])
        linearize = color and "srgb" in named and not named.startswith("lin")
        rgba = sample(texels, down, (first, second), linearize)
        if base == "gltf_normalmap":
            return rgba[:, :3] * 2.0 - 1.0
        if base == "gltf_colorimage":
            for name in ("color", "geomcolor"):
                rgba = rgba * self.value(node, name, (1.0,) * 4, st)
            return rgba[:, 3:] if output == "outa" else rgba[:, :3]
        if base == "gltf_image" and node.GetInput("factor"):
            return rgba[:, :width] * self.value(node, "factor", (1.0,) * width, st)
        return rgba[:, :width]


def _turned(uv: Array, degrees: Array) -> Array:
    """Coordinates turned clockwise."""
    angle = np.radians(degrees[:, 0])
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.column_stack(
        [cosine * uv[:, 0] + sine * uv[:, 1], cosine * uv[:, 1] - sine * uv[:, 0]]
    )
