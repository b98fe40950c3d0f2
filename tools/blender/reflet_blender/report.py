"""Owns the report of an export: the project's content, and the losses."""

from __future__ import annotations

import dataclasses
import json

# Every loss that an export can name, with its meaning.
LOSSES = {
    "area-spread-dropped": "an area light that shines into less than a half space shines into all",
    "bokeh-dropped": "the blades, rotation and ratio of an aperture; the lens is round",
    "camera-kind-dropped": "a panoramic or custom camera is left out",
    "clip-end-dropped": "things beyond a camera's end of view are seen",
    "collection-flat": "a collection is no placed scene: its things are placed one by one",
    "compositor-dropped": "nodes of the compositor, which change the picture after rendering",
    "deformation-frozen": "a mesh that modifiers deform over time has the shape of the first frame",
    "displacement-dropped": "displacement by a material",
    "dof-dropped": "the depth of field of an orthographic camera",
    "frames-cut": "frames before 0 or after 1,000,000 are left out",
    "hair-dropped": "hair of particle systems; hair of curves is dropped as an object's kind",
    "image-missing": "an image that cannot be read",
    "instances-frozen": "instances that come or go over time are those of the first frame",
    "layer-dropped": "materials, worlds, holdouts and indirect-only collections of a view layer",
    "library-missing": "a linked library that cannot be found",
    "light-animation-frozen": "a value of a light that has no track: size, and roll about its beam",
    "light-kind-approximated": "an ellipse is a rectangle of the same area",
    "light-linking-dropped": "lights that light only some things light all",
    "light-nodes-dropped": "nodes of a light; its color and power are kept",
    "light-off": "a light without power, or with less than none, is left out",
    "light-seen-dropped": "a light that the camera sees; reflections show it, the camera does not",
    "look-dropped": "a look, gamma, curves or white balance of the color management",
    "material-animation-frozen": "values of a material that change over time",
    "material-approximated": "a material whose nodes Reflet has no counterpart for",
    "matrix-motion-frozen": "a thing that is sheared moves, and keeps its first place",
    "mirror-motion-frozen": "a thing that motion mirrors stays where it was before",
    "object-kind-dropped": "objects of a kind that Reflet has no counterpart for",
    "place-invalid": "a thing at no finite place, or farther than 1e12 m, is left out",
    "pixel-aspect-dropped": "pixels that are not square",
    "procedural-dropped": "an input of a material that is fed by nodes other than images",
    "ray-visibility-dropped": "rays of kinds that Reflet does not tell apart see or miss a thing",
    "scale-zero": "a thing with a scale of zero is left out",
    "shadow-catcher-dropped": "a shadow catcher or holdout is an ordinary thing",
    "spot-approximated": "a spot whose cone is scaled, or 180 degrees wide, is round and narrower",
    "subsurface-dropped": "scattering below a surface whose values vary, or that transmits too",
    "tone-map-approximated": "a view transform that Reflet has no counterpart for",
    "units-dropped": "a unit scale other than 1; a unit of Blender is a meter",
    "volume-dropped": "a volume of a material or of the world",
    "world-approximated": "nodes of the world that Reflet has no counterpart for",
}


@dataclasses.dataclass(frozen=True, order=True)
class Loss:
    """One thing that could not be carried."""

    code: str
    subject: str
    text: str


class Report:
    """Files and losses of an export."""

    def __init__(self) -> None:
        self._losses: set[Loss] = set()
        self.counts: dict[str, int] = {}
        self.written: list[str] = []
        self.kept: list[str] = []
        self.removed: list[str] = []

    def lose(self, code: str, subject: str, text: str = "") -> None:
        """Name a loss; `text` says what exactly, where its code does not."""
        assert code in LOSSES, code
        self._losses.add(Loss(code, subject, text or LOSSES[code]))

    @property
    def losses(self) -> list[Loss]:
        """All losses, in the order of their codes."""
        return sorted(self._losses)

    def as_json(self) -> str:
        """The part that no earlier export changes, so that the same scene has one report."""
        losses = [dataclasses.asdict(loss) for loss in self.losses]
        return json.dumps({"counts": self.counts, "losses": losses}, indent=1) + "\n"

    def as_text(self) -> str:
        """The same for people, a line for each loss."""
        held = ", ".join(f"{count} {what}" for what, count in self.counts.items() if count)
        lines = [f"Holds {held or 'nothing'}."]
        lines += [f"{loss.code}: {loss.subject}: {loss.text}" for loss in self.losses]
        if not self._losses:
            lines.append("Everything was carried.")
        return "\n".join(lines) + "\n"
