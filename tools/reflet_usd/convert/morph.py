"""Morph targets, and animated points as one target for each key."""

import numpy as np
from pxr import Usd

from .context import Context, in_float32, type_name
from .gltf_writer import GltfWriter
from .mesh import computed_normals, drawn_faces
from .nurbs import read_patch
from .polygons import Polygons
from .primitive import PrimitiveParts
from .samples import seconds_of
from .scene import Array, Node
from .surface import Surface

MAX_POINT_KEYS = 128
MAX_KEYED_POINTS = 20_000_000
_TOPOLOGY = ("faceVertexCounts", "faceVertexIndices", "holeIndices")


def morph_target(
    writer: GltfWriter,
    surface: Surface,
    parts: PrimitiveParts,
    polygons: Polygons | None,
    offsets: Array,
    normal_offsets: Array | None,
) -> dict[str, int]:
    """Morph target of one primitive: `offsets` (N, 3) of the points, and of the normals."""
    target = {"POSITION": writer.add_floats(offsets[parts.points], bounds=True)}
    normals = surface.normals
    if normals is None or polygons is None:
        return target
    if normal_offsets is not None and polygons.scheme == "none":
        target["NORMAL"] = writer.add_floats(normal_offsets[parts.points])
    elif polygons.computed_normals:
        moved = computed_normals(polygons, surface.points + offsets, drawn_faces(polygons))
        ids = normals.ids[parts.vertices.corners]
        target["NORMAL"] = writer.add_floats(moved.values[ids] - normals.values[ids])
    return target


class PointKeys:
    """Animated points of a mesh with constant topology: key k is target k at weight 1.

    Weights that run linearly from one target to the next are USD's linear interpolation.
    """

    def __init__(
        self, context: Context, writer: GltfWriter, codes: list[float], keys: Array
    ) -> None:
        self.context = context
        self.writer = writer
        self.shape_names = [f"points at {code:g}" for code in codes[1:]]
        self._codes = codes
        self._keys = keys

    def prepare(self, surface: Surface, polygons: Polygons | None) -> None:
        """Keep nothing: the first key is the mesh itself."""
        del polygons
        surface.points = self._keys[0]

    def finish(self, surface: Surface, parts: PrimitiveParts, polygons: Polygons | None) -> None:
        """Add a target for each later key."""
        parts.entry["targets"] = [
            morph_target(self.writer, surface, parts, polygons, key - self._keys[0], None)
            for key in self._keys[1:]
        ]

    def animate(self, node: Node) -> None:
        """Animate the weights so that they run through the keys."""
        weights = np.vstack([np.zeros(len(self._keys) - 1), np.eye(len(self._keys) - 1)])
        node.add_track("weights", seconds_of(self.context, self._codes), weights)


def point_keys(context: Context, writer: GltfWriter, prim: Usd.Prim) -> PointKeys | None:
    """The keys of a mesh with animated points; None where it has none or they cannot travel."""
    attribute = prim.GetAttribute("points")
    if not attribute or not attribute.ValueMightBeTimeVarying():
        return None
    codes = context.codes_in_range(sorted(attribute.GetTimeSamples()))
    if len(codes) < 2:
        return None
    reason = ""
    if any(prim.GetAttribute(name).ValueMightBeTimeVarying() for name in _TOPOLOGY):
        reason = "the topology changes too, in too many frames"
    elif context.options.subdiv_level > 0:
        reason = "refined meshes do not move"
    elif len(codes) > MAX_POINT_KEYS:
        reason = f"there are more than {MAX_POINT_KEYS} keys"
    values = [] if reason else [attribute.Get(code) for code in codes]
    while values and not values[0]:  # before the first value nothing is drawn
        values, codes = values[1:], codes[1:]
    lengths = {0 if value is None else len(value) for value in values}
    if not reason and len(values) < 2:
        return None
    if not reason and (len(lengths) != 1 or 0 in lengths):
        reason = "the number of points changes"
    elif not reason and len(codes) * max(lengths) > MAX_KEYED_POINTS:
        reason = f"the keys hold more than {MAX_KEYED_POINTS} points"
    keys: Array = np.zeros((0, 0, 3))
    if not reason:
        keys = np.array(values, dtype=np.float64) * context.meters_per_unit
        reason = "" if in_float32(keys).all() else "some points are not finite"
    if not reason and type_name(prim) == "NurbsPatch":
        patch = read_patch(context, prim)
        if patch is None or patch.size != keys.shape[1]:
            return None  # the patch's own conversion warns
        # Surface points are weighted means of control points, so they are linear in them.
        keys = np.stack([patch.evaluate(np.asarray(key)) for key in keys])
    if reason:
        message = f"animated points stay at their first value: {reason}"
        context.ledger.warn("points-animation-frozen", prim, message)
        return None
    return PointKeys(context, writer, codes, keys)
