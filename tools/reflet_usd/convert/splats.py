"""Gaussian splats to colored points, each as wide as two standard deviations."""

from typing import Any

import numpy as np

from .attributes import DisplayColor
from .context import authored, in_float32
from .curves import WIDTH_ATTRIBUTE, LineBuilder, by_width
from .geometry import BuiltMesh
from .scene import Array
from .texture import srgb_to_linear

SPLATS = "ParticleField3DGaussianSplat"
FAINTEST = 0.1
"""Opacity below which a splat is left out: points are opaque."""
# Real spherical harmonic of degree 0, and the gray that splats add to it (Kerbl et al. 2023).
_CONSTANT, _MIDDLE = 0.28209479177387814, 0.5


class SplatBuilder(LineBuilder):
    """Converts a field of Gaussian splats."""

    def build(self) -> BuiltMesh | None:
        """A mesh of glTF points, or None (with a warning) where no splat can be seen."""
        points = self._values("positions", 3, np.zeros((0, 3)))
        count = len(points)
        scales = self._values("scales", 3, np.ones((count, 3)))[:count]
        opacity = self._values("opacities", 1, np.ones((count, 1)))[:count, 0]
        shown = in_float32(np.column_stack([points, scales])).all(axis=1) & (opacity >= FAINTEST)
        if not shown.any():
            self._warn("mesh-empty", "there are no splats that could be seen")
            return None
        meters = self.context.meters_per_unit
        values = {
            "POSITION": points[shown] * meters,
            "COLOR_0": self._colors(count)[shown],
            WIDTH_ATTRIBUTE: 2.0 * meters * np.cbrt(np.abs(scales[shown]).prod(axis=1))[:, None],
        }
        entries = [self._entry(values, None, rows, width) for rows, width in by_width(values, None)]
        plan, white = self.materials.plan(None), DisplayColor((1.0, 1.0, 1.0, 1.0))
        lit = self.materials.instantiate(plan, {}, False, white, True)
        self.writer.use_extension("KHR_materials_unlit")  # splats hold the light that they show
        unlit: dict[str, Any] = {"extensions": {"KHR_materials_unlit": {}}}
        look = self.writer.add_once("materials", {**self.writer.lists["materials"][lit], **unlit})
        message = f"of {count} splats {int(shown.sum())} are shown as opaque points"
        self._warn("splats-approximated", f"{message}, in the same color from all sides")
        mesh: dict[str, Any] = {"name": self.prim.GetName()}
        mesh["primitives"] = [{**entry, "material": look} for entry in entries]
        mesh["extras"] = {"prim": str(self.prim.GetPath())}
        return BuiltMesh(self.writer.add("meshes", mesh), {})

    def _values(self, name: str, width: int, fallback: Array) -> Array:
        """Values (splats, width), of single precision or else of half; or `fallback`."""
        for stored in (name, f"{name}h"):
            values = np.array(authored(self.prim, stored, self.context.time, []), dtype=np.float64)
            if values.size and values.size >= len(fallback) * width:
                return values.reshape(-1, width)
        return fallback

    def _colors(self, count: int) -> Array:
        """Linear colors (splats, 3) by the constant part, which is encoded as for displays."""
        degree = int(authored(self.prim, "radiance:sphericalHarmonicsDegree", self.context.time, 3))
        each = (degree + 1) ** 2
        name = "radiance:sphericalHarmonicsCoefficients"
        found = self._values(name, 3, np.zeros((count * each, 3)))[: count * each : each]
        return srgb_to_linear(np.clip(np.nan_to_num(found) * _CONSTANT + _MIDDLE, 0.0, 1.0))
