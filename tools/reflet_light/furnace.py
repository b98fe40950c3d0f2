"""White furnace test: balls in even light, compared by angle with integrals of the lobes."""

import math
import pathlib
import subprocess

import numpy as np
from measuring import read_rows, write_rows

from .scenes import HEAD, ROUGHNESSES, thing

EDGE = 64  # picture size in pixels
FOV_DEG = 2.0  # so that all rays are nearly parallel
DISTANCE_M = 60.0
COSINES = (1.0, 0.8, 0.5, 0.25)
KINDS = {
    "metal": "base_color = [1, 1, 1]\nmetallic = 1\n",
    "dielectric": "base_color = [1, 1, 1]\n",
}
# How the ball's reflected light is found: by rays, or by the split sum past the cut-off.
SIDES = {"traced": "roughness_cutoff = 1", "past the cut-off": "roughness_cutoff = 0"}
COLUMNS = ["kind", "side", "compensated", "roughness", *(f"at {c:g}" for c in COSINES)]

Row = dict[str, str]


def albedo(cosine: float, roughness: float, f0: float = 1.0) -> float:
    """Directional albedo of GGX with the height-correlated Smith term, by integration
    over the facets (Heitz 2014)."""
    a2 = max(roughness**2, 2e-3) ** 2
    steps = 512
    u = (np.arange(steps) + 0.5) / steps
    tan2 = a2 * u / (1 - u)
    c = 1 / np.sqrt(1 + tan2)[:, None]
    s = np.sqrt(1 - c * c)
    phi = 2 * np.pi * u[None, :]
    vh = math.sqrt(1 - cosine**2) * s * np.cos(phi) + cosine * c
    nl = 2 * vh * c - cosine
    ok = (vh > 0) & (nl > 0)
    nl = np.where(ok, nl, 1.0)

    def masking(n: np.ndarray | float) -> np.ndarray:
        return np.sqrt(a2 + (1 - a2) * n * n)

    visible = 0.5 / (nl * masking(cosine) + cosine * masking(nl))
    f90 = min(50 * f0, 1.0)
    fresnel = f0 + (f90 - f0) * (1 - np.clip(vh, 0, 1)) ** 5
    return float(np.where(ok, fresnel * visible * 4 * nl * vh / c, 0).mean())


def scene(kind: str, side: str, compensated: bool, roughness: float) -> str:
    text = HEAD.replace("roughness_cutoff = 1", SIDES[side])
    if compensated:
        text += "multiple_scattering = true\n"
    text += f"[camera.main]\neye = [0, 0, {DISTANCE_M}]\ntarget = [0, 0, 0]\nfov_deg = {FOV_DEG}\n"
    text += "[environment]\ncolor = [1, 1, 1]\n"
    ball = '{ kind = "sphere", radius = 1, segments = 512 }'
    return text + thing("ball", ball, KINDS[kind] + f"roughness = {roughness}")


def at_cosines(picture: np.ndarray) -> list[float]:
    """Mean radiance of a centered ball over rings, one for each cosine in COSINES."""
    half = math.tan(math.radians(FOV_DEG / 2)) * DISTANCE_M
    y, x = (np.mgrid[0:EDGE, 0:EDGE] + 0.5) / EDGE * 2 - 1
    radius = np.hypot(x, y) * half
    cosine = np.sqrt(np.clip(1 - radius**2, 0, 1))
    means = []
    for wanted in COSINES:
        ring = (np.abs(cosine - wanted) < 0.03) & (radius < 0.995)
        means.append(float(picture[ring].mean()))
    return means


def measure(out: pathlib.Path, program: pathlib.Path) -> None:
    import mitsuba as mi

    rows = read_rows(out / "furnace.csv")
    known = {tuple(list(row.values())[:4]) for row in rows}
    for kind in KINDS:
        for side in SIDES:
            for compensated in (False, True):
                for roughness in ROUGHNESSES:
                    key = (kind, side, str(compensated), str(roughness))
                    if key in known:
                        continue
                    text, picture = out / "furnace.toml", out / "furnace.exr"
                    text.write_text(scene(kind, side, compensated, roughness))
                    size = f"{EDGE}x{EDGE}"
                    command: list[str | pathlib.Path] = [program, "render", text, "--size", size]
                    command += ["--samples", "64", "-o", picture]
                    subprocess.run(command, check=True, stderr=subprocess.DEVNULL)
                    found = np.array(mi.Bitmap(str(picture)))[..., :3]
                    values = [f"{v:.4f}" for v in at_cosines(found)]
                    rows.append(dict(zip(COLUMNS, [*key, *values], strict=True)))
                    print(" ".join(rows[-1].values()), flush=True)
                    write_rows(out / "furnace.csv", rows)


def table(out: pathlib.Path) -> str:
    lines = [["---"] * len(COLUMNS)]
    lines += [list(row.values()) for row in read_rows(out / "furnace.csv")]
    return "\n".join(f"| {' | '.join(line)} |" for line in [COLUMNS, *lines])
