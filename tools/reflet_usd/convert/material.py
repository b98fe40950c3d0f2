"""Bound materials to plans, and plans to glTF materials for the prims that use them."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from pxr import Usd, UsdShade

from .attributes import DisplayColor, GprimPrimvars
from .channel_packing import Packer
from .context import Context, source_path
from .displacement import is_displacing, may_displace
from .gltf_writer import GltfWriter
from .materialx import MATERIALX_SURFACES, approximate
from .mesh_light import Glow, shine
from .network import NetworkReader, shader_id
from .preview_surface import DIELECTRIC_F0, PREVIEW_INPUTS
from .sources import Constant, PrimvarRead, Source, TextureRead
from .surface_layers import LayeredMaterial

_RENDER_CONTEXTS = ("", "glslfx", "mtlx")
# UsdPreviewSurface's roughness, for surfaces that have a color and nothing else.
DISPLAY_ROUGHNESS = 0.5


@dataclass
class MaterialPlan:
    """A bound material that was read but not written yet, and its needs from the meshes."""

    prim: Usd.Prim | None
    inputs: dict[str, Source] = field(default_factory=dict)
    is_preview: bool = False
    uv_sets: dict[str, tuple[float, float]] = field(default_factory=dict)
    """UV sets that textures read, with the reader's fallback."""
    color_primvar: str | None = "displayColor"
    """The primvar that COLOR_0's red, green and blue come from, if any."""
    opacity_primvar: str | None = "displayOpacity"
    color_fallback: tuple[float, ...] = PREVIEW_INPUTS["diffuseColor"]
    nodes: set[str] = field(default_factory=set)
    """Shading nodes that were read, by path relative to the material."""


CLEAR = 1.0 / 255.0
"""Opacity below which a surface is glass rather than blended."""
DISPLAY = ("displayColor", "displayOpacity")
Tint = tuple[float | None, ...]
"""Red, green, blue and opacity that an instance gives; None where it gives none."""
Painter = Callable[[Tint], int]
"""Material of a primitive in the tint of an instance."""


class MaterialLibrary:
    """All materials of one conversion."""

    def __init__(self, context: Context, writer: GltfWriter) -> None:
        self.context = context
        self.writer = writer
        self.packer = Packer(context, writer)
        self._plans: dict[str, MaterialPlan] = {}
        self._written: dict[tuple[Any, ...], int] = {}
        self.painters: dict[int, list[Painter | None]] = {}
        """For each primitive, by mesh, how it shows the tint of an instance."""

    def plan(self, prim: Usd.Prim | None) -> MaterialPlan:
        """The plan of a material prim, or for None the plan for plain displayColor."""
        if prim is None:
            return MaterialPlan(None)
        key = source_path(prim)
        if key not in self._plans:
            self._plans[key] = self._read(prim)
        plan = self._plans[key]
        if plan.is_preview:
            self.context.ledger.carry(prim)
        if plan.prim is not None and plan.prim != prim:
            self.context.ledger.repeat(plan.prim, prim)
        for node in plan.nodes:  # each instance of the material has these nodes
            path = prim.GetPath().AppendPath(node)
            self.context.ledger.carry(path)
            if plan.prim is not None and plan.prim != prim:
                self.context.ledger.repeat(plan.prim.GetPath().AppendPath(node), path)
        return plan

    def instantiate(
        self,
        plan: MaterialPlan,
        slots: dict[str, int],
        double_sided: bool,
        display: DisplayColor,
        has_colors: bool,
        overrides: dict[str, Constant] | None = None,
        glow: Glow | None = None,
    ) -> int:
        """The glTF material of `plan` for a primitive with these UV slots and colors.

        `overrides` are inputs whose primvar has one value on the prim; `glow` is its emission
        as a light.
        """
        used_slots = tuple((name, slots[name]) for name in plan.uv_sets if name in slots)
        uses_display = plan.color_primvar is not None or plan.opacity_primvar is not None
        constant = (display.constant, display.translucent) if uses_display else None
        inputs = {**plan.inputs, **(overrides or {})}
        path = "" if plan.prim is None else str(plan.prim.GetPath())
        changed = tuple(sorted((overrides or {}).items()))
        key = (path, used_slots, double_sided, constant, has_colors, changed, glow)
        if key not in self._written:
            entry = self._entry(plan, inputs, slots, display, has_colors)
            if double_sided:
                entry["doubleSided"] = True
            if glow is not None:
                shine(self.writer, entry, glow)
            self._written[key] = self.writer.add_once("materials", entry)
        return self._written[key]

    def _read(self, prim: Usd.Prim) -> MaterialPlan:
        material = UsdShade.Material(prim)
        shader = None
        for render_context in _RENDER_CONTEXTS if material else ():
            shader, _, _ = material.ComputeSurfaceSource(render_context)
            if shader:
                break
        kind = shader_id(shader) if shader else ""
        reader = NetworkReader(self.context, prim)
        if kind == "UsdPreviewSurface":
            sources = {name: reader.source(shader, name) for name in PREVIEW_INPUTS}
            inputs = {name: source for name, source in sources.items() if source is not None}
        elif kind in MATERIALX_SURFACES:
            inputs = approximate(reader, prim, shader, kind)
        else:
            what = "shader with no name" if shader else "material without a surface shader"
            what = f"shader '{kind}'" if kind else what
            message = f"a {what} has no glTF counterpart, displayColor is shown"
            self.context.ledger.warn("material-unsupported", prim, message)
            return MaterialPlan(prim)
        if str(reader.value(shader, "opacityMode", "transparent")) != "presence":
            inputs |= _as_glass(inputs)
        reader.visit(shader)
        self._warn_displacement(material)
        if not may_displace(prim) and is_displacing(inputs.pop("displacement", None)):
            message = "outputs:displacement is not connected, so that the input moves nothing"
            self.context.ledger.warn("displacement-dropped", prim, message)
        plan = self._planned(prim, inputs)
        plan.nodes = reader.nodes
        return plan

    def _planned(self, prim: Usd.Prim, inputs: dict[str, Source]) -> MaterialPlan:
        plan = MaterialPlan(prim, is_preview=True)
        plan.color_primvar = plan.opacity_primvar = None
        for name, source in inputs.items():
            if isinstance(source, PrimvarRead) and name == "diffuseColor":
                plan.color_primvar = source.primvar
                plan.color_fallback = _three(source.fallback or plan.color_fallback)
            elif isinstance(source, PrimvarRead) and name == "opacity":
                plan.opacity_primvar = source.primvar
            elif isinstance(source, TextureRead) and self.packer.usable(source):
                plan.uv_sets.setdefault(source.uv.primvar, source.uv.fallback)
            plan.inputs[name] = source
        return plan

    def _warn_displacement(self, material: UsdShade.Material) -> None:
        for output in (material.ComputeDisplacementSource(), material.ComputeVolumeSource()):
            if output[0] and shader_id(output[0]) != "UsdPreviewSurface":
                message = "displacement and volume shaders have no glTF counterpart"
                self.context.ledger.warn("displacement-dropped", output[0].GetPrim(), message)

    def _entry(
        self,
        plan: MaterialPlan,
        inputs: dict[str, Source],
        slots: dict[str, int],
        display: DisplayColor,
        has_colors: bool,
    ) -> dict[str, Any]:
        if plan.is_preview:
            preview = LayeredMaterial(self.context, self.writer, self.packer, plan.prim)
            entry = preview.write(inputs, slots, display, has_colors)
        else:
            entry = _display_material(display, has_colors)
        if plan.prim is not None:
            entry["name"] = plan.prim.GetName()
            entry["extras"] = {"prim": str(plan.prim.GetPath())}
        return entry


def _as_glass(inputs: dict[str, Source]) -> dict[str, Source]:
    """Inputs of a surface whose diffuse part cannot be seen: clear glass, which still reflects."""
    opacity, threshold = inputs.get("opacity"), inputs.get("opacityThreshold", Constant((0.0,)))
    if not isinstance(opacity, Constant) or opacity.value[0] >= CLEAR:
        return {}
    if threshold != Constant((0.0,)) or "transmission" in inputs:
        return {}
    white, clear = Constant((1.0, 1.0, 1.0)), Constant((1.0 - max(opacity.value[0], 0.0),))
    glass = {"diffuseColor": white, "opacity": Constant((1.0,)), "transmission": clear}
    return glass | _rough_outside(inputs)


def _rough_outside(inputs: dict[str, Source]) -> dict[str, Source]:
    """Inputs by which rough glass is clear, as glTF's transmission has the roughness of its mirror.

    A coat reflects in place of the surface below, which is smooth. Its index is 1.5, so that it
    stands for no metal, no tint and no higher index.
    """

    def number(name: str) -> float:
        source = inputs.get(name, Constant(PREVIEW_INPUTS[name]))
        return source.value[0] if isinstance(source, Constant) else math.nan

    plain = number("metallic") == number("useSpecularWorkflow") == number("clearcoat") == 0.0
    ior = max(number("ior"), 1.0)
    roughness = inputs.get("roughness", Constant(PREVIEW_INPUTS["roughness"]))
    strength = ((ior - 1.0) / (ior + 1.0)) ** 2 / DIELECTRIC_F0
    if not plain or not 0.0 < strength < 1.1 or roughness == Constant((0.0,)):
        return {}
    none = Constant((0.0,))
    rough = {"clearcoat": Constant((min(strength, 1.0),)), "clearcoatRoughness": roughness}
    normal = {"coatNormal": inputs["normal"]} if "normal" in inputs else {}
    return {"roughness": none, "specular": none} | rough | normal


def painter_of(
    readers: tuple[str | None, str | None],
    primvars: GprimPrimvars,
    display: DisplayColor,
    paint: Callable[[DisplayColor], int],
) -> Painter | None:
    """How a primitive, whose material reads two primvars, shows a tint; None where it does not."""
    own = {str(primvar.GetPrimvarName()) for primvar in primvars.owned}
    takes = [name in DISPLAY and name not in own for name in readers]

    def painter(tint: Tint) -> int:
        parts = zip((takes[0],) * 3 + (takes[1],), tint, display.constant, strict=True)
        shown = [part if takes and part is not None else own for takes, part, own in parts]
        return paint(DisplayColor((*shown,), translucent=shown[3] < 1.0))  # type: ignore[arg-type]

    varies = display.stream_for(*(reader is not None for reader in readers)) is not None
    return painter if any(takes) and not varies else None


def warn_translucent(
    context: Context, prim: Usd.Prim, plan: MaterialPlan, display: DisplayColor
) -> None:
    """Warn about the displayOpacity of a prim without a material; materials warn themselves."""
    if display.translucent and not plan.is_preview:
        message = "displayOpacity became alpha blending, which also fades reflections"
        context.ledger.warn("opacity-approximated", prim, message)


def _three(values: tuple[float, ...]) -> tuple[float, ...]:
    return values[:3] if len(values) >= 3 else (values[0],) * 3


def _display_material(display: DisplayColor, has_colors: bool) -> dict[str, Any]:
    """A plain dielectric in the gprim's displayColor."""
    factor = [1.0, 1.0, 1.0, 1.0] if has_colors else list(display.constant)
    entry: dict[str, Any] = {
        "name": "displayColor",
        "pbrMetallicRoughness": {
            "baseColorFactor": factor,
            "metallicFactor": 0.0,
            "roughnessFactor": DISPLAY_ROUGHNESS,
        },
    }
    if display.translucent:
        entry["alphaMode"] = "BLEND"
    return entry
