"""Gprims to glTF meshes: surface, primvars, subsets and materials joined, instances shared."""

import math
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
from pxr import Usd, UsdGeom

from .attributes import DisplayColor, GprimPrimvars, Streams, inherited_primvars, primvar_signature
from .channel_packing import texture_transform, wraps_to_black
from .context import Context, authored, source_path, type_name
from .displacement import displace, is_displacing, may_displace
from .extras import is_custom
from .gltf_writer import GltfWriter
from .gprim import GPRIM_TYPES, cube_polygons, tessellate
from .material import MaterialLibrary, MaterialPlan, Painter, Tint, painter_of, warn_translucent
from .mesh import mesh_surface
from .mesh_light import MeshLights
from .nurbs import patch_polygons, patch_topology
from .polygons import Polygons, read_polygons, tet_polygons
from .primitive import PrimitiveParts, build_primitive
from .primvars import Topology
from .refine import REFINABLE
from .scene import Array, Node
from .sources import Constant, Part, PrimvarRead, Source, TextureRead
from .subsets import FaceGroup, face_groups
from .surface import Surface
from .types import MOST_STEPS

# Coordinates this far outside 0…1 come from rounding, not from tiling.
_UV_SLACK = 1e-4


@dataclass
class BuiltMesh:
    """A glTF mesh that was written, with the facts that deformations need."""

    index: int
    extras: dict[str, Any]
    """Extras of the node: constants that have no place in the mesh."""


def mesh_extras(prim: Usd.Prim, streams: Streams) -> dict[str, Any]:
    """Extras of a mesh: the path of the prim, and the primvars of attributes that were renamed."""
    extras: dict[str, Any] = {"prim": str(prim.GetPath())}
    return extras | ({"primvarOf": streams.renamed} if streams.renamed else {})


class Deformer(Protocol):
    """Skins and blend shapes, added to a mesh while it is built."""

    shape_names: list[str]

    def prepare(self, surface: Surface, polygons: Polygons | None) -> None:
        """Read the deformation; called once, before primitives are made."""

    def finish(self, surface: Surface, parts: PrimitiveParts, polygons: Polygons | None) -> None:
        """Add the deformation's attributes and targets; called for each primitive."""


class GeometryBuilder:
    """Converts gprims; equal prims of native instances give one mesh."""

    def __init__(self, context: Context, writer: GltfWriter) -> None:
        self.context = context
        self.writer = writer
        self.materials = MaterialLibrary(context, writer)
        self.lights = MeshLights(context)
        self._meshes: dict[tuple[Any, ...], tuple[Usd.Prim, BuiltMesh | None]] = {}
        self._tinted: dict[tuple[int, Tint], int] = {}

    def build(self, prim: Usd.Prim, deformation: Deformer | None = None) -> BuiltMesh | None:
        """The glTF mesh of a gprim, or None (with a warning) where it has nothing to draw."""
        groups = face_groups(self.context, prim)
        primvars = inherited_primvars(prim)
        if deformation is not None:
            return self._build(prim, groups, primvars, deformation)
        bound = tuple("" if g.material is None else source_path(g.material) for g in groups)
        glow, when = self.lights.glow(prim), self.context.time.GetValue()
        moves = any(may_displace(group.material) for group in groups)
        shape = _stretch(self._placement(prim)).tobytes() if moves else b""
        key = (source_path(prim), bound, primvar_signature(primvars), glow, when, shape)
        if key not in self._meshes:
            self._meshes[key] = (prim, self._build(prim, groups, primvars, None))
            return self._meshes[key][1]
        first, built = self._meshes[key]
        self.context.ledger.repeat(first, prim)
        for group in groups:
            self.materials.plan(group.material)
        return built

    def _placement(self, prim: Usd.Prim) -> Array:
        """(3, 3) matrix that places vectors of a prim in the stage; of flattened ones the unit."""
        world = UsdGeom.Imageable(prim).ComputeLocalToWorldTransform(self.context.time)
        linear = np.array(world)[:3, :3]
        size = float(np.abs(linear).max())
        usable = 0.0 < size < math.inf and abs(np.linalg.det(linear / size)) > 1e-6
        return linear if usable else np.eye(3)

    def _build(
        self,
        prim: Usd.Prim,
        groups: list[FaceGroup],
        owned: list[UsdGeom.Primvar],
        deformation: Deformer | None,
    ) -> BuiltMesh | None:
        warn_frozen(self.context, prim, owned)
        made = self._surface(prim, deformation is not None)
        if made is None:
            return None
        surface, topology, polygons = made
        primvars = GprimPrimvars(self.context, prim, owned)
        streams = primvars.streams(topology)
        surface.uvs, surface.custom = streams.uvs, streams.custom
        if deformation is not None:
            deformation.prepare(surface, polygons)
        parts_of = [(group, _triangles(surface, topology, group)) for group in groups]
        parts_of = [(group, chosen) for group, chosen in parts_of if len(chosen)]
        if deformation is None and polygons is not None:
            self._displace(prim, surface, polygons, parts_of)
        entries = []
        painters: list[Painter | None] = []
        for group, chosen in parts_of:
            parts, painter = self._primitive(surface, chosen, group, primvars, topology)
            painters.append(painter)
            if deformation is not None:
                deformation.finish(surface, parts, polygons)
            entries.append(parts.entry)
        if not entries:
            self.context.ledger.warn("mesh-empty", prim, "no face is left to draw")
            return None
        mesh: dict[str, Any] = {
            "name": prim.GetName(),
            "primitives": entries,
            "extras": mesh_extras(prim, streams),
        }
        if deformation is not None and deformation.shape_names:
            mesh["weights"] = [0.0] * len(deformation.shape_names)
            mesh["extras"]["targetNames"] = deformation.shape_names
        extras = {"primvars": primvars.constants} if primvars.constants else {}
        index = self.writer.add("meshes", mesh)
        self.materials.painters[index] = painters
        return BuiltMesh(index, extras)

    def tint(self, node: Node, tint: Tint) -> Node:
        """A copy of a prototype whose gprims without a display color of their own show `tint`."""
        copy = node.clone()
        for inner in copy.walk():
            if inner.mesh in self.materials.painters:
                inner.mesh = self._tint(inner.mesh, tint)
        return copy

    def _tint(self, index: int, tint: Tint) -> int:
        painters = self.materials.painters[index]
        if not any(painters):
            return index
        if (index, tint) not in self._tinted:
            mesh = self.writer.lists["meshes"][index]
            primitives = [
                entry if painter is None else {**entry, "material": painter(tint)}
                for entry, painter in zip(mesh["primitives"], painters, strict=True)
            ]
            entry = {**mesh, "primitives": primitives}
            self._tinted[index, tint] = self.writer.add("meshes", entry)
        return self._tinted[index, tint]

    def _surface(
        self, prim: Usd.Prim, deformed: bool
    ) -> tuple[Surface, Topology, Polygons | None] | None:
        if type_name(prim) == "Cube":
            made = mesh_surface(self.context, prim, cube_polygons(self.context, prim), 0)
            return (
                None if made is None else (made[0], replace(made[1], assumed_order=True), made[2])
            )
        if type_name(prim) == "NurbsPatch":
            made = mesh_surface(self.context, prim, patch_polygons(self.context, prim), 0)
            if made is None:
                return None
            return made[0], patch_topology(self.context, prim, made[1]), made[2]
        if type_name(prim) == "TetMesh":
            return mesh_surface(self.context, prim, tet_polygons(self.context, prim), 0)
        if type_name(prim) in GPRIM_TYPES:
            curved = tessellate(self.context, prim)
            return None if curved is None else (*curved, None)
        # Joint influences and blend shapes refer to the cage's points.
        level = 0 if deformed else self.context.options.subdiv_level
        return mesh_surface(self.context, prim, read_polygons(self.context, prim), level)

    def _displace(
        self,
        prim: Usd.Prim,
        surface: Surface,
        polygons: Polygons,
        groups: list[tuple[FaceGroup, Array]],
    ) -> None:
        """Move the points as the materials say, in units of the stage, as usdview shows it."""
        plans = [self.materials.plan(group.material) for group, _ in groups]
        parts = [
            (plan.inputs.get("displacement"), chosen)
            for plan, (_, chosen) in zip(plans, groups, strict=True)
        ]
        if not any(is_displacing(source) for source, _ in parts):
            return
        scaled = [_scaled(source, self.context.meters_per_unit) for source, _ in parts]
        parts = [(source, chosen) for source, (_, chosen) in zip(scaled, parts, strict=True)]
        placement = self._placement(prim)
        diagonal = float(np.linalg.norm(np.ptp(surface.points @ placement, axis=0)))
        longest = displace(self.materials.packer, surface, polygons, parts, _stretch(placement))
        if not math.isfinite(longest):
            return  # the materials tell that they lose their displacement
        surface.is_displaced = True
        if longest == 0.0:
            return
        named = ", ".join(f"'{plan.prim.GetName()}'" for plan in plans if plan.prim is not None)
        message = f"it is displaced by {named} at {len(surface.points)} points alone"
        level = self.context.options.subdiv_level
        if polygons.scheme in REFINABLE and level < MOST_STEPS:
            message += f"; refine with --subdiv {min(level + 2, MOST_STEPS)}"
        self.context.ledger.warn("displacement-sampled", prim, message, longest / diagonal)

    def _primitive(
        self,
        surface: Surface,
        triangles: Array,
        group: FaceGroup,
        primvars: GprimPrimvars,
        topology: Topology,
    ) -> tuple[PrimitiveParts, Painter | None]:
        prim, plan = primvars.prim, self.materials.plan(group.material)
        order, constants = self._uv_order(prim, surface, plan)
        readers = (plan.color_primvar, plan.opacity_primvar)
        display = primvars.display(topology, *readers, plan.color_fallback)
        warn_translucent(self.context, prim, plan, display)
        color = display.stream_for(*(reader is not None for reader in readers))
        parts = build_primitive(self.writer, surface, triangles, order, constants, color)
        glow = self.lights.glow(prim)
        # Seen from behind as well, as usdview shows it; but a lamp does not shine backwards.
        double_sided = glow is None or bool(authored(prim, "doubleSided", self.context.time, False))
        self._warn_black_wraps(surface, triangles, plan)
        slots = {name: slot for slot, name in enumerate(order)}
        overrides = self._constants(plan, primvars)
        if surface.is_displaced:
            overrides["displacement"] = Constant((0.0,))

        def paint(shown: DisplayColor) -> int:
            return self.materials.instantiate(
                plan, slots, double_sided, shown, color is not None, overrides, glow
            )

        parts.entry["material"] = paint(display)
        if group.subset is not None:
            parts.entry["extras"] = {"prim": str(group.subset.GetPath())}
        return parts, painter_of(readers, primvars, display, paint)

    def _constants(self, plan: MaterialPlan, primvars: GprimPrimvars) -> dict[str, Constant]:
        """Values of inputs that read a primvar with one value on the gprim."""
        found = {}
        for name, source in plan.inputs.items():
            if not isinstance(source, PrimvarRead) or name in ("diffuseColor", "opacity"):
                continue
            value = primvars.constants.get(source.primvar)
            numbers = np.ravel(value) if value is not None else np.zeros(0)
            if numbers.dtype.kind in "if" and 1 <= len(numbers) <= 4:
                found[name] = Constant(tuple(float(number) for number in numbers))
            elif source.primvar in primvars.custom or source.fallback is None:
                message = f"'{name}' reads primvar '{source.primvar}', its fallback is used"
                self.context.ledger.warn("primvar-reader-dropped", primvars.prim, message)
        return found

    def _warn_black_wraps(self, surface: Surface, triangles: Array, plan: MaterialPlan) -> None:
        """Warn about textures that are black outside 0…1, where coordinates leave that range."""
        for name, source in sorted(plan.inputs.items()):
            if not isinstance(source, TextureRead) or not wraps_to_black(source):
                continue
            stream = surface.uvs.get(source.uv.primvar)
            if stream is not None and not texture_transform(source):
                used = stream.values[stream.ids[triangles.reshape(-1)]]
                if used.min() >= -_UV_SLACK and used.max() <= 1.0 + _UV_SLACK:
                    continue
            message = f"'{name}' is black outside 0…1 (wrap {source.wrap[0]}, {source.wrap[1]}),"
            message += " glTF repeats the edge instead"
            self.context.ledger.warn("wrap-black-clamped", source.prim, message)

    def _uv_order(
        self, prim: Usd.Prim, surface: Surface, plan: MaterialPlan
    ) -> tuple[list[str], dict[str, tuple[float, float]]]:
        """UV sets for TEXCOORD_0…: those the material reads first, then `st`, then by name."""
        constants = {}
        for name, fallback in plan.uv_sets.items():
            if name not in surface.uvs:
                constants[name] = fallback
                message = f"the material reads UV set '{name}', which the prim does not have"
                self.context.ledger.warn("uv-missing", prim, message)
        others = [name for name in surface.uvs if name not in plan.uv_sets]
        others.sort(key=lambda name: (name != "st", name))
        return [*plan.uv_sets, *others], constants


def _stretch(placement: Array) -> Array:
    """(M Mᵀ)⁻¹ of a matrix M, rounded so that it is equal for all rotations."""
    inverse = np.linalg.inv(placement @ placement.T)
    most = float(np.abs(inverse).max())
    return np.asarray(np.round(inverse / most, 6) * float(f"{most:.6g}"))


def _scaled(source: Source | None, factor: float) -> Source | None:
    """A displacement in other units."""
    if isinstance(source, Constant):
        return Constant((source.value[0] * factor,))
    if isinstance(source, TextureRead):
        part = source.parts[0]
        scaled = (part.scale * factor, part.bias * factor, part.fallback * factor)
        return replace(source, parts=(Part(part.channel, *scaled),))
    return source


def _triangles(surface: Surface, topology: Topology, group: FaceGroup) -> Array:
    """(n, 3) corners of the triangles of a group."""
    if group.faces is None:
        return surface.triangles
    member = np.zeros((topology.authored or topology).face_count, dtype=bool)
    member[group.faces] = True
    return surface.triangles[member[surface.triangle_faces]]


_OTHER_SURFACES = ("NurbsPatch", "TetMesh")
STILL = ("accelerations", "xformOp", "visibility", "extent", "velocities", "primvars:skel:")
"""Beginnings of the names of attributes that change no geometry, or have rules of their own."""


def warn_frozen(context: Context, prim: Usd.Prim, primvars: list[UsdGeom.Primvar]) -> None:
    """Name the animated attributes, inherited `primvars` too, that stay at their first value."""
    animated = [
        attribute.GetName()
        for attribute in prim.GetAuthoredAttributes()
        if not attribute.GetName().startswith((*STILL, "points", "normals"))
        and attribute.ValueMightBeTimeVarying()
        and not is_custom(prim, attribute.GetName())
    ]
    if _draws_normals(prim) and prim.GetAttribute("normals").ValueMightBeTimeVarying():
        animated.append("normals")
    owners = [(p.GetAttr(), str(p.GetName())) for p in primvars]
    animated += [
        name
        for attribute, name in owners
        if name not in animated and attribute.ValueMightBeTimeVarying()
    ]
    if context.is_held:
        animated = [name for name in animated if not prim.HasAttribute(name)]
    velocities = prim.GetAttribute("velocities")
    if velocities and velocities.HasAuthoredValue():
        message = "velocities are not carried, points are interpolated"
        context.ledger.warn("velocities-dropped", prim, message)
    values = [name for name in animated if name.startswith("primvars:")]
    shape = [name for name in animated if name not in values]
    context.ledger.warn_frozen("geometry-animation-frozen", prim, shape)
    context.ledger.warn_frozen("primvar-animation-frozen", prim, values)


def _draws_normals(prim: Usd.Prim) -> bool:
    """Whether the attribute `normals` counts: only on meshes that are not subdivision surfaces."""
    mesh = UsdGeom.Mesh(prim)
    if not mesh or mesh.GetSubdivisionSchemeAttr().Get() != UsdGeom.Tokens.none:
        return False
    primvar = UsdGeom.PrimvarsAPI(prim).GetPrimvar("normals")
    return not (primvar and primvar.HasValue())


def warn_still_points(context: Context, prim: Usd.Prim) -> None:
    """Warn about animated attributes of points and curves, which stand still in the file."""
    warn_frozen(context, prim, UsdGeom.PrimvarsAPI(prim).FindPrimvarsWithInheritance())
    points = prim.GetAttribute("points")
    if points and points.ValueMightBeTimeVarying() and not context.is_held:
        context.ledger.warn_frozen("points-animation-frozen", prim, ["points"])


def is_surface(prim: Usd.Prim) -> bool:
    """Whether `GeometryBuilder` can build this prim."""
    kind = type_name(prim)
    return prim.IsA(UsdGeom.Mesh) or kind in GPRIM_TYPES or kind in _OTHER_SURFACES
