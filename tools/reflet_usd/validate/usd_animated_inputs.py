"""Owns the search for animated attributes of a material, which change its look over time."""

from collections.abc import Iterable, Iterator

from pxr import Usd, UsdShade

from .usd_material import DEFAULTS, producer, surface_shader
from .usd_materialx import surface_inputs

_SURFACE = {*DEFAULTS, "displacement", "opacityMode", "useSpecularWorkflow"}
_TEXTURE = ("file", "st", "wrapS", "wrapT", "sourceColorSpace", "scale", "bias", "fallback")
_TRANSFORM = "UsdTransform2d"
_PLACED = ("scale", "rotation", "translation")
_NODES = {
    "UsdUVTexture": _TEXTURE,
    "UsdPrimvarReader": ("fallback", "varname"),
    _TRANSFORM: ("in", *_PLACED),
    "image": ("file", "uaddressmode", "vaddressmode"),
    "gltf_image": ("file", "uaddressmode", "vaddressmode"),
    "gltf_colorimage": ("file", "uaddressmode", "vaddressmode"),
    "tiledimage": ("file", "uaddressmode", "vaddressmode", "uvtiling", "uvoffset"),
}
"""Inputs that count, by the start of a node's identifier, without MaterialX's `ND_`."""
_DEEPEST = 16


def animated_inputs(material: Usd.Prim) -> set[tuple[str, str]]:
    """Prim and name of each animated attribute behind the surface that the file shows."""
    shader = surface_shader(material)
    if shader is None:
        return set()
    return set(_behind(shader, surface_inputs(shader) or _SURFACE, _DEEPEST, False))


def _behind(
    shader: UsdShade.Shader, names: Iterable[str], deepest: int, placed: bool
) -> Iterator[tuple[str, str]]:
    """Animated attributes behind some inputs; of chained transforms (`placed`) the first counts."""
    for name in names:
        attribute = producer(shader.GetInput(name))
        if attribute is None or (placed and name in _PLACED):
            continue
        if UsdShade.Input.IsInput(attribute):
            if attribute.ValueMightBeTimeVarying():
                yield str(attribute.GetPath().GetPrimPath()), str(attribute.GetName())
            continue
        node = UsdShade.Shader(attribute.GetPrim())
        kind = str(node.GetIdAttr().Get()).removeprefix("ND_")
        known = next((names for start, names in _NODES.items() if kind.startswith(start)), ())
        if deepest > 0:
            again = shader.GetIdAttr().Get() in (_TRANSFORM, f"ND_{_TRANSFORM}")
            yield from _behind(node, known, deepest - 1, again and kind == _TRANSFORM)
