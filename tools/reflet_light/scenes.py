"""The scenes of docs/light.md, as scene text that both renderers read."""

import dataclasses
import math
from collections.abc import Callable

import numpy as np

ROUGHNESSES = (0.08, 0.16, 0.24, 0.4, 0.7, 1.0)


@dataclasses.dataclass(frozen=True)
class Scene:
    """One compared scene. `depth` is the maximum number of segments of Mitsuba's paths."""

    name: str
    shows: str
    text: str
    depth: int
    samples: int = 1024
    # Scene texts at moments while the shutter is open, whose pictures Mitsuba averages.
    moments: tuple[str, ...] = ()


HEAD = """version = 1
[image]
tone_map = "none"
[reflection]
method = "rt"
multiple_scattering = false
roughness_cutoff = 1
glint_limit = 0
bounces = 12
unit_m = 1
ray_length_u = 1000
"""
CLOSE_UP = HEAD + "[camera.main]\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nfov_deg = 34\n"
SKY = '[environment]\nfile = "sky.exr"\n'
DARK = "[environment]\ncolor = [0, 0, 0]\n"
GRADIENT = "[environment]\nzenith = [0.9, 1.1, 1.4]\nhorizon = [0.5, 0.45, 0.4]\n"
GRADIENT += "ground = [0.08, 0.06, 0.05]\n"


def thing(name: str, shape: str, material: str, place: str = "") -> str:
    return (
        f'[material.{name}]\n{material}\n[model.{name}]\nshape = {shape}\nmaterial = "{name}"\n'
        f'[[instance]]\nmodel = "{name}"\n{place}\n'
    )


def sphere(radius: float, segments: int = 256) -> str:
    return f'{{ kind = "sphere", radius = {radius}, segments = {segments} }}'


def box(size: str) -> str:
    return f'{{ kind = "box", size = {size} }}'


def matte(color: str) -> str:
    return f"base_color = {color}\nreflectivity = 0"


def glow(color: str) -> str:
    return f"{matte('[0, 0, 0]')}\nemission = {color}"


def lamp(color: str) -> str:
    return glow(color) + "\nlight = true"


def walls(side: int, surface: Callable[[str], str], places: list[tuple[str, str, str]]) -> str:
    """Squares by their place, turn and color."""
    square = f'{{ kind = "plane", size = [{side}, {side}] }}'
    return "".join(
        thing(f"wall{i}", square, surface(color), f"translation = {at}\nrotation_deg = {turn}")
        for i, (at, turn, color) in enumerate(places)
    )


BALL = '{ kind = "sphere", radius = 1 }'
METAL = "base_color = [1.0, 0.78, 0.34]\nmetallic = 1\n"
PLASTIC = "base_color = [0.5, 0.08, 0.06]\n"
MATTE = matte("[0.7, 0.7, 0.7]")


def ball(material: str) -> str:
    return CLOSE_UP + SKY + thing("ball", BALL, material)


def rough_balls() -> list[Scene]:
    scenes = []
    for kind, material in (("metal", METAL), ("dielectric", PLASTIC)):
        for roughness in ROUGHNESSES:
            name = f"{kind}-{round(100 * roughness):03}"
            text = ball(material + f"roughness = {roughness}")
            shows = f"{kind} of roughness {roughness:g} under a panorama"
            scenes.append(Scene(name, shows, text, 2))
    return scenes


def panels() -> str:
    """A box of glowing walls around a ball."""
    places = [
        ("[0, -2, 0]", "[0, 0, 0]", "[0.3, 0.3, 0.25]"),
        ("[0, 4, 0]", "[180, 0, 0]", "[0.6, 0.7, 0.9]"),
        ("[-3, 1, 0]", "[0, 0, -90]", "[0.9, 0.15, 0.1]"),
        ("[3, 1, 0]", "[0, 0, 90]", "[0.1, 0.6, 0.15]"),
        ("[0, 1, -3]", "[90, 0, 0]", "[0.5, 0.45, 0.1]"),
    ]
    return DARK + walls(6, glow, places)


FLOOR = HEAD + "[camera.main]\neye = [0, 3, 6]\ntarget = [0, 0.6, 0]\nfov_deg = 40\n" + DARK
FLOOR += thing("floor", '{ kind = "plane", size = [40, 40] }', MATTE)
FLOOR += thing(
    "block",
    box("[0.8, 1.2, 0.8]"),
    matte("[0.2, 0.4, 0.7]"),
    "translation = [0.4, 0.6, 0]\nrotation_deg = [0, 30, 0]",
)
LIGHTS = {
    "point": ('kind = "point"\nposition = [-2, 4, 2]\nintensity_cd = 40\nshadow = "ray"', 64),
    "sphere": ('kind = "point"\nposition = [-2, 4, 2]\nintensity_cd = 40\nradius_m = 0.5', 1024),
    "spot": (
        'kind = "spot"\nposition = [-2, 4, 2]\ndirection = [2, -3.4, -2]\ninner_deg = 24.9\n'
        'outer_deg = 25\nintensity_cd = 40\nshadow = "ray"',
        64,
    ),
    "sun": (
        'kind = "directional"\ndirection = [2, -4, -2]\nintensity_lux = 3\nangle_deg = 8',
        1024,
    ),
    "rect": (
        'kind = "rect"\nposition = [-2, 3, 1]\ntarget = [0.2, 0, 0]\nsize = [1.6, 0.8]\n'
        "intensity_cd = 30",
        1024,
    ),
    "disk": (
        'kind = "disk"\nposition = [2.2, 3, 1]\ntarget = [0.2, 0, 0]\nradius_m = 0.7\n'
        "intensity_cd = 30",
        1024,
    ),
}


def lights() -> list[Scene]:
    names = {
        "point": "point light", "sphere": "point light with a radius", "spot": "spot light",
        "sun": "directional light that spans 8°", "rect": "rectangle", "disk": "disk",
    }  # fmt: skip
    return [
        Scene(f"light-{name}", f"{names[name]}, a block and its shadow",
              FLOOR + f"[light.l]\n{text}\n", 2, samples)
        for name, (text, samples) in LIGHTS.items()
    ]  # fmt: skip


def surfaces_that_light() -> list[Scene]:
    """Scenes of a glowing ball and a glowing box, as surfaces that light."""
    bulb, cube = sphere(0.5, 160), box("[0.3, 0.3, 2]")
    lamps = thing("lamp", bulb, lamp("[8, 7, 5]"), "translation = [-1.6, 2.2, 0.8]")
    lamps += thing("cube", cube, lamp("[2, 4, 9]"), "translation = [1.9, 0.5, 0]")
    satin = "base_color = [0.9, 0.9, 0.9]\nmetallic = 1\nroughness = 0.3"
    metal = FLOOR.replace(MATTE, satin).split("[material.block]")[0] + lamps
    shows = "a ball and a box that glow"
    return [
        Scene("light-mesh", f"{shows}, and shadows", FLOOR + lamps, 2),
        Scene("light-mesh-metal", f"rough metal floor below {shows}", metal, 3),
    ]


def room() -> str:
    """Scene of a closed room with colored walls, a block and a lamp below the ceiling."""
    head = HEAD + DARK + "[camera.main]\neye = [0, 1, 2.4]\ntarget = [0, 1, 0]\nfov_deg = 60\n"
    places = [
        ("[0, 0, 0]", "[0, 0, 0]", "[0.7, 0.7, 0.7]"),
        ("[0, 2, 0]", "[180, 0, 0]", "[0.7, 0.7, 0.7]"),
        ("[-1.5, 1, 0]", "[0, 0, -90]", "[0.7, 0.12, 0.1]"),
        ("[1.5, 1, 0]", "[0, 0, 90]", "[0.12, 0.5, 0.14]"),
        ("[0, 1, -1.5]", "[90, 0, 0]", "[0.7, 0.7, 0.7]"),
        ("[0, 1, 2.5]", "[-90, 0, 0]", "[0.5, 0.5, 0.5]"),
    ]
    flat = box("[0.7, 0.04, 0.7]")
    shining = thing("lamp", flat, lamp("[6, 6, 6]"), "translation = [0, 1.9, 0]")
    return head + walls(5, matte, places) + shining


def indirect() -> list[Scene]:
    turned = "translation = [-0.5, 0.55, -0.6]\nrotation_deg = [0, 25, 0]"
    block = thing("block", box("[0.6, 1.1, 0.6]"), MATTE, turned)
    rough = METAL + "roughness = 0.2"
    metal = thing("metal", sphere(0.4), rough, "translation = [0.55, 0.4, -0.5]")
    clear = "transmission = 1\nior = 1.5\nthickness_m = 1\nroughness = 0"
    glass = thing("glass", sphere(0.25), clear, "translation = [-0.1, 0.25, 0.3]")
    scenes = []
    for n in (1, 4):
        bounces = f"bounces = 12\ndiffuse_bounces = {n}"
        text = (room() + block).replace("bounces = 12", bounces)
        scenes.append(
            Scene(f"room-{n}", f"room of matte walls, {n} diffuse bounces", text, n + 2, 4096)
        )
    text = (room() + block + metal + glass).replace('"rt"', '"path"')
    return [
        *scenes,
        Scene("room-path", "the same with metal and glass, by all paths", text, 32, 4096),
    ]


def out_of_focus() -> Scene:
    """Scene of glowing balls before, in and behind the plane in focus."""
    text = HEAD + DARK + "[camera.main]\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nfov_deg = 34\n"
    text += "aperture_f = 0.15\nfocus_m = 4\n"
    small = sphere(0.4)
    for name, place, color in (
        ("near", "[-0.6, 0.1, 1.6]", "[0.9, 0.3, 0.1]"),
        ("sharp", "[0.1, -0.1, 0]", "[0.2, 0.8, 0.2]"),
        ("far", "[1.6, 0.2, -3]", "[0.1, 0.3, 0.9]"),
    ):
        text += thing(name, small, glow(color), f"translation = {place}")
    return Scene("depth-of-field", "glowing balls through a lens, one in focus", text, 2)


def moving() -> Scene:
    """Scene of a mirror ball that crosses a room of glowing walls while the shutter is open."""
    moments = 64
    head = CLOSE_UP + panels()
    small = sphere(0.5)

    def at(x: float) -> str:
        place = f'name = "metal"\ntranslation = [{x}, 0.4, 0]'
        text = head + thing("metal", small, METAL + "roughness = 0", place)
        return text + thing("lamp", small, glow("[2, 2, 1.5]"), "translation = [0.3, -0.9, 0.5]")

    keys = "[{ at_s = 0, value = [-0.8, 0.4, 0] }, { at_s = 2, value = [0.8, 0.4, 0] }]"
    text = at(0.0).replace("[image]\n", "[image]\nshutter = 0.5\n")
    text += "[timeline]\nfps = 1\nstart = 1\nend = 2\n"
    text += f"[motion.instance.metal]\ntranslation = {{ keys = {keys} }}\n"
    # The shutter is open for half a frame around second 1: x from -0.2 to 0.2.
    still = tuple(at(-0.2 + 0.4 * (i + 0.5) / moments) for i in range(moments))
    return Scene("motion-blur", "a mirror ball that moves, half a frame", text, 8, 1024, still)


def past_the_cutoff() -> list[Scene]:
    """Scenes with roughness past the cut-off, shaded by the split sum."""
    head = (CLOSE_UP + GRADIENT).replace("roughness_cutoff = 1", "roughness_cutoff = 0")
    scenes = []
    for roughness in (0.24, 0.4, 0.7, 1.0):
        shows = f"metal of roughness {roughness:g} under a gradient, past the cut-off"
        text = head + thing("ball", BALL, METAL + f"roughness = {roughness}")
        scenes.append(Scene(f"far-{round(100 * roughness):03}", shows, text, 2, 64))
    return scenes


def cloth() -> list[Scene]:
    """Scenes with sheen and colored specular lobes."""
    felt = "base_color = [0.16, 0.03, 0.05]\nroughness = 0.9\nsheen_color = [0.9, 0.5, 0.4]\n"
    satin = "base_color = [0.03, 0.05, 0.2]\nroughness = 0.35\nsheen_color = [0.6, 0.7, 1]\n"
    tinted = "base_color = [0.05, 0.08, 0.25]\nroughness = 0.3\nreflectivity = 0.08\n"
    return [
        Scene("sheen", "sheen of roughness 0.8 over a dielectric",
              ball(felt + "sheen_roughness = 0.8"), 2),
        Scene("sheen-sharp", "sheen of roughness 0.35 over a dielectric",
              ball(satin + "sheen_roughness = 0.35"), 2),
        Scene("specular-color", "dielectric with a golden specular lobe",
              ball(tinted + "specular_color = [8, 5, 1.5]"), 2),
        Scene("specular-half", "dielectric with half of its specular lobe",
              ball(PLASTIC + "roughness = 0.3\nspecular = 0.5"), 2),
    ]  # fmt: skip


def in_fog(text: str, fog: str) -> str:
    return text.replace("[environment]\n", f"[environment]\nfog = {{ {fog} }}\n")


def fogs() -> list[Scene]:
    """Scenes in fog: light that is scattered once, twice, and without limit."""
    gray = "density = 0.15, color = [0.9, 0.7, 0.5]"

    def lit(light: str, fog: str) -> str:
        return in_fog(FLOOR, fog) + f"[light.l]\n{LIGHTS[light][0]}\n"

    once = "in fog that scatters once"
    lamps = next(scene.text for scene in surfaces_that_light() if scene.name == "light-mesh")
    low = "density = 0.4, color = [0.9, 0.7, 0.5], height_m = 0.4, falloff_m = 0.6"
    twice = lit("point", gray).replace("bounces = 12", "bounces = 12\ndiffuse_bounces = 1")
    milk = "density = 0.25, color = [0.9, 0.8, 0.6], anisotropy = 0.3"
    smooth = "metallic = 1\nroughness = 0"
    mirror = thing("mirror", sphere(0.5), smooth, "translation = [-1, 0.5, 0.6]")
    sky = FLOOR.replace(DARK, GRADIENT) + mirror
    paths = [text.replace('"rt"', '"path"') for text in (lamps + mirror, sky)]
    return [
        Scene("fog-point", f"point light {once}", lit("point", gray), 2, 256),
        Scene("fog-spot", f"spot light {once}, forward",
              lit("spot", gray + ", anisotropy = 0.6"), 2, 256),
        Scene("fog-sphere", f"point light with a radius {once}", lit("sphere", gray), 2),
        Scene("fog-rect", f"rectangle {once}, backward",
              lit("rect", gray + ", anisotropy = -0.4").replace("[-2, 3, 1]", "[-2, 4.2, 1]"), 2),
        Scene("fog-sun", f"directional light that spans 8° {once}", lit("sun", gray), 2),
        Scene("fog-mesh", f"a ball and a box that glow {once}", in_fog(lamps, gray), 2),
        Scene("fog-height", "point light in fog that thins out from 0.4 m on, scattered once",
              lit("point", low), 2, 256),
        Scene("fog-twice", "point light, 1 diffuse bounce in fog", twice, 3, 4096),
        Scene("fog-path", "thick fog, surfaces that glow and a mirror, by all paths",
              in_fog(paths[0], milk), 32, 1024),
        Scene("fog-sky", "fog under a gradient, with a mirror, by all paths",
              in_fog(paths[1], milk), 32, 128),
    ]  # fmt: skip


def all_scenes() -> list[Scene]:
    glass = "transmission = 1\nior = 1.5\n"
    solid = glass + "thickness_m = 1\n"
    lacquer = "base_color = [0.42, 0.03, 0.035]\nroughness = 0.5\nclearcoat = 1\n"
    shiny = METAL + "roughness = 0.24"
    in_panels = CLOSE_UP.replace("fov_deg = 34", "fov_deg = 60") + panels()
    satin = "base_color = [0.9, 0.9, 0.9]\nmetallic = 1\nroughness = 0.4"
    satin_floor = FLOOR.replace(MATTE, satin).split("[material.block]")[0]
    satin_floor += f"[light.l]\n{LIGHTS['rect'][0]}\n"
    brushed = "base_color = [1, 1, 1]\nmetallic = 1\nroughness = 0.3\nanisotropy = 0.7"
    brushed_floor = satin_floor.replace(satin, brushed)
    return [
        *rough_balls(),
        Scene("metal-gradient", "metal of roughness 0.4 under a gradient",
              CLOSE_UP + GRADIENT + thing("ball", BALL, METAL + "roughness = 0.4"), 2),
        *past_the_cutoff(),
        Scene("metal-panels", "metal of roughness 0.24 in a room of glowing walls",
              in_panels + thing("ball", BALL, shiny), 8),
        Scene("mirror-panels", "mirror in a room of glowing walls",
              in_panels + thing("ball", BALL, METAL + "roughness = 0"), 8, 256),
        Scene("metal-rect", "rough metal floor below a rectangle", satin_floor, 3),
        Scene("metal-brushed", "floor of anisotropic metal below a rectangle", brushed_floor, 3),
        Scene("glass", "solid ball of glass, index 1.5", ball(solid + "roughness = 0"), 64),
        Scene("glass-rough", "solid ball of glass, roughness 0.4",
              ball(solid + "roughness = 0.4"), 64, 4096),
        Scene("glass-thin", "thin hollow ball of glass", ball(glass + "roughness = 0"), 16),
        Scene("clearcoat", "clear coat over roughness 0.5", ball(lacquer), 2),
        Scene("clearcoat-rough", "clear coat of roughness 0.24 over roughness 0.7",
              ball(lacquer.replace("0.5\n", "0.7\n") + "clearcoat_roughness = 0.24"), 2),
        *cloth(),
        out_of_focus(),
        moving(),
        *lights(),
        *surfaces_that_light(),
        *indirect(),
        *fogs(),
    ]  # fmt: skip


def panorama() -> np.ndarray:
    """A sky with a bright window, smooth enough that both renderers interpolate it alike."""
    height, width = 64, 128
    y, x = np.mgrid[0:height, 0:width]
    latitude = np.pi * (0.5 - (y + 0.5) / height)
    longitude = 2 * np.pi * (0.5 - (x + 0.5) / width)
    up = np.sin(latitude)[..., None]
    sky = np.where(up > 0, 0.4 + up * [0.2, 0.5, 1.0], 0.4 + up * [0.2, 0.25, 0.3])
    bands = 1 + 0.5 * np.cos(8 * longitude)[..., None] * np.cos(latitude)[..., None]

    def spot(longitude_deg: float, latitude_deg: float, width_deg: float) -> np.ndarray:
        to = [math.radians(v) for v in (longitude_deg, latitude_deg)]
        cosine = np.sin(latitude) * math.sin(to[1])
        cosine = cosine + np.cos(latitude) * math.cos(to[1]) * np.cos(longitude - to[0])
        angle = np.arccos(np.clip(cosine, -1, 1))
        return np.exp(-((angle / math.radians(width_deg)) ** 2))[..., None]

    glow = spot(35, 40, 12) * [30.0, 26.0, 20.0] + spot(-70, 15, 20) * [1.0, 2.0, 4.0]
    return (sky * bands + glow).astype(np.float32)
