"""Owns the plain data that both sides of a comparison are reduced to.

All positions are meters in glTF's world (right-handed, Y up); matrices act on row vectors,
`p_world = p_local @ matrix`, as in USD; angles are radians unless a name says otherwise.
"""

import dataclasses
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Lost = list[tuple[str, str]]
"""Inputs without a place in glTF: the warning that must tell of each, and its value.

A value in quotes is a name that the warning has to give."""


class StageError(Exception):
    """A stage that usd-core itself does not open."""


@dataclasses.dataclass
class Corners:
    """The face corners of everything that one prim draws, in world space."""

    positions: Array
    """(n, 3) meters."""
    optional_positions: Array
    """(m, 3) corners of degenerate faces, which a converter may drop."""
    triangles: int = 0
    optional_triangles: int = 0
    area_range: tuple[float, float] = (0.0, 0.0)
    """Area in square meters; a range where bent faces can be triangulated in more than one way."""
    vector_area: Array = dataclasses.field(default_factory=lambda: np.zeros(3))
    """Sum of the faces' area vectors: independent of triangulation, reversed with winding."""
    volume_range: tuple[float, float] = (0.0, 0.0)
    """Signed volume of cones from `center` to the faces, cubic meters; reversed with winding."""
    optional_measures: tuple[float, Array, float] = dataclasses.field(
        default_factory=lambda: (0.0, np.zeros(3), 0.0)
    )
    """Area, area vector and volume of the faces that may be dropped."""
    center: Array = dataclasses.field(default_factory=lambda: np.zeros(3))
    """(3,) a point among the corners."""
    normals: Array | None = None
    """(n, 3) unit vectors, or None where the stage does not define them exactly."""
    uvs: dict[str, Array] = dataclasses.field(default_factory=dict)
    """Each (n, 2), by primvar name (stage) or attribute name (output), v upward."""
    customs: dict[str, Array] = dataclasses.field(default_factory=dict)
    """Values of other float primvars, each (n, k), by the attribute's name."""
    colors: Array | None = None
    """(n, 4) linear RGBA."""
    undefined_colors: tuple[str, ...] = ()
    """Display primvars on parts of a gprim whose order USD does not define, which are left out."""
    materials: Indices | None = None
    """(n,) index into `material_paths` of each corner's material; -1 for none."""
    material_paths: list[str] = dataclasses.field(default_factory=list)
    points: Array = dataclasses.field(default_factory=lambda: np.zeros((0, 3)))
    """(k, 3) positions of point clouds and lines."""
    point_values: dict[str, Array] = dataclasses.field(default_factory=dict)
    """Their attributes' values, each (k, n), by the attribute's name; v upward."""
    double_sided: bool | None = None
    is_lamp: bool = False
    """Whether its material is marked as a light, which keeps the sides that the stage gives it."""


@dataclasses.dataclass
class Surface:
    """A curved gprim whose points a converter may choose, as long as they lie on it."""

    kind: str
    """sphere, cylinder, cone or capsule."""
    radius: tuple[float, float]
    """Radius at bottom and top, in the prim's own units."""
    height: float
    axis: int
    """Axis: 0, 1, 2 for X, Y, Z."""
    matrix: Array
    """Matrix (4, 4) from the prim's space to the world in meters."""
    color: Array | None = None
    """Display color and opacity (4,), a fallback in place of several values; None for none."""
    undefined_colors: tuple[str, ...] = ()
    """Display primvars with several authored values, which are left out."""
    material: str = ""
    """Path of the bound material; empty for none."""


@dataclasses.dataclass
class Camera:
    """A camera at one time."""

    matrix: Array
    yfov: float | None
    """Vertical field of view; None for an orthographic camera."""
    aspect: float
    ymag: float | None
    """Half height of an orthographic view, meters."""
    near_m: float
    far_m: float
    shift: tuple[float, float] = (0.0, 0.0)
    """Shift of the lens to the right and up, in heights of the picture."""
    planes: list[list[float]] = dataclasses.field(default_factory=list)
    """Clip planes in the space of the camera, meters."""
    lost: Lost = dataclasses.field(default_factory=list)
    """Inputs that no glTF camera holds."""


@dataclasses.dataclass
class Light:
    """A light at one time, in the units of KHR_lights_punctual."""

    kind: str
    """directional, point or spot."""
    intensity: Array
    """(3,) color times intensity: lux for directional lights, candela for others."""
    matrix: Array
    outer_cone: float | None = None
    inner_cone: float = 0.0
    """Inner angle of a spot: how far from the axis it is at its brightest."""
    exact: bool = True
    """Whether the light is exact; else a punctual light only approximates the authored one."""
    lost: Lost = dataclasses.field(default_factory=list)
    """Inputs that no punctual light holds."""


@dataclasses.dataclass(frozen=True)
class MeshLight:
    """Light that a surface sends."""

    nits: Array
    """Radiance (3,) in nits."""
    tinted: bool
    """Whether the emission of its material, where it has some, multiplies the light."""


@dataclasses.dataclass
class Scene:
    """Facts compared at one time."""

    corners: dict[str, Corners] = dataclasses.field(default_factory=dict)
    surfaces: dict[str, list[Surface]] = dataclasses.field(default_factory=dict)
    cameras: dict[str, list[Camera]] = dataclasses.field(default_factory=dict)
    lights: dict[str, list[Light]] = dataclasses.field(default_factory=dict)
    matrices: dict[str, list[Array]] = dataclasses.field(default_factory=dict)
    """World matrices of the nodes that stand for a prim, by prim path."""
    other: dict[str, str] = dataclasses.field(default_factory=dict)
    """Prims that draw something else, by path: their type name."""
    mesh_lights: dict[str, MeshLight] = dataclasses.field(default_factory=dict)
    """Prims that draw surfaces and also light the scene with them."""
    dark_lights: set[str] = dataclasses.field(default_factory=set)
    """Prims that draw something else and should light the scene with it."""
    turned: set[str] = dataclasses.field(default_factory=set)
    """Keys of `surfaces` whose documented tessellation is in `corners`."""
    closed: set[str] = dataclasses.field(default_factory=set)
    """Keys of `turned` that hold nothing else: every edge has two triangles."""
    made_of: dict[str, set[str]] = dataclasses.field(default_factory=dict)
    """Prims that an instancer draws, by instancer."""
    lost: dict[str, Lost] = dataclasses.field(default_factory=dict)
    """Other inputs without a place in glTF, by prim."""
    inputs: dict[str, Lost] = dataclasses.field(default_factory=dict)
    """Lost inputs of geometry that is a light, and of environments, by prim."""
    misfits: dict[str, tuple[str, ...]] = dataclasses.field(default_factory=dict)
    """Primvars with values that have no place, by prim."""
    optional: set[str] = dataclasses.field(default_factory=set)
    """Prims that may draw something or nothing: all of their faces are degenerate."""


def stacked(parts: list[dict[str, Array]]) -> dict[str, Array]:
    """Rows of all parts, by the names that every part has."""
    names = sorted(set.intersection(*map(set, parts)))
    return {name: np.vstack([part[name] for part in parts]) for name in names}


def transform_points(points: Array, matrix: Array) -> Array:
    """Row-vector transform of (n, 3) points by a (4, 4) matrix, divided by w as USD does."""
    moved = points @ matrix[:3, :3] + matrix[3, :3]
    if np.array_equal(matrix[:, 3], (0.0, 0.0, 0.0, 1.0)):
        return moved
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(moved / (points @ matrix[:3, 3] + matrix[3, 3])[:, None])


def bounds_of(scenes: Mapping[str, Corners]) -> tuple[Array, Array] | None:
    """Lowest and highest corner over all prims; None where there is none."""
    clouds = [cloud for part in scenes.values() for cloud in (part.positions, part.points)]
    points = np.vstack([np.zeros((0, 3)), *clouds])
    return (points.min(axis=0), points.max(axis=0)) if len(points) else None
