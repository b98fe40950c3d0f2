"""Owns which deviations a warning of the sidecar excuses; docs/usd.md lists the same names.

Wherever the documentation gives the rule by which the file's value follows from the stage's, the
truth computes that value (`usd_rules`) and nothing is excused.
"""

from __future__ import annotations

SUBTREE = ("animation-resampled", "prim-damaged")
"""Warnings that speak of their prim and of all below it; every other one of its prim alone."""
PLACED = ("animation-resampled",)
"""Places that deviate by at most what the warning states, and nothing else of the prim."""
ABSENT = ("prim-damaged",)
"""A prim of any type that is not in the file."""
MESH_LIGHT = ("mesh-light-dropped", "Volume-dropped")
"""Light that points and curves send."""
UNORDERED_COLORS = ("primvar-interpolation-dropped",)
"""Display colors on parts of a gprim whose order USD does not define, by the primvar's name."""
UV_SET = ("primvar-*",)
"""A primvar that the warning names in quotes is not in the file."""
UV_CONSTANT = ("uv-missing",)
"""Constant that replaces a set without a primvar."""
LEFT_OUT = ("invisible-skipped", "purpose-skipped", "prim-damaged")
"""A prim and all below it have no node."""
TRANSLUCENT = ("opacity-approximated",)
"""A displayColor that blends although no corner that is drawn is translucent."""
EXTRAS = ("attribute-dropped",)
"""A property outside all schemas that the warning names in quotes."""
OTHER_SURFACE = ("material-unsupported", "material-approximated")
UNKNOWN_SURFACE = ("material-unsupported",)
NOT_READ = ("asset-outside-roots", "asset-not-a-file")
"""A layer that a prim names and that is outside the folders, or no plain file."""
NO_PLACE = {
    "displacement": "displacement-dropped",
    "normal": "normal-constant-dropped",
    "occlusion": "occlusion-dropped",
}
"""Constant inputs of a UsdPreviewSurface that no glTF material holds."""
NO_TEXTURE = ("material-texture-dropped",)
"""The texture of an input that is one number in glTF; its default counts."""
FROZEN_INPUT = ("material-animation-frozen",)
"""Keys of an attribute of a material, which the warning names in quotes."""
# What follows excuses nothing: it chooses the rule by which the truth computes a texture.
PACKED = ("texture-packed-transform",)
"""A texture that is placed as another one it was packed with."""
REWRITTEN = ("texture-repacked", "texture-converted")
"""A texture whose texels were resized, by the rule that the truth follows."""
UNREAD_FILE = ("texture-too-large", "asset-not-a-file")
LOST_FILE = (*UNREAD_FILE, "asset-outside-roots", "texture-missing", "texture-unreadable")
"""A texture whose fallback counts."""
NORMAL_SCALE = ("normal-scale-missing",)
_DOMES = ("DomeLight", "DomeLight_1")
_NO_LIGHTS = ("GeometryLight", "PluginLight")


def absent(kind: str) -> tuple[str, ...]:
    """The warnings by which a prim of type `kind` may be missing."""
    if kind in _DOMES:
        return (*ABSENT, "dome-light-external")
    if kind == "PortalLight":
        return (*ABSENT, "portal-light-ignored")
    if kind in _NO_LIGHTS:
        return (*ABSENT, "light-dropped")
    if kind.endswith("Curves"):
        return (*ABSENT, "curves-dropped")
    return (*ABSENT, f"{kind}-dropped")
