"""Reader of shading networks: surface inputs become constants, texture reads or primvars."""

from dataclasses import replace
from typing import Any

import numpy as np
from pxr import Sdf, Usd, UsdShade

from .context import Context, producer
from .node_values import NodeValues
from .pattern import SIDE, pattern
from .sources import Constant, Part, PrimvarRead, Source, TextureRead, UnfitError, UvRead, numbers
from .texture_coordinates import coordinates

_CHANNELS = {"r": (0,), "g": (1,), "b": (2,), "a": (3,), "rgb": (0, 1, 2), "rgba": (0, 1, 2)}
_MAX_TRANSFORMS = 8
_MOST_PATTERNS = 64
"""Images of patterns in a file."""

# MaterialX twins of the preview nodes: same inputs, other identifiers.
_TWINS = {
    "ND_UsdPreviewSurface_surfaceshader": "UsdPreviewSurface",
    "ND_UsdUVTexture": "UsdUVTexture",
    "ND_UsdUVTexture_23": "UsdUVTexture",
    "ND_UsdTransform2d": "UsdTransform2d",
}


class NetworkReader:
    """Follows connections of one material and warns about what it cannot follow."""

    def __init__(self, context: Context, material: Usd.Prim) -> None:
        self.context = context
        self.material = material
        self.nodes: set[str] = set()
        """Paths, relative to the material, of the nodes that were followed."""
        self.values = NodeValues(self)
        self._patterns: dict[Sdf.Path, TextureRead] = {}

    def visit(self, node: UsdShade.Shader) -> None:
        """Remember a node, and the node graphs around it, as part of the material."""
        path, root = node.GetPath(), self.material.GetPath()
        while path.HasPrefix(root) and path != root:
            self.nodes.add(str(path.MakeRelativePath(root)))
            path = path.GetParentPath()

    def source(self, shader: UsdShade.Shader, name: str) -> Source | None:
        """The source of input `name`, or None where nothing is authored."""
        shader_input = shader.GetInput(name)
        if not shader_input:
            return None
        attribute, is_output = producer(shader, name)
        if attribute is None:
            if shader_input.HasConnectedSource():
                message = f"'{name}' is connected to nothing that exists"
                self.context.ledger.warn("shader-connection-invalid", shader.GetPrim(), message)
            return None
        if is_output:
            return self._node(shader, name, attribute)
        found = numbers(self.read(attribute))
        return None if found is None else Constant(found)

    def _node(self, shader: UsdShade.Shader, name: str, attribute: Usd.Attribute) -> Source | None:
        try:
            color_space = shader.GetInput(name).GetAttr().GetColorSpace()
            return self.values.output(attribute, color_space)
        except UnfitError as error:
            return self._pattern(name, attribute, error)

    def _pattern(self, name: str, attribute: Usd.Attribute, unfit: UnfitError) -> Source | None:
        """Image of a pattern that glTF cannot compute; where it is none, `unfit` is told."""
        known = self._patterns.get(attribute.GetPath())
        if known is not None:
            return known
        try:
            found = pattern(self.values, attribute, _MOST_PATTERNS)
        except UnfitError as error:
            found, unfit = None, error
        if found is None:
            self.warn_unfit(name, unfit)
            return None
        self._patterns[attribute.GetPath()] = found
        message = f"'{name}' is an image of {SIDE} x {SIDE} pixels of its pattern, which repeats"
        self.context.ledger.warn("pattern-baked", attribute.GetPrim(), message)
        return found

    def warn_unfit(self, name: str, error: UnfitError) -> None:
        """Name a node that gives an input of the surface a value which glTF cannot hold."""
        kind = error.node.GetIdAttr().Get() or "without id"
        message = f"'{name}' comes from the node {kind}, which cannot be followed: {error}"
        self.context.ledger.warn("material-unsupported", error.node.GetPrim(), message)

    def preview_node(self, node: UsdShade.Shader, output: str) -> Source | None:
        """Value of a node of UsdPreviewSurface's specification; None for others."""
        kind = shader_id(node)
        if kind == "UsdUVTexture":
            return self._texture(node, output)
        if kind.startswith("UsdPrimvarReader"):
            self.visit(node)
            fallback = numbers(self.value(node, "fallback", None))
            return PrimvarRead(str(self.value(node, "varname", "")), fallback)
        return None

    def value(self, shader: UsdShade.Shader, name: str, fallback: Any) -> Any:
        """A plain input value, followed through material interfaces."""
        attribute, is_output = producer(shader, name)
        value = None if attribute is None or is_output else self.read(attribute)
        return fallback if value is None else value

    def read(self, attribute: Usd.Attribute) -> Any:
        """The attribute's first value; None, with a warning, where a number is not finite."""
        value = attribute.Get(self.context.time)
        if attribute.ValueMightBeTimeVarying():
            message = f"animated '{attribute.GetName()}' stays at its first value"
            self.context.ledger.warn("material-animation-frozen", attribute.GetPrim(), message)
        if value is None or isinstance(value, (str, Sdf.AssetPath)) or _all_finite(value):
            return value
        message = f"'{attribute.GetName()}' is {value}, its fallback is used"
        self.context.ledger.warn("material-value-invalid", attribute.GetPrim(), message)
        return None

    def _texture(self, node: UsdShade.Shader, output: str) -> TextureRead | None:
        self.visit(node)
        asset = self.value(node, "file", None)
        if not isinstance(asset, Sdf.AssetPath):
            asset = Sdf.AssetPath(str(asset) if asset else "")
        scale, bias, fallback = (
            self._four(node, name, default)
            for name, default in (("scale", 1.0), ("bias", 0.0), ("fallback", 0.0))
        )
        read = TextureRead(
            prim=str(node.GetPath()),
            file=asset.resolvedPath,
            authored_file=asset.path,
            parts=tuple(
                Part(channel, scale[channel], bias[channel], fallback[channel])
                for channel in _CHANNELS.get(output, (0, 1, 2))
            ),
            uv=self._uv(node),
            wrap=(
                str(self.value(node, "wrapS", "useMetadata")),
                str(self.value(node, "wrapT", "useMetadata")),
            ),
            color_space=str(self.value(node, "sourceColorSpace", "auto")),
        )
        return self.tiled(node, read)

    def _four(self, node: UsdShade.Shader, name: str, default: float) -> tuple[float, ...]:
        """Four numbers of an input; alpha's fallback is 1."""
        known = (default, default, default, 1.0 if name == "fallback" else default)
        found = numbers(self.value(node, name, None))
        return (*found, *known[len(found) :]) if found and len(found) in (3, 4) else known

    def tiled(self, node: UsdShade.Shader, read: TextureRead) -> TextureRead:
        """The read of all tiles, where the file's name stands for several."""
        if "<UDIM>" not in read.authored_file:
            return read
        spec = node.GetInput("file").GetAttr().GetPropertyStack(self.context.time)
        layer = spec[0].layer if spec else self.context.stage.GetRootLayer()
        found = UsdShade.UdimUtils.ResolveUdimTilePaths(read.authored_file, layer)
        numbers = [(int(number) - 1001, path) for path, number in found]
        tiles = sorted((number % 10, number // 10, path) for number, path in numbers if number >= 0)
        if not tiles:
            return replace(read, file="")
        return replace(read, file=f"{tiles[0][2]} {len(tiles)}").tiled(tuple(tiles))

    def _uv(self, node: UsdShade.Shader) -> UvRead:
        """The UV set behind `st`, with at most one UsdTransform2d; more are a warning."""
        uv = UvRead()
        name = "st"
        transforms = 0
        passed = {node.GetPath()}
        for _ in range(_MAX_TRANSFORMS):
            attribute, is_output = producer(node, name)
            if attribute is None:
                if transforms == 0 and not node.GetInput(name):
                    message = "'st' is not connected, taken as the primvar 'st'"
                    self.context.ledger.warn("uv-assumed", node.GetPrim(), message)
                    return uv
                return replace(uv, primvar="")
            if not is_output:
                found = numbers(self.read(attribute)) or (0.0, 0.0)
                return replace(uv, primvar="", fallback=_pair(found))
            source, node = node, UsdShade.Shader(attribute.GetPrim())
            kind = shader_id(node)
            if kind.startswith("ND_") and transforms == 0:
                return coordinates(self.values, source, kind, name)
            self.visit(node)
            if node.GetPath() in passed:
                message = "the texture coordinates come from themselves, taken as 'st'"
                self.context.ledger.warn("shader-cycle", node.GetPrim(), message)
                return UvRead()
            passed.add(node.GetPath())
            if kind == "UsdTransform2d":
                transforms += 1
                if transforms > 1:
                    message = "only the first of several chained UsdTransform2d is carried"
                    self.context.ledger.warn("uv-transform-dropped", node.GetPrim(), message)
                else:
                    uv = self._transform(node, uv)
                name = "in"
                continue
            if not kind.startswith("UsdPrimvarReader"):
                message = f"texture coordinates come from the node {kind}, taken as 'st'"
                self.context.ledger.warn("material-unsupported", node.GetPrim(), message)
                return uv
            fallback = numbers(self.value(node, "fallback", None)) or (0.0, 0.0)
            varname = str(self.value(node, "varname", "st") or "st")
            return replace(uv, primvar=varname, fallback=_pair(fallback))
        return uv

    def _transform(self, node: UsdShade.Shader, uv: UvRead) -> UvRead:
        scale = numbers(self.value(node, "scale", None)) or (1.0, 1.0)
        translation = numbers(self.value(node, "translation", None)) or (0.0, 0.0)
        rotation = numbers(self.value(node, "rotation", None)) or (0.0,)
        return replace(
            uv, scale=_pair(scale), rotation_deg=rotation[0], translation=_pair(translation)
        )


def shader_id(shader: UsdShade.Shader) -> str:
    """The node's identifier; MaterialX twins of preview nodes get the preview name."""
    if not shader:
        return ""
    identifier = shader.GetIdAttr().Get()
    name = "" if identifier is None else str(identifier)
    if name.startswith("ND_UsdPrimvarReader"):
        return name.removeprefix("ND_")
    return _TWINS.get(name, name)


def _all_finite(value: Any) -> bool:
    try:
        return bool(np.isfinite(np.array(value, dtype=np.float64)).all())
    except (TypeError, ValueError):
        return True  # values without numbers


def _pair(values: tuple[float, ...]) -> tuple[float, float]:
    """The first two values; a missing second one is the first."""
    return values[0], values[1] if len(values) > 1 else values[0]
