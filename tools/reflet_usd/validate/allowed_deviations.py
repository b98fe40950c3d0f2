"""Owns which deviations a warning of the sidecar excuses; docs/usd.md lists the same names.

Wherever the documentation gives the rule by which the file's value follows from the stage's, the
truth computes that value (`usd_rules`) and nothing is excused.
"""

SUBTREE = ("animation-resampled", "prim-damaged")
"""Warnings that apply to their prim and all below it; others apply to their prim alone."""
PLACED = ("animation-resampled",)
"""Warnings that allow places alone to deviate, by a stated length."""
DISPLACED = ("displacement-sampled",)
"""Warning by which the corners of a mesh deviate by a stated length, and its shape with them."""
ABSENT = ("prim-damaged",)
"""Warnings by which a prim of any type may be missing from the file."""
MESH_LIGHT = ("mesh-light-dropped", "Volume-dropped")
"""Warnings about lost light that points and curves send."""
UNORDERED_COLORS = ("primvar-interpolation-dropped",)
"""Warnings about display colors on parts of a gprim whose order USD does not define."""
UV_SET = ("primvar-*",)
"""Warnings that a primvar, named in quotes, is not in the file."""
UV_CONSTANT = ("uv-missing",)
"""Warning about a constant that replaces a UV set without a primvar."""
LEFT_OUT = ("invisible-skipped", "purpose-skipped", "lod-skipped", "prim-damaged")
"""Warnings by which a prim and all below it have no node."""
UNLIT = ("splats-approximated",)
"""Warning about points that hold the light that they show."""
TRANSLUCENT = ("opacity-approximated",)
"""Warning about a displayColor that blends although no drawn corner is translucent."""
EXTRAS = ("attribute-dropped",)
"""Warning about a property outside all schemas, named in quotes."""
OTHER_SURFACE = ("material-unsupported", "material-approximated")
UNKNOWN_SURFACE = ("material-unsupported",)
NOT_READ = ("asset-outside-roots", "asset-not-a-file")
"""Warnings about a layer that a prim names and that is outside the folders, or no plain file."""
NO_PLACE = {
    "displacement": "displacement-dropped",
    "normal": "normal-constant-dropped",
    "occlusion": "occlusion-dropped",
}
"""Constant inputs of a UsdPreviewSurface that no glTF material holds."""
NO_TEXTURE = ("material-texture-dropped",)
"""Warning about the texture of an input that is one number in glTF; the input's default counts."""
FROZEN_INPUT = ("material-animation-frozen",)
"""Warning about keys of a material's attribute, named in quotes, that are dropped."""
# The next constants excuse nothing: they choose the rule by which the truth computes a texture.
PACKED = ("texture-packed-transform",)
"""Warning about a texture that is placed like another one it was packed with."""
REWRITTEN = ("texture-repacked", "texture-converted")
"""Warnings about a texture whose texels were resized, by the rule that the truth follows."""
UNREAD_FILE = ("texture-too-large", "asset-not-a-file")
LOST_FILE = (*UNREAD_FILE, "asset-outside-roots", "texture-missing", "texture-unreadable")
"""Warnings about a lost texture file, whose fallback value counts."""
UNFIT_NODE = ("material-unsupported", "pattern-baked")
"""Warning about a shading node that the file cannot follow."""
NORMAL_SCALE = ("normal-scale-missing",)
_NO_LIGHTS = ("GeometryLight", "PluginLight")


def absent(kind: str) -> tuple[str, ...]:
    """Warnings by which a prim of type `kind` may be missing."""
    if kind == "PortalLight":
        return (*ABSENT, "portal-light-ignored")
    if kind in _NO_LIGHTS:
        return (*ABSENT, "light-dropped")
    if kind.endswith("Curves"):
        return (*ABSENT, "curves-dropped")
    return (*ABSENT, f"{kind}-dropped")
