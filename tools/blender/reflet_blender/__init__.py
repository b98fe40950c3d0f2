"""Blender add-on of Reflet: exports scenes as projects, and renders them with the program."""

from __future__ import annotations

import bpy

from . import engine, ui

__all__ = ["register", "unregister"]

_CLASSES = (*ui.CLASSES, engine.RefletEngine)
# Panels of Eevee's own render settings.
_NOT_OURS = ("RENDER_PT_eevee", "RENDER_PT_simplify", "EEVEE_NEXT", "VIEWLAYER_PT_eevee")


def _panels() -> list[type[bpy.types.Panel]]:
    """Panels of things that Reflet carries: lights, worlds, materials, cameras, output."""
    return [
        panel
        for panel in bpy.types.Panel.__subclasses__()
        if {"BLENDER_RENDER", "BLENDER_EEVEE"} & set(getattr(panel, "COMPAT_ENGINES", ()))
        and not panel.__name__.startswith(_NOT_OURS)
    ]


def register() -> None:
    """Add the add-on to Blender."""
    for made in _CLASSES:
        bpy.utils.register_class(made)
    bpy.types.Scene.reflet = bpy.props.PointerProperty(type=ui.RefletSettings)
    bpy.types.TOPBAR_MT_file_export.append(ui.menu)
    for panel in _panels():
        panel.COMPAT_ENGINES.add("REFLET")


def unregister() -> None:
    """Take it out again."""
    for panel in _panels():
        panel.COMPAT_ENGINES.discard("REFLET")
    bpy.types.TOPBAR_MT_file_export.remove(ui.menu)
    del bpy.types.Scene.reflet
    for made in reversed(_CLASSES):
        bpy.utils.unregister_class(made)
