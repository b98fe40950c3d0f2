"""Owns the settings of the picture: size, samples, exposure, tone, frames."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import bpy

from .report import Report

if TYPE_CHECKING:
    from .export import Options

# View transforms of Blender's configuration.
_TONES = {"Standard": "none", "Raw": "none", "Khronos PBR Neutral": "neutral", "AgX": "agx"}
_NEAREST_TONE = {"Filmic": "agx", "ACES 1.3": "aces", "ACES 2.0": "aces"}


def tables(
    scene: bpy.types.Scene,
    options: Options,
    frames: list[int] | None,
    fps: float,
    seen: dict[str, bpy.types.Object],
    report: Report,
) -> dict[str, dict[str, Any]]:
    """`[reflection]`, `[image]` and, for a film, `[timeline]`."""
    out: dict[str, dict[str, Any]] = {"reflection": _reflection(options)}
    out["image"] = _image(scene, options, report)
    if frames is not None:
        timeline: dict[str, Any] = {"fps": fps, "start": frames[0], "end": frames[-1]}
        cuts = _cuts(scene, frames, seen)
        if cuts:
            timeline["cuts"] = cuts
        out["timeline"] = timeline
    return out


def _reflection(options: Options) -> dict[str, Any]:
    out: dict[str, Any] = {"method": options.method}
    if options.method != "path":
        out["diffuse_bounces"] = options.diffuse_bounces
    # Blender's metals and glass keep the light that microfacets reflect more than once.
    return {**out, "multiple_scattering": True}


def size(scene: bpy.types.Scene) -> tuple[int, int]:
    """Width and height of the picture, pixels."""
    render = scene.render
    share = render.resolution_percentage / 100
    return max(int(render.resolution_x * share), 1), max(int(render.resolution_y * share), 1)


def is_blurred(scene: bpy.types.Scene) -> bool:
    """Whether the current frame shows motion while its shutter is open; frames begin at 0."""
    return bool(scene.render.use_motion_blur) and scene.frame_current >= 1


def _image(scene: bpy.types.Scene, options: Options, report: Report) -> dict[str, Any]:
    view, render = scene.view_settings, scene.render
    tone = _TONES.get(view.view_transform)
    if tone is None:
        tone = _NEAREST_TONE.get(view.view_transform, "none")
        text = f"{view.view_transform} is shown as {tone!r}"
        report.lose("tone-map-approximated", scene.name, text)
    balance = getattr(view, "use_white_balance", False)
    if view.look != "None" or view.gamma != 1 or view.use_curve_mapping or balance:
        report.lose("look-dropped", scene.name)
    out: dict[str, Any] = {"size": list(size(scene)), "samples": options.samples}
    out["tone_map"] = tone
    if view.exposure:
        out["exposure_ev"] = min(max(view.exposure, -20.0), 20.0)
    if render.film_transparent:
        out["alpha"] = True
    if render.use_motion_blur:
        out["shutter"] = min(render.motion_blur_shutter, 1.0)
    return out


def _cuts(
    scene: bpy.types.Scene, frames: list[int], seen: dict[str, bpy.types.Object]
) -> list[dict[str, Any]]:
    """The cameras that markers of the timeline bind."""
    names = {thing.name_full: name for name, thing in seen.items()}
    bound = [marker for marker in scene.timeline_markers if marker.camera is not None]
    cuts: dict[int, str] = {}
    for marker in sorted(bound, key=lambda marker: marker.frame):
        name = names.get(marker.camera.name_full)
        if name is not None and marker.frame <= frames[-1]:
            cuts[max(marker.frame, frames[0])] = name
    return [{"frame": frame, "camera": name} for frame, name in cuts.items()]
