"""Owns the render engine `REFLET`: exports to a temporary project and runs the program on it.

The export runs in a Blender of its own, on a copy of the scene: renders run beside the interface,
where nothing in the file may change.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import bpy
import numpy as np

from . import exr, picture, program

CHILD = Path(__file__).with_name("child.py")
# Passes of Blender that Reflet has: property of the view layer, names, channels, Reflet's AOV.
_PASSES = {
    "use_pass_z": (("Depth",), "Z", "VALUE", "depth", ("Z",)),
    "use_pass_normal": (("Normal",), "XYZ", "VECTOR", "normal", ("X", "Y", "Z")),
    "use_pass_diffuse_color": (
        ("Diffuse Color", "DiffCol"),
        *("RGB", "COLOR", "base_color", ("R", "G", "B")),
    ),
    "use_pass_emit": (("Emission", "Emit"), "RGB", "COLOR", "emission", ("R", "G", "B")),
}
# Blender's own value of a pixel without a surface.
_FAR = 1e10


class RefletEngine(bpy.types.RenderEngine):
    """Renders with the program `reflet`."""

    bl_idname = "REFLET"
    bl_label = "Reflet"
    bl_use_preview = False
    bl_use_eevee_viewport = True
    bl_use_postprocess = True

    def update_render_passes(
        self, scene: bpy.types.Scene, renderlayer: bpy.types.ViewLayer
    ) -> None:
        """Tell Blender the passes that a view layer asks for."""
        self.register_pass(scene, renderlayer, "Combined", 4, "RGBA", "COLOR")
        for wanted, (names, channels, kind, _, _) in _PASSES.items():
            if getattr(renderlayer, wanted):
                self.register_pass(scene, renderlayer, names[0], len(channels), channels, kind)

    def render(self, depsgraph: bpy.types.Depsgraph) -> None:
        """Render one view layer of the scene."""
        try:
            with tempfile.TemporaryDirectory(prefix="reflet-") as place:
                self._render(depsgraph, Path(place))
        except (program.ProgramError, exr.ExrError, OSError) as error:
            # Blender shows the text and ends the render, also of an animation.
            self.error_set(str(error))
            self.report({"ERROR"}, str(error))

    def _render(self, depsgraph: bpy.types.Depsgraph, place: Path) -> None:
        scene, layer = depsgraph.scene, depsgraph.view_layer
        settings = scene.reflet
        reflet = program.find(_named_program())
        self.update_stats("", "Exporting the scene")
        if self._export(scene, layer, place) is None:
            return
        width, height = picture.size(scene)
        left, bottom, part_width, part_height = _part(scene, width, height)
        aovs = [aov for wanted, (_, _, _, aov, _) in _PASSES.items() if getattr(layer, wanted)]
        tiles = list(_tiles(part_width, part_height, settings.tile_px))
        for done, (x, y, tile_width, tile_height) in enumerate(tiles):
            self.update_stats("", f"Rendering part {done + 1} of {len(tiles)}")
            self.update_progress(done / len(tiles))
            # Blender counts rows from below, the program from above.
            top = height - (bottom + y) - tile_height
            output = place / "picture.exr"
            command = [reflet, "render", str(place / "project" / "scene.toml"), "-o", str(output)]
            command += ["--size", f"{width}x{height}"]
            if picture.is_blurred(scene):
                command += ["--frames", str(scene.frame_current)]
            command += ["--crop", f"{left + x},{top},{tile_width},{tile_height}"]
            command += ["--aov", ",".join(aovs)] if aovs else []
            if program.run(command, self.test_break) is None:
                return
            self._show(exr.read(output), layer, x, y, tile_width, tile_height, scene)
        self.update_progress(1.0)

    def _export(
        self, scene: bpy.types.Scene, layer: bpy.types.ViewLayer, place: Path
    ) -> str | None:
        """Export the scene at its frame; None where the user stopped it."""
        file, settings = place / "scene.blend", scene.reflet
        bpy.data.libraries.write(str(file), {scene.original}, path_remap="ABSOLUTE")
        words = [str(file), scene.name, layer.name, str(scene.frame_current)]
        words += [str(place / "project"), settings.method, str(settings.samples)]
        words += [str(settings.diffuse_bounces)]
        said = program.run([*_blender(), "--", *words], self.test_break)
        if said is not None and "Everything was carried." not in said:
            losses = [line for line in said.splitlines() if ": " in line and line[0].islower()]
            text = "\n".join(losses[:20])
            self.report({"WARNING"}, f"{len(losses)} things differ in Reflet:\n{text}")
        return said

    def _show(
        self,
        channels: dict[str, np.ndarray],
        layer: bpy.types.ViewLayer,
        x: int,
        y: int,
        width: int,
        height: int,
        scene: bpy.types.Scene,
    ) -> None:
        """Hand the channels of a part to Blender."""
        result = self.begin_result(x, y, width, height, layer=layer.name)
        for wanted, (names, of_pass, _, _, _) in _PASSES.items():
            passes = result.layers[0].passes
            if getattr(layer, wanted) and not any(name in passes for name in names):
                self.add_pass(names[0], len(of_pass), of_pass, layer=layer.name)
        passes = result.layers[0].passes
        colors = [channels[name] for name in "RGB"]
        alpha = channels.get("A", np.ones_like(colors[0]))
        _fill(passes["Combined"], [*colors, alpha])
        for wanted, (names, _, _, aov, parts) in _PASSES.items():
            there = next((passes[name] for name in names if name in passes), None)
            if there is not None and getattr(layer, wanted):
                _fill(there, _of_blender(aov, [channels[f"{aov}.{part}"] for part in parts]))
        self.end_result(result)


def _of_blender(aov: str, planes: list[np.ndarray]) -> list[np.ndarray]:
    """Values of an AOV as Blender counts them."""
    if aov == "normal":
        x, y, z = planes
        return [x, -z, y]
    if aov == "depth":
        return [np.where(np.isfinite(planes[0]), planes[0], _FAR)]
    return planes


def _fill(there: bpy.types.RenderPass, planes: list[np.ndarray]) -> None:
    rows = np.stack(planes, axis=-1)[::-1].astype(np.float32)
    there.rect.foreach_set(np.ascontiguousarray(rows).reshape(-1))


def _blender() -> list[str]:
    """The command that runs child.py in a Blender like this one."""
    if not bpy.app.binary_path:
        return [sys.executable, str(CHILD)]
    # Drivers in Python run there only where they run here.
    trust = "--disable-autoexec" if bpy.app.autoexec_fail else "--enable-autoexec"
    quiet = ["--background", "--factory-startup", trust, "--python-exit-code", "1"]
    return [bpy.app.binary_path, *quiet, "--python", str(CHILD)]


def _named_program() -> str:
    addon = bpy.context.preferences.addons.get(__package__)
    return addon.preferences.program if addon else ""


def _part(scene: bpy.types.Scene, width: int, height: int) -> tuple[int, int, int, int]:
    """The region to render: left, bottom, width and height in pixels of the whole picture."""
    render = scene.render
    if not render.use_border:
        return 0, 0, width, height
    left, bottom = int(render.border_min_x * width), int(render.border_min_y * height)
    right, top = int(render.border_max_x * width), int(render.border_max_y * height)
    return left, bottom, max(right - left, 1), max(top - bottom, 1)


def _tiles(width: int, height: int, edge: int) -> Iterator[tuple[int, int, int, int]]:
    """Parts of a region, from the top: left, bottom, width and height; one where `edge` is 0."""
    step = edge or max(width, height)
    for top in range(height, 0, -step):
        bottom = max(top - step, 0)
        for left in range(0, width, step):
            yield left, bottom, min(step, width - left), top - bottom
