"""Owns the comparison of two scenes of facts: the stage's truth and the re-read output."""

import math
from collections.abc import Callable, Collection, Iterable, Sequence

import numpy as np
from scipy.spatial import cKDTree

from .allowed_deviations import MESH_LIGHT, UNKNOWN_SURFACE, UNORDERED_COLORS, UV_SET, absent
from .checks import BARS, Checks
from .compare_cameras_lights import Device, camera_values, light_values, matrix_distance, nearby
from .distances import attribute_distance, one_way, open_edges, set_distance
from .scene_data import Array, Corners, Lost, Scene, Surface
from .surfaces import distances_to_surfaces, surface_box, untouched_extent
from .uv_compare import CoordinateComparer

_FLOAT32_STEP = float(np.finfo(np.float32).eps)
_ROUNDINGS = 4.0
"""Number of roundings to single precision allowed for a stored or transformed coordinate."""


class SceneComparer:
    """Compares scenes at one or more times into one set of checks."""

    def __init__(self, checks: Checks, truth: Scene, skinned: Collection[str]) -> None:
        self.checks = checks
        self.skinned = skinned
        low, high = _bounds(truth)
        self.diagonal = float(np.linalg.norm(high - low)) or 1.0
        # Coordinates far from the origin can only be stored to single precision.
        reach = float(max(np.abs(low).max(), np.abs(high).max()))
        self.slack = _ROUNDINGS * _FLOAT32_STEP * reach / self.diagonal

    def geometry(self, truth: Scene, output: Scene, skip: frozenset[str] = frozenset()) -> None:
        """Compare corners, surfaces and bounds of everything drawn, except the prims in `skip`."""
        excused = self.checks.declared()
        for key in sorted((truth.corners.keys() | truth.surfaces.keys()) - skip):
            found = output.corners.get(key)
            if key in truth.corners and not np.isfinite(_everything(truth.corners[key])).all():
                self.checks.add("positions", key, math.inf, "not finite in the stage")
            elif found is not None and not np.isfinite(found.positions).all():
                self.checks.add("positions", key, math.inf, "not finite")
            elif key in truth.turned:
                self._turned(truth, key, found)
            elif key in truth.corners and key in truth.surfaces:
                self._mixed(key, truth.corners[key], truth.surfaces[key], found)
            elif key in truth.corners:
                self._corners(key, truth.corners[key], found, key in self.skinned)
            else:
                self._surfaces(key, truth.surfaces[key], found)
        known = truth.corners.keys() | truth.surfaces.keys() | truth.other.keys() | truth.optional
        for key, found in output.corners.items():
            if key not in known and (len(found.positions) or len(found.points)):
                self.checks.add("unexpected", key, 1, "drawn only in the output")
        for kind, ours, theirs in (
            ("camera", truth.cameras, output.cameras),
            ("light", truth.lights, output.lights),
        ):
            for key in sorted(theirs.keys() - ours.keys()):
                self.checks.add("unexpected", key, 1, f"a {kind} only in the output")
        if self.checks.declared() == excused and not skip:  # else the box is known to differ
            self._bounds(truth, output)

    def other(self, truth: Scene, output: Scene) -> None:
        """Compare prims of kinds without a numeric measure: carried or declared."""
        for key, kind in truth.other.items():
            there = key in output.corners or key in output.lights
            self._is_carried(key, there, kind)
        for prim, lost in (*truth.lost.items(), *truth.inputs.items()):
            self._lost(prim, lost)
        for prim, names in truth.misfits.items():
            for name in names:
                text = f"'{name}' has values without a place"
                self.checks.add_lost(prim, UV_SET, text, name)
        for prim in sorted(truth.dark_lights):
            self.checks.add_lost(prim, MESH_LIGHT, "shines")

    def matrices(self, truth: Scene, output: Scene, at: str) -> None:
        """Compare world matrices of all nodes that stand for a transformable prim."""
        self.matrices_of(truth.matrices, output.matrices, at)

    def matrices_of(
        self, truth: dict[str, list[Array]], output: dict[str, list[Array]], at: str
    ) -> None:
        """Compare world matrices, given by prim path."""
        for prim, found in output.items():
            if prim in self.skinned:
                continue  # glTF ignores the transforms of a skinned mesh's own node
            for expected in truth.get(prim, ())[:1]:
                value = min(matrix_distance(expected, matrix, self.diagonal) for matrix in found)
                self.checks.add("matrices", prim, value, at, self.slack)

    def joints(
        self,
        truth: dict[str, dict[str, Array]],
        output: dict[str, dict[str, list[Array]]],
        at: str,
    ) -> None:
        """Compare world matrices of the joints that both sides have."""
        for skeleton, expected in truth.items():
            for name, matrices in output.get(skeleton, {}).items():
                if name in expected:
                    value = min(
                        matrix_distance(expected[name], matrix, self.diagonal)
                        for matrix in matrices
                    )
                    self.checks.add("joints", skeleton, value, f"{name} {at}", self.slack)

    def cameras(self, truth: Scene, output: Scene, at: str) -> None:
        """Compare lenses and places of all cameras."""
        for key, expected in truth.cameras.items():
            self._devices("cameras", key, expected, output.cameras.get(key, []), at, camera_values)

    def lights(self, truth: Scene, output: Scene, at: str) -> None:
        """Compare kinds, intensities and places of all lights that punctual lights stand for."""
        for key, expected in truth.lights.items():
            self._devices("lights", key, expected, output.lights.get(key, []), at, light_values)

    def hold_sizes(self, truth: Scene, rest: Scene, frozen: set[str]) -> None:
        """Set the power of lights in `frozen`, at any time, to the power of their size at rest."""
        for key, lights in truth.lights.items():
            first = rest.lights.get(key, [])
            if frozen & (truth.made_of.get(key, set()) | {key}) and len(first) == len(lights):
                for light, still in zip(lights, first, strict=True):
                    light.intensity = still.intensity

    def _devices(
        self,
        check: str,
        key: str,
        expected: Sequence[Device],
        found: Sequence[Device],
        at: str,
        measure: Callable[[Device, Device, float], Iterable[tuple[str, float]]],
    ) -> None:
        """Compare each device of the stage with the file's nearest; an instancer draws several."""
        if not self._is_carried(key, len(found) >= len(expected), check[:-1]):
            return
        if len(found) > len(expected):
            self.checks.add("unexpected", key, len(found) - len(expected), f"{check} too many")
        self._lost(key, list(dict.fromkeys(entry for one in expected for entry in one.lost)))
        for one, near in zip(expected, nearby(expected, found), strict=True):
            pairs = [list(measure(one, found[other], self.diagonal)) for other in near]
            best = min(pairs, key=lambda values: max((value for _, value in values), default=0.0))
            for text, value in best:
                self.checks.add(check, key, value, f"{text} {at}", self.slack)

    def _lost(self, key: str, lost: Lost) -> None:
        for warning, text in lost:
            named = text[1:-1] if text.startswith("'") and text.endswith("'") else ""
            self.checks.add_lost(key, (warning,), text, named)

    def _is_carried(self, key: str, there: bool, what: str) -> bool:
        text = f"{what} is not in the output"
        self.checks.add("carried", key, 0 if there else 1, text, excuses=absent(what))
        return there

    def _corners(self, key: str, expected: Corners, found: Corners | None, skinned: bool) -> None:
        if len(expected.points):
            there = found is not None and bool(len(found.points))
            if self._is_carried(key, there, "points"):
                assert found is not None
                value = set_distance(expected.points, found.points) / self.diagonal
                self.checks.add("positions", key, value, "points", self.slack)
                reach = self.diagonal * (BARS["positions"].limit + self.slack)
                CoordinateComparer(self.checks, key, expected, found, reach).point_values()
        if not len(expected.positions):
            return
        there = found is not None and bool(len(found.positions))
        if not self._is_carried(key, there, "geometry"):
            return
        assert found is not None
        allowed = np.vstack([expected.positions, expected.optional_positions])
        value = max(one_way(expected.positions, found.positions), one_way(found.positions, allowed))
        name = "skinning" if skinned else "positions"
        self.checks.add(name, key, value / self.diagonal, "corners", self.slack)
        missing = expected.triangles - found.triangles
        surplus = found.triangles - expected.triangles - expected.optional_triangles
        text = f"{found.triangles} triangles, expected {expected.triangles}"
        self.checks.add("triangles", key, max(missing, surplus, 0), text)
        self._areas(key, expected, found)
        self._attributes(key, expected, found, skinned)

    def _surfaces(self, key: str, surfaces: list[Surface], found: Corners | None) -> None:
        if self._is_carried(key, found is not None and bool(len(found.positions)), "geometry"):
            assert found is not None
            away = distances_to_surfaces(surfaces, found.positions)
            value = max(float(away.max(initial=0.0)), untouched_extent(surfaces, found.positions))
            self.checks.add("surfaces", key, value / self.diagonal, "from the surface", self.slack)
            self._surface_looks(key, surfaces, found)

    def _turned(self, truth: Scene, key: str, found: Corners | None) -> None:
        """Compare curved gprims in their documented tessellation: as meshes, and on the surface."""
        expected = truth.corners[key]
        self._corners(key, expected, found, skinned=False)
        if found is None or key not in truth.closed or not len(found.positions):
            return
        away = distances_to_surfaces(truth.surfaces[key], found.positions)
        # Distances to a flattened surface are infinite and not compared.
        value = float(away[np.isfinite(away)].max(initial=0.0)) / self.diagonal
        self.checks.add("surfaces", key, value, "from the surface", self.slack)
        number = open_edges(expected.positions, found.positions)
        self.checks.add("winding", key, number, "edges without their opposite")

    def _surface_looks(self, key: str, surfaces: list[Surface], found: Corners) -> None:
        """Compare display colors and materials of curved gprims, as sets over the instances."""
        bound = {_name(surface.material) for surface in surfaces if surface.material}
        for name in sorted(bound ^ {_name(path) for path in found.material_paths}):
            wrong = "is not used" if name in bound else "is used only in the output"
            self.checks.add("bindings", key, math.inf, f"{name} {wrong}")
        colors = [surface.color for surface in surfaces if surface.color is not None]
        for surface in surfaces:
            self._undefined_colors(key, surface.undefined_colors)
        if len(colors) == len(surfaces) and not bound and found.colors is not None:
            value = set_distance(np.array(colors), np.unique(found.colors, axis=0))
            self.checks.add("colors", key, value, "display color or opacity")

    def _mixed(
        self, key: str, expected: Corners, surfaces: list[Surface], found: Corners | None
    ) -> None:
        """Compare an instancer of polygons and curved gprims: each corner lies on either."""
        if self._is_carried(key, found is not None and bool(len(found.positions)), "geometry"):
            assert found is not None
            allowed = np.vstack([expected.positions, expected.optional_positions])
            reach = self.diagonal * (BARS["positions"].limit + self.slack)
            on_polygons = cKDTree(allowed).query(found.positions)[0] <= reach
            value = one_way(expected.positions, found.positions) / self.diagonal
            self.checks.add("positions", key, value, "corners", self.slack)
            rest = found.positions[~on_polygons]
            away = float(distances_to_surfaces(surfaces, rest).max(initial=0.0))
            value = max(away, untouched_extent(surfaces, rest)) / self.diagonal
            self.checks.add("surfaces", key, value, "from the surface", self.slack)

    def _areas(self, key: str, expected: Corners, found: Corners) -> None:
        more: tuple[float, Array, float] = (0.0, np.zeros(3), 0.0)
        if found.triangles != expected.triangles and expected.optional_triangles:
            if found.triangles != expected.triangles + expected.optional_triangles:
                return  # unknown which degenerate faces were drawn
            more = expected.optional_measures
        low, high = expected.area_range[0] + more[0], expected.area_range[1] + more[0]
        size = _size(expected.positions)
        area = max(high, 1e-6 * size**2)
        if not area > 0.0 or not math.isfinite(area):
            return  # all at one place, or too far apart to multiply: positions were compared
        # Rounding one coordinate moves an area by the rounding times the extent.
        slack = self.slack * self.diagonal * size * math.sqrt(expected.triangles + 1) / area
        outside = max(low - found.area_range[0], found.area_range[0] - high, 0.0)
        text = f"{found.area_range[0]:.6g} m2, expected {low:.6g}"
        self.checks.add("area", key, outside / area, text, slack)
        turned = float(np.linalg.norm(expected.vector_area + more[1] - found.vector_area)) / area
        self.checks.add("winding", key, turned, "area vector", slack)
        first, last = (end + more[2] for end in expected.volume_range)
        # Both volumes are seen from the same center: the volume of an open mesh depends on it.
        shift = (found.center - expected.center) @ found.vector_area / 3
        volume = found.volume_range[0] + float(shift)
        beyond = max(first - volume, volume - last, 0.0) / (area * max(size, 1e-30))
        self.checks.add("winding", key, beyond, "signed volume", slack)

    def _attributes(self, key: str, expected: Corners, found: Corners, skinned: bool) -> None:
        tolerance = self.diagonal * (BARS["positions"].limit + self.slack)
        both = expected.optional_triangles == 0
        # Normals of flattened surfaces are not defined.
        if expected.normals is not None and not skinned and np.isfinite(expected.normals).any():
            if found.normals is None:
                self.checks.add("normals", key, 180.0, "no normals in the output")
            else:
                step = 2 * math.sin(math.radians(BARS["normals"].limit) / 2)
                chord = attribute_distance(
                    (expected.positions, expected.normals),
                    (found.positions, found.normals),
                    tolerance,
                    step,
                    both,
                )
                angle = 2 * math.degrees(math.asin(min(chord / 2, 1.0)))
                self.checks.add("normals", key, angle, "angle")
        coordinates = CoordinateComparer.for_prim(self.checks, key, expected, found, tolerance)
        coordinates.uvs()
        coordinates.customs()
        unbound = expected.materials is not None and bool((expected.materials < 0).all())
        if unbound:
            self._undefined_colors(key, expected.undefined_colors)
        if expected.colors is not None and found.colors is not None and unbound:
            value = attribute_distance(
                (coordinates.expected.positions, expected.colors),
                (coordinates.found.positions, found.colors),
                tolerance,
                BARS["colors"].limit,
                both,
            )
            self.checks.add("colors", key, value, "display color or opacity")
        sides = expected.double_sided if found.is_lamp else True
        if sides is not None:
            wrong = found.double_sided is not None and found.double_sided != sides
            text = f"doubleSided should be {sides}"
            self.checks.add("sides", key, int(wrong), text)
        self._bindings(key, expected, found)

    def _undefined_colors(self, key: str, names: tuple[str, ...]) -> None:
        for name in names:
            text = f"several values of '{name}' on a gprim, whose faces USD does not number"
            self.checks.add_lost(key, UNORDERED_COLORS, text, name, "colors")

    def _bindings(self, key: str, expected: Corners, found: Corners) -> None:
        """Compare the corners of each material, as sets, by the material's name."""
        if expected.materials is None or found.materials is None:
            return
        names = [{_name(path) for path in side.material_paths} for side in (expected, found)]
        bare = (expected.materials < 0).any() or (found.materials < 0).any()
        if names[0] == names[1] and len(names[0]) <= 1 and not bare:
            self.checks.add("bindings", key, 0.0)  # both sides have one material on everything
            return
        there = {path.rsplit("/", 1)[-1]: i for i, path in enumerate(found.material_paths)}
        for index, path in enumerate(expected.material_paths):
            wanted = expected.positions[expected.materials == index]
            if not len(wanted):
                continue
            same = [i for i, p in enumerate(expected.material_paths) if _name(p) == _name(path)]
            wanted = expected.positions[np.isin(expected.materials, same)]
            number = there.get(_name(path))
            if number is None:
                told = UNKNOWN_SURFACE
                subject = path if self.checks.excuse(path, told) else key
                self.checks.add("bindings", subject, math.inf, f"{path} is not used", excuses=told)
                continue
            drawn = found.positions[found.materials == number]
            allowed = np.vstack([wanted, expected.optional_positions])
            value = max(one_way(wanted, drawn), one_way(drawn, allowed))
            self.checks.add("bindings", key, value / self.diagonal, path, self.slack)

    def _bounds(self, truth: Scene, output: Scene) -> None:
        """Compare the box of everything that both sides hold; missing prims were noted already."""
        shared = truth.corners.keys() | truth.surfaces.keys()
        clouds = [_everything(output.corners[key]) for key in shared if key in output.corners]
        clouds = [cloud for cloud in clouds if len(cloud)]
        keys = {key for key in shared if key in output.corners}
        if not clouds or keys != shared or truth.other:
            return
        low, high = _bounds(truth)
        points = np.vstack(clouds)
        off = max(np.abs(points.min(0) - low).max(), np.abs(points.max(0) - high).max())
        rough = [many for key, many in truth.surfaces.items() if key not in truth.turned]
        turned = [s for many in rough for s in many if not _is_aligned(s.matrix)]
        # A turned curved gprim touches its box where its tessellation need not have a vertex.
        if not turned:
            self.checks.add("bounds", "/", float(off) / self.diagonal, "bounding box", self.slack)


def _bounds(scene: Scene) -> tuple[Array, Array]:
    clouds = [_everything(part) for part in scene.corners.values()]
    rough = [many for key, many in scene.surfaces.items() if key not in scene.turned]
    clouds += [surface_box(surface) for many in rough for surface in many]
    points = np.vstack([np.zeros((0, 3)), *clouds])
    points = points[np.isfinite(points).all(axis=1)]
    if not len(points):
        return np.zeros(3), np.zeros(3)
    return points.min(axis=0), points.max(axis=0)


def _everything(part: Corners) -> Array:
    return np.vstack([part.positions, part.points])


def _size(points: Array) -> float:
    return float(np.linalg.norm(points.max(axis=0) - points.min(axis=0)))


def _is_aligned(matrix: Array) -> bool:
    """Whether each axis of the prim stays along some axis of the world."""
    linear = np.abs(matrix[:3, :3])
    return bool((np.sort(linear, axis=1)[:, :2] <= 1e-9 * linear.max()).all())


def _name(path: str) -> str:
    return path.rsplit("/", 1)[-1]
