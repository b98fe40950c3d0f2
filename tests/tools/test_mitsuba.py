"""Holds the renderer's `rt` against Mitsuba 3: geometry, direct light and mirrors in linear HDR.

Three small scenes are written twice, as scene text and as Mitsuba objects, and rendered through
the same pixel centers. Mitsuba's curved shapes are exact, ours are tessellated: that, and single
precision at edges, is what may differ. Needs Mitsuba (`pip install mitsuba`), skipped without.
"""

import os
import subprocess

import pytest
from program import BINARY

np = pytest.importorskip("numpy", reason="pictures are compared with NumPy")
mi = pytest.importorskip("mitsuba", reason="the independent renderer is not installed")

WIDTH, HEIGHT, FOV_DEG = 160, 120, 50.0
BOUNCES = 4
LIGHT = {"position": [1.5, 4.0, 2.5], "intensity": 40.0}
mi.set_variant("scalar_rgb")  # this variant needs no LLVM; a few seconds a scene


class Scene:
    """One scene as Reflet's scene text and as Mitsuba objects."""

    def __init__(self, eye, target):
        self.eye, self.target = eye, target
        self.objects = {"type": "scene"}
        self.text = [
            "version = 1",
            f"[camera.main]\neye = {eye}\ntarget = {target}\nfov_deg = {FOV_DEG}",
            f'[light.lamp]\nkind = "point"\nposition = {LIGHT["position"]}\n'
            f'intensity_cd = {LIGHT["intensity"]}\nshadow = "ray"',
            "[environment]\ncolor = [0, 0, 0]",
            # Rays have no length limit, and U is set, so that it needs no bounds.
            f"[reflection]\nbounces = {BOUNCES}\nray_length_u = 1000.0\nunit_m = 1.0",
            '[image]\ntone_map = "none"',
        ]
        self.objects["lamp"] = {
            "type": "point",
            "position": LIGHT["position"],
            "intensity": {"type": "rgb", "value": [LIGHT["intensity"]] * 3},
        }

    def add(self, name, shape, mitsuba, translation, color=None, normal_map=None):
        """Add an object to both scenes: diffuse with a color, a perfect mirror without one."""
        if color is None:
            material = 'metallic = 1\nroughness = 0\nreflection = "mirror"'
            bsdf = {"type": "conductor", "material": "none"}
        else:
            material = f"base_color = {color}\nroughness = 1\nreflectivity = 0"
            bsdf = {"type": "diffuse", "reflectance": {"type": "rgb", "value": color}}
        if normal_map:
            material += f'\nnormal_texture = "{normal_map.name}"'
            texture = {"type": "bitmap", "filename": str(normal_map), "raw": True}
            bsdf = {"type": "normalmap", "normalmap": texture, "nested": bsdf}
        self.text += [
            f"[material.{name}]\n{material}\n",
            f'[model.{name}]\nshape = {shape}\nmaterial = "{name}"\n',
            f'[[instance]]\nmodel = "{name}"\ntranslation = {translation}\n',
        ]
        place = mi.ScalarTransform4f().translate(translation)
        shape = dict(mitsuba)
        shape["to_world"] = place @ shape.get("to_world", mi.ScalarTransform4f())
        shape["bsdf"] = {"type": "twosided", "nested": bsdf} if color is not None else bsdf
        self.objects[name] = shape

    def ours(self, folder):
        """Linear radiance rendered by `reflet render --method rt`."""
        scene, picture = folder / "scene.toml", folder / "picture.exr"
        scene.write_text("\n".join(self.text), encoding="utf-8")
        command = [BINARY, "render", scene, "-o", picture, "--method", "rt"]
        command += ["--size", f"{WIDTH}x{HEIGHT}"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode == 4:
            pytest.skip(f"no adapter: {done.stderr}")
        assert done.returncode == 0, done.stderr
        bitmap = mi.Bitmap(str(picture)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32)
        return np.array(bitmap)

    def theirs(self):
        """Linear radiance by Mitsuba's shapes, BSDFs and emitter: mirrors, then direct light."""
        scene = mi.load_dict(self.objects)
        origin = mi.Point3f(self.eye)
        pixels = [
            self.follow(scene, mi.Ray3f(origin, mi.Vector3f(direction)))
            for direction in self.directions().tolist()
        ]
        return np.array(pixels, dtype=np.float32).reshape(HEIGHT, WIDTH, 3)

    @staticmethod
    def follow(scene, ray):
        """Linear radiance along a ray, by Mitsuba."""
        context, half = mi.BSDFContext(), mi.Point2f(0.5)
        throughput = np.ones(3)
        for _ in range(BOUNCES + 1):
            hit = scene.ray_intersect(ray)
            if not hit.is_valid():
                break
            bsdf = hit.bsdf(ray)
            if mi.has_flag(bsdf.flags(), mi.BSDFFlags.Smooth):
                light, weight = scene.sample_emitter_direction(hit, half, True)
                value = bsdf.eval(context, hit, hit.to_local(light.d))
                return throughput * np.array(value) * np.array(weight)
            sample, weight = bsdf.sample(context, hit, 0.5, half)
            throughput = throughput * np.array(weight)
            ray = hit.spawn_ray(hit.to_world(sample.wo))
        return np.zeros(3)

    def directions(self):
        """Ray directions through pixel centers, row by row from the top left."""
        eye, target = np.array(self.eye, float), np.array(self.target, float)
        forward = (target - eye) / np.linalg.norm(target - eye)
        right = np.cross(forward, [0.0, 1.0, 0.0])
        right /= np.linalg.norm(right)
        up = np.cross(right, forward)
        y, x = np.mgrid[0:HEIGHT, 0:WIDTH].reshape(2, -1)
        half = np.tan(np.radians(FOV_DEG) / 2)
        across = (2 * (x + 0.5) / WIDTH - 1) * half * WIDTH / HEIGHT
        above = (1 - 2 * (y + 0.5) / HEIGHT) * half
        direction = forward[:, None] + right[:, None] * across + up[:, None] * above
        return (direction / np.linalg.norm(direction, axis=0)).T


def plane(size):
    """Floor in the XZ plane, facing +Y."""
    turned = mi.ScalarTransform4f().rotate([1, 0, 0], -90).scale([size / 2, size / 2, 1])
    return f'{{ kind = "plane", size = [{size}, {size}] }}', {
        "type": "rectangle",
        "to_world": turned,
    }


def box(x, y, z):
    """Box; Mitsuba's cube spans -1 to 1."""
    return f'{{ kind = "box", size = [{x}, {y}, {z}] }}', {
        "type": "cube",
        "to_world": mi.ScalarTransform4f().scale([x / 2, y / 2, z / 2]),
    }


def sphere(radius):
    """Sphere, exact in Mitsuba and of 512 segments in Reflet."""
    return f'{{ kind = "sphere", radius = {radius}, segments = 512 }}', {
        "type": "sphere",
        "radius": radius,
    }


def mirror_box(_folder):
    """Scene of a mirror box between a wall, a ball and the floor."""
    scene = Scene([-2.2, 1.9, 3.6], [0.2, 0.6, 0.0])
    scene.add("floor", *plane(8), [0, 0, 0], [0.7, 0.6, 0.5])
    scene.add("wall", *box(0.2, 2.5, 5), [2.6, 1.25, 0], [0.2, 0.3, 0.7])
    scene.add("mirror", *box(1.2, 1.4, 1.0), [0.3, 0.7, -0.4])
    scene.add("ball", *sphere(0.4), [-0.9, 0.4, 0.7], [0.7, 0.1, 0.1])
    return scene


def sphere_on_a_floor(_folder):
    """Scene of two mirror spheres on a floor, which reflect each other."""
    scene = Scene([0.3, 1.6, 4.2], [0.0, 0.6, 0.0])
    scene.add("floor", *plane(9), [0, 0, 0], [0.5, 0.6, 0.4])
    scene.add("left", *sphere(0.7), [-0.8, 0.7, 0.0])
    scene.add("right", *sphere(0.6), [0.75, 0.6, 0.2])
    scene.add("ball", *sphere(0.35), [0.0, 0.35, 1.1], [0.8, 0.5, 0.1])
    return scene


def normal_mapped_floor(folder):
    """Scene with a normal map of waves along one axis: no convention about image rows enters."""
    slope = 0.4 * np.sin(np.linspace(0, 6 * np.pi, 256, endpoint=False))
    normal = np.stack([slope, np.zeros(256), np.sqrt(1 - slope**2)], -1)
    codes = np.round((normal * 0.5 + 0.5) * 255).astype(np.uint8)
    path = folder / "waves.png"
    mi.Bitmap(np.repeat(codes[None], 256, axis=0)).write(str(path))
    scene = Scene([0.0, 2.2, 4.0], [0.0, 0.2, 0.0])
    scene.add("floor", *plane(6), [0, 0, 0], [0.6, 0.6, 0.6], normal_map=path)
    scene.add("mirror", *sphere(0.8), [0.2, 0.8, -0.2])
    return scene


#: Scene; the largest mean of (a - r)² / (r + 0.01)² without the 1 % of pixels that differ most
#: (edges, and the glint of the lamp, which only our mirrors show); the largest share of pixels
#: that differ by more than 2 %. The normal map is filtered by ray cones here, not at all there.
CASES = [
    (mirror_box, 1e-5, 0.002),
    (sphere_on_a_floor, 1e-5, 0.015),
    (normal_mapped_floor, 1e-4, 0.04),
]


@pytest.mark.parametrize(("make", "max_rel_mse", "max_differing"), CASES)
def test_rt_agrees_with_mitsuba(make, max_rel_mse, max_differing, tmp_path):
    """Hold relMSE away from edges, and the share of pixels that differ, under their limits."""
    scene = make(tmp_path)
    ours, theirs = scene.ours(tmp_path), scene.theirs()
    assert theirs.max() > 0.1, "nothing is lit"
    relative = (((ours - theirs) / (theirs + 0.01)) ** 2).mean(-1).ravel()
    trimmed = np.sort(relative)[: int(0.99 * relative.size)].mean()
    differing = (relative > 0.02**2).mean()
    print(
        f"{make.__name__}: relMSE {relative.mean():.2e}, less 1 % {trimmed:.2e}, "
        f"over 2 %: {100 * differing:.2f} % of pixels"
    )
    keep = os.environ.get("REFLET_KEEP_PICTURES")
    if keep:
        both = np.concatenate([ours, theirs, np.abs(ours - theirs) * 10], axis=1)
        mi.util.write_bitmap(f"{keep}/{make.__name__}.png", both.astype(np.float32))
    assert trimmed < max_rel_mse
    assert differing < max_differing
