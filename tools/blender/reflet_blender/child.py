"""Exports a scene of a file in a Blender of its own, so that the user's one is not changed.

    python child.py FILE SCENE LAYER FRAME FOLDER METHOD SAMPLES BOUNCES

The arguments follow `--` where Blender runs it. Prints the losses; 3 where nothing is exported.
"""

from __future__ import annotations

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from reflet_blender import picture
from reflet_blender.export import Options, export_project
from reflet_blender.folder import ExportError


def main() -> int:
    """Export, and print what is lost."""
    words = sys.argv[sys.argv.index("--") + 1 :]
    file, name, layer, frame, folder, method, samples, bounces = words
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(file, link=False) as (_, wanted):
        wanted.scenes = [name]
    scene = wanted.scenes[0]
    if scene is None:
        print(f"{file} has no scene {name!r}")
        return 3
    bpy.context.window.scene = scene
    number = int(frame)
    scene.frame_set(number)
    # A shutter needs the frames around; a still picture has no motion.
    blurred = picture.is_blurred(scene)
    scene.frame_start, scene.frame_end = number - 1, number + 1
    options = Options(
        method=method,
        samples=int(samples),
        diffuse_bounces=int(bounces),
        animate=blurred,
        layer=layer,
    )
    try:
        report = export_project(scene, Path(folder), options)
    except ExportError as error:
        print(error)
        return 3
    print(report.as_text())
    return 0


if __name__ == "__main__":
    sys.exit(main())
