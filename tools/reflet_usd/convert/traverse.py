"""Walks the composed stage and builds the node tree, one node per prim with a place in space."""

import time
from dataclasses import dataclass, field

import numpy as np
from pxr import Usd, UsdGeom, UsdLux, UsdVol

from .animation import Visibility, add_visibility_track, own_visibility, transform_node
from .camera import add_camera
from .collection import keep_collections
from .context import Context, authored, type_name
from .curves import LineBuilder, draws_lines
from .extras import keep_custom_properties
from .geometry import BuiltMesh, GeometryBuilder, is_surface
from .gltf_writer import GltfWriter
from .held_frames import draw_held, held_codes
from .instancer import Instancers
from .level_of_detail import unshown_level
from .light import add_light
from .light_size import Emitter, size_lights
from .loose_primvars import keep_loose_primvars
from .mesh_light import add_geometry_light, keep_mesh_light
from .metadata import keep_metadata, warn_schemas, what_is_lost
from .morph import point_keys
from .node_depth import check_depth, check_level, levels_to
from .scene import Node
from .skel import Skeletons
from .splats import SPLATS, SplatBuilder
from .subsets import note_binding_purposes
from .unreadable_values import DAMAGE, reason_of_damage
from .xform import column_matrix, place

# Prims that live inside materials, skeletons or meshes: they have no place in space.
_PLACELESS = ("Material", "Shader", "NodeGraph", "GeomSubset", "SkelAnimation", "BlendShape")
# Types that only group other prims, and so need no counterpart.
_GROUPS = ("", "Xform", "Scope", "SkelRoot", "Skeleton")
PROGRESS_S = 5.0


@dataclass
class Tree:
    """A node tree under construction: the stage's own, or an instancer prototype's."""

    root: Node
    unplaced: list[Node] = field(default_factory=list)
    """Skinned meshes, which ignore their own transform and so stand beside the root."""
    contents: dict[str, Node] = field(default_factory=dict)
    """Node that takes the children of a prim, by prim path."""
    purposes: dict[str, UsdGeom.Imageable.PurposeInfo] = field(default_factory=dict)
    visibilities: dict[str, Visibility] = field(default_factory=dict)
    """Animated visibility of a prim including all above it, by prim path."""
    levels: dict[str, int] = field(default_factory=dict)
    """Level of a prim's node by prim path, the root being the first."""
    prototype: bool = False
    """Whether this is an instancer's prototype."""

    def parent_of(self, prim: Usd.Prim) -> Node:
        """The node under which `prim` belongs."""
        return self.contents.get(str(prim.GetPath().GetParentPath()), self.root)


class Traversal:
    """One conversion's walk; it also walks prototypes on behalf of instancers."""

    def __init__(self, context: Context, writer: GltfWriter) -> None:
        self.context = context
        self.writer = writer
        self.geometry = GeometryBuilder(context, writer)
        self.skeletons = Skeletons(context, writer, self.geometry)
        self.instancers = Instancers(context, writer, self.geometry, self.prototype_node)
        self._emitters: dict[int, Emitter] = {}
        self._visited = 0
        self._last_report = time.monotonic()

    def stage_roots(self) -> list[Node]:
        """The scene's nodes: one root that turns Z-up into Y-up, and skinned meshes beside it."""
        root = Node("stage", "/")
        if self.context.z_up:
            half = float(np.sqrt(0.5))
            root.rotation = np.array([-half, 0.0, 0.0, half])
        tree = Tree(root)
        predicate = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
        for prim in self.context.stage.GetPseudoRoot().GetFilteredChildren(predicate):
            self._walk(Usd.PrimRange(prim, predicate), tree)
        self._place_lost_skeletons(root)
        roots = [root, *tree.unplaced]
        check_depth(roots)
        size_lights(self.context, self.writer, roots, self._emitters)
        return roots

    def _place_lost_skeletons(self, root: Node) -> None:
        """Place the skeletons below prims that were left out: they still move bound prims."""
        for prim in self.skeletons.unattached():
            xformable = UsdGeom.Xformable(prim)
            matrix = xformable.ComputeLocalToWorldTransform(self.context.time)
            node = Node(prim.GetName(), str(prim.GetPath()))
            root.add(place(node, column_matrix(matrix, self.context.meters_per_unit)))
            self.skeletons.add_joints(prim, node)

    def prototype_node(self, prim: Usd.Prim) -> Node:
        """An instancer's prototype as a detached tree, its own transform included."""
        tree = Tree(Node(prim.GetName()), prototype=True)
        # A prototype may sit below an undefined `over`: it need not be defined all the way up.
        predicate = Usd.TraverseInstanceProxies(
            Usd.PrimIsActive & Usd.PrimIsLoaded & Usd.PrimHasDefiningSpecifier
        )
        self._walk(Usd.PrimRange(prim, predicate), tree)
        tree.root.children.extend(tree.unplaced)
        return tree.root

    def _walk(self, prims: Usd.PrimRange, tree: Tree) -> None:
        iterator = iter(prims)
        for prim in iterator:
            if not self._visit(prim, tree):
                iterator.PruneChildren()

    def _visit(self, prim: Usd.Prim, tree: Tree) -> bool:
        """Place one prim; False where its children are not walked."""
        self._visited += 1
        self.context.visited = str(prim.GetPath())
        self._report_progress()
        try:
            warn_variants(self.context, prim)
            node = self._place(prim, tree)
        except DAMAGE as error:
            message = f"{reason_of_damage(prim, error)}; it and all below it are left out"
            self.context.ledger.skip_subtree("prim-damaged", prim, message)
            return False
        if node is None:
            return type_name(prim) in _PLACELESS
        try:
            if prim.IsA(UsdGeom.Imageable) and self._has_other_purpose(prim, tree):
                return not prim.IsA(UsdGeom.PointInstancer)
            return self._fill(prim, node)
        except DAMAGE as error:
            message = f"{reason_of_damage(prim, error)}; it is left out"
            if not prim.IsA(UsdGeom.PointInstancer):  # its children have nodes of their own
                self.context.ledger.warn("prim-damaged", prim, message)
                return True
            self.context.ledger.skip_subtree("prim-damaged", prim, f"{message} with its prototypes")
            return False

    def _report_progress(self) -> None:
        """Print a progress line every few seconds; short conversions print nothing."""
        now = time.monotonic()
        if now - self._last_report > PROGRESS_S:
            self._last_report = now
            print(f"converting: {self._visited} prims so far", flush=True)

    def _place(self, prim: Usd.Prim, tree: Tree) -> Node | None:
        """The prim's node in its place, still empty; None where the prim gets none."""
        kind = type_name(prim)
        if kind in _PLACELESS:
            self._keep_words(prim, None)
            return None
        level = unshown_level(prim, self.context.time)
        if level:
            self.context.ledger.skip_subtree("lod-skipped", prim, level)
            return None
        # A hidden skeleton still moves what it is bound to.
        if kind != "Skeleton" and prim.IsA(UsdGeom.Imageable) and self._is_hidden(prim):
            message = "the prim is invisible; it and all below it are left out"
            self.context.ledger.skip_subtree("invisible-skipped", prim, message)
            return None
        if kind == "SkelRoot":
            self.skeletons.enter(prim)
        if kind in ("SkelRoot", "Skeleton"):
            self.skeletons.warn_ignored_binding(prim)
        node, outer, reset = transform_node(self.context, prim)
        skinned = self.skeletons.is_skinned(prim)
        path = str(prim.GetPath())
        tree.contents[path] = node
        lifted = skinned or reset
        above = 1 if lifted else tree.levels.get(str(prim.GetPath().GetParentPath()), 1)
        tree.levels[path] = above + levels_to(outer, node)
        check_level(tree.levels[path], path)
        if skinned:
            node.translation = node.rotation = node.scale = None
            node.tracks.clear()
            tree.unplaced.append(node)
        elif reset:
            if tree.prototype and tree.root.children:
                message = "within a prototype it is placed from each instance on, as in Hydra"
                self.context.ledger.warn("reset-in-prototype", prim, message)
            tree.root.add(outer)
        else:
            tree.parent_of(prim).add(outer)
        self._keep_words(prim, node)
        self._show(prim, tree, node, lifted)
        return node

    def _keep_words(self, prim: Usd.Prim, node: Node | None) -> None:
        """Keep properties and metadata that do not draw; a prim without a node keeps none."""
        names = [str(name) for name in prim.GetAuthoredPropertyNames()]
        keep_custom_properties(self.context, prim, node, names)
        keep_loose_primvars(self.context, prim, node, names)
        keep_collections(self.context, prim, node, names)
        note_binding_purposes(self.context, prim, names)
        keep_metadata(self.context, prim, node)
        warn_schemas(self.context, prim)

    def _show(self, prim: Usd.Prim, tree: Tree, node: Node, lifted: bool) -> None:
        """Animate visibility; a node `lifted` to the root takes its parents' visibility along."""
        above = tree.visibilities.get(str(prim.GetPath().GetParentPath()))
        own = own_visibility(self.context, prim) if prim.IsA(UsdGeom.Imageable) else None
        whole = above if own is None else own.within(above)
        if whole is not None:
            tree.visibilities[str(prim.GetPath())] = whole
        add_visibility_track(self.context, node, whole if lifted else own)

    def _is_hidden(self, prim: Usd.Prim) -> bool:
        attribute = UsdGeom.Imageable(prim).GetVisibilityAttr()
        if attribute.Get(self.context.time) != UsdGeom.Tokens.invisible:
            return False
        codes = self.context.codes_in_range(sorted(attribute.GetTimeSamples()))
        return all(attribute.Get(code) == UsdGeom.Tokens.invisible for code in codes)

    def _has_other_purpose(self, prim: Usd.Prim, tree: Tree) -> bool:
        """Whether a gprim's purpose is not kept; purposes inherit unless authored again."""
        parent = tree.purposes.get(str(prim.GetPath().GetParentPath()))
        imageable = UsdGeom.Imageable(prim)
        info = imageable.ComputePurposeInfo(parent) if parent else imageable.ComputePurposeInfo()
        tree.purposes[str(prim.GetPath())] = info
        draws = prim.IsA(UsdGeom.Gprim) or prim.IsA(UsdGeom.PointInstancer)
        if not draws or info.purpose in self.context.options.purpose:
            return False
        kept = ",".join((*self.context.options.purpose, info.purpose))
        message = f"purpose '{info.purpose}' is not kept; choose it with --purpose {kept}"
        self.context.ledger.skip_subtree("purpose-skipped", prim, message)
        return True

    def _fill(self, prim: Usd.Prim, node: Node) -> bool:
        """Add the prim's content to its node; False where its children are not walked."""
        context, ledger = self.context, self.context.ledger
        kind = type_name(prim)
        before = len(node.children)
        if prim.IsA(UsdGeom.PointInstancer):
            self.instancers.fill(prim, node)
            if prim.GetAttribute("angularVelocities").HasAuthoredValue():
                message = "angularVelocities are not carried, orientations are interpolated"
                ledger.warn("velocities-dropped", prim, message)
            return False
        if self.skeletons.is_bound(prim):
            self.skeletons.fill(prim, node)
        elif is_surface(prim):
            codes = held_codes(context, prim)
            keys = None if codes else point_keys(context, self.writer, prim)
            if codes:
                draw_held(context, node, codes, lambda: self.geometry.build(prim))
            elif self._draw(node, self.geometry.build(prim, keys)) and keys is not None:
                keys.animate(node)
        elif draws_lines(prim) or kind == SPLATS:
            builder = SplatBuilder if kind == SPLATS else LineBuilder
            lines = builder(context, self.writer, self.geometry.materials, prim)
            codes = held_codes(context, prim)
            if codes:
                draw_held(context, node, codes, lines.build)
            else:
                self._draw(node, lines.build())
        elif prim.IsA(UsdGeom.Camera):
            add_camera(context, self.writer, prim, node)
        elif kind == "GeometryLight":
            add_geometry_light(context, self.geometry.lights, prim)
        elif prim.HasAPI(UsdLux.LightAPI) and not prim.IsA(UsdGeom.Gprim):
            emitter = add_light(context, self.writer, prim, node)
            if emitter is not None and node.light is not None:
                self._emitters[node.light] = emitter
        elif kind == "Skeleton":
            self.skeletons.add_joints(prim, node)
        elif kind not in _GROUPS:
            self._warn_dropped(prim)
            return True
        if prim.IsA(UsdGeom.Gprim) and prim.HasAPI(UsdLux.LightAPI):
            keep_mesh_light(context, prim, node, node.mesh is not None and is_surface(prim))
        placed = node.mesh is not None or node.camera is not None or node.light is not None
        if placed or kind in _GROUPS or len(node.children) > before:
            ledger.carry(prim)
        return True

    def _draw(self, node: Node, built: BuiltMesh | None) -> bool:
        """Give `node` a mesh, where the prim has one."""
        if built is None:
            return False
        node.mesh = built.index
        node.extras.update(built.extras)
        return True

    def _warn_dropped(self, prim: Usd.Prim) -> None:
        kind = type_name(prim)
        if prim.IsA(UsdGeom.Gprim) or prim.IsA(UsdGeom.Imageable):
            name = "curves-dropped" if kind.endswith("Curves") else f"{kind}-dropped"
            message = _volume_message(prim) or f"glTF has no counterpart of the type {kind}"
        else:
            message = f"glTF has no place for a {kind}; {what_is_lost(kind)}"
            name = "schema-ignored"
        self.context.ledger.warn(name, prim, message)


def _volume_message(prim: Usd.Prim) -> str:
    """Loss of a volume, or of a field of one, in words; empty for all other prims."""
    if prim.IsA(UsdVol.FieldBase):
        return "the field of a volume, which is not drawn"
    if not prim.IsA(UsdVol.Volume):
        return ""
    fields = []
    for name, path in sorted(UsdVol.Volume(prim).GetFieldPaths().items()):
        field = prim.GetStage().GetPrimAtPath(path)
        file = authored(field, "filePath", Usd.TimeCode.EarliestTime(), "") if field else ""
        fields.append(f"'{name}' {file}".rstrip())
    listed = f" ({', '.join(fields)})" if fields else ""
    return f"its smoke, fire or cloud is not drawn: glTF has no grids of densities{listed}"


def warn_variants(context: Context, prim: Usd.Prim) -> None:
    """Warn about variant sets, of which the file keeps the selected variant only."""
    if not prim.HasVariantSets():
        return
    sets = prim.GetVariantSets()
    for name in sets.GetNames():
        known = sets.GetVariantSet(name).GetVariantNames()
        chosen, count = sets.GetVariantSelection(name), len(known)
        if chosen not in known and known:
            message = f"none of {count} variants of '{name}' is carried, '{chosen}' is selected"
            context.ledger.warn("variants-not-carried", prim, message)
        elif count > 1:
            message = f"of {count} variants of '{name}' only '{chosen}' is carried"
            context.ledger.warn("variants-not-carried", prim, message)
