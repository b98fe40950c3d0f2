"""The primvars of a gprim, sorted into what glTF has names for: color, UV sets, custom values."""

import re
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from pxr import Usd, UsdGeom

from .context import Context, source_path
from .extras import plain_value
from .primvars import Primvar, Topology, read_primvar, to_stream
from .surface import Stream

# The last pattern is how files of early USD versions name float2[].
UV_TYPES = (
    *tuple(f"texCoord{n}{t}[]" for n in "23" for t in "fdh"),
    "float2[]",
    "double2[]",
    "half2[]",
    "Vec2f[]",
)
_FLOAT_TYPES = re.compile(
    r"^(float|double|half)[234]?\[\]$|^(color|vector|normal|point)[34][fdh]\[\]$"
)
# Primvars that other modules read, or without a meaning outside the tool that wrote them.
_HANDLED = re.compile(r"^(displayColor|displayOpacity|normals|skel:.*)$")


@dataclass
class DisplayColor:
    """displayColor and displayOpacity of a gprim."""

    constant: tuple[float, float, float, float]
    """The first color and opacity; the only ones where both are constant."""
    color: Stream | None = None
    opacity: Stream | None = None
    translucent: bool = False
    """Whether some opacity is below 1."""

    def stream_for(self, use_color: bool, use_opacity: bool) -> Stream | None:
        """Values of COLOR_0; None where one constant factor is enough."""
        color = self.color if use_color else None
        opacity = self.opacity if use_opacity and self.translucent else None
        if not any(s is not None and len(s.values) > 1 for s in (color, opacity)):
            return None
        some = color or opacity
        assert some is not None
        one_id = np.zeros(len(some.ids), dtype=np.int64)
        if color is None:
            base = self.constant[:3] if use_color else (1.0, 1.0, 1.0)
            color = Stream(np.array([base]), one_id, by_point=True)
        if opacity is None:
            return color
        count = len(opacity.values)
        used, ids = np.unique(color.ids * count + opacity.ids, return_inverse=True)
        values = np.hstack([color.values[used // count], opacity.values[used % count]])
        return Stream(values, ids.reshape(-1), color.by_point and opacity.by_point)


@dataclass
class Streams:
    """Primvars that become vertex attributes."""

    uvs: dict[str, Stream] = field(default_factory=dict)
    """UV sets by primvar."""
    custom: dict[str, Stream] = field(default_factory=dict)
    """Other values by glTF attribute."""
    renamed: dict[str, str] = field(default_factory=dict)
    """Primvar by attribute of `custom`, where the attribute's name is not simply the primvar's."""


@dataclass
class GprimPrimvars:
    """All primvars that reach a gprim, inherited ones included; warns about unsupported ones."""

    context: Context
    prim: Usd.Prim
    owned: list[UsdGeom.Primvar]
    uvs: dict[str, Primvar] = field(default_factory=dict)
    custom: dict[str, Primvar] = field(default_factory=dict)
    constants: dict[str, Any] = field(default_factory=dict)
    attributes: dict[str, str] = field(default_factory=dict)
    """The names of glTF attributes, by primvar: numbered where two primvars would share one."""

    def __post_init__(self) -> None:
        for primvar in self.owned:
            name, type_name = str(primvar.GetPrimvarName()), str(primvar.GetTypeName())
            if _HANDLED.match(name):
                continue
            varies = primvar.GetInterpolation() != "constant"
            if type_name in UV_TYPES and (type_name.startswith("texCoord") or varies):
                if type_name.startswith("texCoord3"):
                    self.name_attribute(name)
                self._read_into(self.uvs, primvar, (2, 3))
            elif _FLOAT_TYPES.match(type_name) and varies:
                self.name_attribute(name)
                self._read_into(self.custom, primvar, (1, 2, 3, 4))
            else:
                self._keep_constant(primvar)

    def _read_into(
        self, target: dict[str, Primvar], primvar: UsdGeom.Primvar, widths: tuple[int, ...]
    ) -> None:
        """Add the primvar where an element of it has one of the `widths`."""
        read = read_primvar(self.context, self.prim, primvar)
        if read is None or not len(read.values):
            return
        if read.values.shape[1] in widths:
            target[read.name] = read
            return
        message = f"elements of primvar '{read.name}' have {read.values.shape[1]} numbers,"
        message += f" a glTF attribute takes {widths[-1]}"
        self.context.ledger.warn("primvar-dropped", self.prim, message)

    def _keep_constant(self, primvar: UsdGeom.Primvar) -> None:
        """Keep a constant primvar in the node's extras; warn about any other primvar."""
        name = str(primvar.GetPrimvarName())
        plain = plain_value(primvar.ComputeFlattened(self.context.time))
        if primvar.GetInterpolation() == "constant" and plain is not None:
            self.constants[name] = plain
            return
        message = f"primvar '{name}' of type {primvar.GetTypeName()} has no glTF counterpart"
        self.context.ledger.warn("primvar-dropped", self.prim, message)

    def name_attribute(self, primvar: str) -> None:
        """Choose the attribute for a primvar; earlier primvars keep theirs.

        glTF wants application attributes to begin with an underscore, in capitals.
        """
        base = "_" + re.sub(r"[^A-Za-z0-9_]", "_", primvar).upper()
        chosen, number = base, 1
        while chosen in self.attributes.values():
            number += 1
            chosen = f"{base}_{number}"
        self.attributes[primvar] = chosen

    def display(
        self,
        topology: Topology,
        color_primvar: str | None = None,
        opacity_primvar: str | None = None,
        fallback: tuple[float, ...] = (0.18, 0.18, 0.18),
    ) -> DisplayColor:
        """The color that the gprim shows: displayColor, or the primvar of a material's readers.

        `fallback`, UsdPreviewSurface's diffuseColor unless a reader has its own, stands in for
        a missing color.
        """
        color = self._display(color_primvar or "displayColor", topology, 3)
        alpha = self._display(opacity_primvar or "displayOpacity", topology, 1)
        base = fallback if color is None else color.values[0]
        opacity = 1.0 if alpha is None else float(alpha.values[0, 0])
        red, green, blue = (float(part) for part in base[:3])
        translucent = alpha is not None and bool((alpha.values < 1.0).any())
        return DisplayColor((red, green, blue, opacity), color, alpha, translucent)

    def _display(self, name: str, topology: Topology, components: int) -> Stream | None:
        context, prim = self.context, self.prim
        primvar = next((p for p in self.owned if str(p.GetPrimvarName()) == name), None)
        read = None if primvar is None else read_primvar(context, prim, primvar)
        if read is None or len(read.values) == 0:
            return None
        stream = to_stream(context, prim, read, topology)
        if stream is None:
            return None
        if stream.values.shape[1] != components:
            context.ledger.warn("primvar-size-wrong", prim, f"'{read.name}' has the wrong type")
            return None
        if (stream.values < 0.0).any() or (stream.values > 1.0).any():
            message = f"'{read.name}' has values outside 0…1, clamped"
            context.ledger.warn("color-clamped", prim, message)
            stream.values = np.clip(stream.values, 0.0, 1.0)
        return stream

    def streams(self, topology: Topology) -> Streams:
        """UV sets and custom streams; a set whose third coordinate is used is custom as a whole."""
        result = Streams()
        for name, primvar in {**self.uvs, **self.custom}.items():
            stream = to_stream(self.context, self.prim, primvar, topology)
            if stream is None:
                continue
            if name in self.uvs:
                result.uvs[name] = replace(stream, values=stream.values[:, :2])
                if not stream.values[:, 2:].any():
                    continue
            attribute = self.attributes[name]
            result.custom[attribute] = stream
            if attribute != f"_{name.upper()}":
                result.renamed[attribute] = name
        return result


def inherited_primvars(prim: Usd.Prim) -> list[UsdGeom.Primvar]:
    """Primvars with values that apply to `prim`, by name."""
    found = UsdGeom.PrimvarsAPI(prim).FindPrimvarsWithInheritance()
    return sorted((p for p in found if p.HasValue()), key=lambda p: str(p.GetPrimvarName()))


def primvar_signature(primvars: list[UsdGeom.Primvar]) -> tuple[str, ...]:
    """Sources of a prim's primvars: instances that differ in them need own meshes."""
    places = []
    for primvar in primvars:
        places.append(f"{source_path(primvar.GetAttr().GetPrim())}.{primvar.GetName()}")
    return tuple(places)
