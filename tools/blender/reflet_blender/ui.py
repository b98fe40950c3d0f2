"""Owns what users see: the export in the menu, the engine's settings, the preferences."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, StringProperty

from .export import Options, export_project
from .folder import ExportError

_METHODS = [
    ("auto", "Automatic", "Ray traced"),
    ("hybrid", "Hybrid", "Reflections in screen space first, by rays where that fails"),
    ("rt", "Ray traced", "All reflections by rays"),
    ("path", "Path traced", "All light by rays, with any number of bounces: slow, the reference"),
]


class RefletSettings(bpy.types.PropertyGroup):
    """Settings of a scene that only Reflet has."""

    method: EnumProperty(name="Method", description="How reflections are found", items=_METHODS)
    samples: IntProperty(
        name="Samples", description="Sub-frames of a picture", default=64, min=1, max=4096
    )
    diffuse_bounces: IntProperty(
        name="Diffuse Bounces",
        description="How often matte surfaces scatter light; path tracing has no limit",
        default=4,
        min=0,
        max=8,
    )
    tile_px: IntProperty(
        name="Tile Size",
        description="Edge of the parts that are shown as they are done, in pixels; 0 renders the "
        "picture at once, which takes less time",
        default=0,
        min=0,
        max=16384,
    )


class RefletPreferences(bpy.types.AddonPreferences):
    """Where the program is."""

    bl_idname = __package__
    program: StringProperty(
        name="Program",
        description="The program reflet; empty takes the one on the PATH",
        subtype="FILE_PATH",
    )

    def draw(self, _context: bpy.types.Context) -> None:
        """Show the one setting."""
        self.layout.prop(self, "program")


class EXPORT_SCENE_OT_reflet(bpy.types.Operator):  # noqa: N801 - Blender asks for such names
    """Export the scene as a project of Reflet; layers written by hand are kept."""

    bl_idname = "export_scene.reflet"
    bl_label = "Export Reflet Project"
    bl_options: ClassVar = {"PRESET"}

    directory: StringProperty(name="Folder", subtype="DIR_PATH")
    animate: BoolProperty(
        name="Animation", description="Export motion, not only the current frame", default=True
    )

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        """Ask for the folder."""
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Export, and say what is lost."""
        if not self.directory:
            self.report({"ERROR"}, "name a folder to export to")
            return {"CANCELLED"}
        root = Path(bpy.path.abspath(self.directory))
        settings = context.scene.reflet
        options = Options(
            method=settings.method,
            samples=settings.samples,
            diffuse_bounces=settings.diffuse_bounces,
            animate=self.animate,
            layer=context.view_layer.name,
        )
        try:
            done = export_project(context.scene, root, options)
        except ExportError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if done.losses:
            told = f"{len(done.losses)} things differ in Reflet: {root / 'report.txt'} names them"
            self.report({"WARNING"}, told)
        self.report({"INFO"}, f"{len(done.written)} files written, {len(done.kept)} unchanged")
        return {"FINISHED"}


class RENDER_PT_reflet(bpy.types.Panel):  # noqa: N801 - Blender asks for such names
    """Settings of the engine."""

    bl_label = "Reflet"
    bl_space_type, bl_region_type, bl_context = "PROPERTIES", "WINDOW", "render"
    COMPAT_ENGINES: ClassVar = {"REFLET"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Shown where Reflet is the engine."""
        return context.engine in cls.COMPAT_ENGINES

    def draw(self, context: bpy.types.Context) -> None:
        """Show the settings."""
        self.layout.use_property_split = True
        for name in ("method", "samples", "diffuse_bounces", "tile_px"):
            self.layout.prop(context.scene.reflet, name)


def menu(self: bpy.types.Menu, _context: bpy.types.Context) -> None:
    """The entry in File > Export."""
    self.layout.operator(EXPORT_SCENE_OT_reflet.bl_idname, text="Reflet Project")


CLASSES = (RefletSettings, RefletPreferences, EXPORT_SCENE_OT_reflet, RENDER_PT_reflet)
