"""The two rules by which the march accepts a hit, compared (docs/acceptance.md).

Every shipped scene in five views (frames of its timeline, or a camera that sways), in two sizes.
The verified rule has no parameter to choose. The threshold rule gets, for each scene, the T that is
best on all other scenes among the values that cost no more there.
"""

import dataclasses
import json
import math
import pathlib
import random
import statistics
import subprocess
import sys
from collections.abc import Callable, Sequence

import tomllib
from measuring import ROOT, settings
from tables import Row, Rows, mean, read_rows, table, values, write_rows

from documents.document import DATA, Document, Run, accepted_px, in_places, some_columns

SCENES = ["scenes/*.toml", "scenes/fail/0[2-6]-*.toml", "scripts/*.toml"]
SCENES += ["scenes/paper/s*[0-9a].toml"]  # of the variations of scenario3.toml none
# Their reflections are sampled, so that noise would be scored beside the march's samples.
SAMPLED = ["studio", "interior", "street"]
SIZES = "240x135,480x270"
VIEWS = 5
THRESHOLDS = [0.00025, 0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1]
EDGES = [0.0, 0.25]
# A still scene's camera sways by these shares of the distance from its eye to its target, per axis.
SWAY = [0.1, 0.04, 0.1]
RESAMPLES = 10_000
COLUMNS = [
    *["scene", "frame", "width", "height", "accept", "edge_px", "threshold_u", "reflective_px"],
    *["screen_percent", "false_accepts", "mask_px", "mask_flip", "mask_flip_p99", "mask_ssim"],
    *["march_steps", "visited_nodes"],
]


@dataclasses.dataclass(frozen=True)
class Score:
    """Scores of one rule on one scene: means over its pictures, and sums of work."""

    wrong_permille: float  # per mille of accepted hits that a traced ray contradicts
    flip: float  # inside the reflections, against rt
    flip_p99: float
    ssim: float
    nodes: float  # BVH nodes that rays visit
    steps: float  # march steps, each a read of the depth buffer


Rule = tuple[str, float]  # ("verified", edge_px) or ("threshold", T)
Scores = dict[str, dict[Rule, Score]]
VERIFIED: Rule = ("verified", 0.25)
STRICTEST: Rule = ("verified", 0.0)


def measure(run: Run) -> None:
    for scene in (path for pattern in SCENES for path in sorted(ROOT.glob(pattern))):
        if scene.stem not in SAMPLED and run.wants(scene.stem):
            measure_scene(run, scene)


def measure_scene(run: Run, scene: pathlib.Path) -> None:
    command = [run.program, "info", scene, "--json", *run.models()]
    info = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE)
    timeline = json.loads(info.stdout)["timeline"]
    sets, frames = sway(tomllib.loads(scene.read_text())), f"0-{VIEWS - 1}"
    if timeline:
        step = (timeline["end"] - timeline["start"]) / (VIEWS - 1)
        frames = ",".join(str(timeline["start"] + round(step * i)) for i in range(VIEWS))
        sets = []
    options = [scene.relative_to(ROOT), *run.models(), *sets, "--timeline", frames]
    options += ["--methods", "hybrid", "--sizes", SIZES, "--frames", "1", "--warm-up", "1"]
    for parameter, turned in (("threshold_u", THRESHOLDS), ("edge_px", EDGES)):
        values = ["--parameter", parameter, "--values", ",".join(map(str, turned))]
        run.bench(scene.stem, *options, *values, "--counters", "--resume")


def sway(scene: dict[str, dict[str, dict[str, list[float]]]]) -> list[str]:
    """Command-line options that make a still scene's camera sway."""
    name = "main" if "main" in scene["camera"] else next(iter(scene["camera"]))
    camera = scene["camera"][name]
    reach = math.dist(camera["eye"], camera["target"])
    amplitude = [round(share * reach, 4) for share in SWAY]
    motion = f"{{ oscillate = {{ amplitude = {amplitude}, period_s = 7 }} }}"
    eye = f"motion.camera.{name}.eye={motion}"
    return settings(f"timeline.end={VIEWS - 1}", "timeline.fps=1", eye)


def rule_of(row: Row) -> Rule:
    value = row["edge_px"] if row["accept"] == "verified" else row["threshold_u"]
    return row["accept"], float(value)


def scores(rows: Rows) -> Scores:
    """Scores by scene and rule, over pictures whose reflections are large enough to be scored."""
    groups: dict[str, dict[Rule, Rows]] = {}
    for row in rows:
        if row["mask_flip"]:
            groups.setdefault(row["scene"], {}).setdefault(rule_of(row), []).append(row)
    return {s: {rule: score(rs) for rule, rs in rules.items()} for s, rules in groups.items()}


def score(rows: Rows) -> Score:
    hits = sum(map(accepted_px, rows))
    wrong = sum(values(rows, "false_accepts"))
    return Score(
        wrong_permille=1000 * wrong / hits if hits else 0.0,
        flip=mean(rows, "mask_flip"),
        flip_p99=mean(rows, "mask_flip_p99"),
        ssim=mean(rows, "mask_ssim"),
        nodes=sum(values(rows, "visited_nodes")),
        steps=sum(values(rows, "march_steps")),
    )


def work_ratio(of: Scores, scene: str, rule: Rule) -> float:
    """BVH nodes visited with the rule, divided by those visited with the verified rule."""
    return of[scene][rule].nodes / max(of[scene][VERIFIED].nodes, 1.0)


def best_threshold(of: Scores, scenes: Sequence[str], error: Callable[[Score], float]) -> Rule:
    """The T of least error among rules that cost no more than the verified rule; if all cost more,
    the cheapest."""
    rules = sorted({r for s in scenes for r in of[s] if r[0] == "threshold"})

    def cost(rule: Rule) -> float:
        return statistics.fmean(math.log(work_ratio(of, s, rule) or 1e-9) for s in scenes)

    affordable = [rule for rule in rules if cost(rule) <= 0.0]
    if not affordable:
        return min(rules, key=cost)
    return min(affordable, key=lambda rule: statistics.fmean(error(of[s][rule]) for s in scenes))


def left_out(of: Scores, error: Callable[[Score], float]) -> dict[str, Rule]:
    """T for each scene, chosen as the best one on all other scenes."""
    return {s: best_threshold(of, [o for o in of if o != s], error) for s in of}


def interval(differences: Sequence[float], seed: int = 1) -> tuple[float, float]:
    """95 % interval of the mean over scenes drawn with replacement (percentile bootstrap)."""
    draw = random.Random(seed)
    means = sorted(
        statistics.fmean(draw.choices(differences, k=len(differences))) for _ in range(RESAMPLES)
    )
    return means[round(0.025 * (RESAMPLES - 1))], means[round(0.975 * (RESAMPLES - 1))]


ERRORS: list[tuple[str, str, Callable[[Score], float]]] = [
    ("hits on a wrong surface, ‰", ".2f", lambda s: s.wrong_permille),
    ("FLIP in the reflections", ".4f", lambda s: s.flip),
    ("99th percentile of FLIP", ".4f", lambda s: s.flip_p99),
    ("1 − SSIM", ".4f", lambda s: 1.0 - s.ssim),
]


def summary(of: Scores) -> str:
    rows = []
    for name, form, error in ERRORS:
        chosen = left_out(of, error)
        pairs = [(error(of[s][VERIFIED]), error(of[s][chosen[s]])) for s in of]
        ours, theirs = (statistics.fmean(side) for side in zip(*pairs, strict=True))
        low, high = interval([a - b for a, b in pairs])
        better = sum(a < b for a, b in pairs)
        thresholds = sorted({rule[1] for rule in chosen.values()})
        work = statistics.geometric_mean(work_ratio(of, s, chosen[s]) or 1e-9 for s in of)
        rows.append([
            name, ", ".join(f"{t:g}" for t in thresholds), format(ours, form),
            format(theirs, form), f"{ours - theirs:+{form}} ({low:+{form}} to {high:+{form}})",
            f"{better} of {len(of)}", f"{work:.3f}",
        ])  # fmt: skip
    head = ["error", "T, U", "verified", "threshold", "difference (95 % interval)"]
    return table([*head, "scenes better", "nodes, threshold ÷ verified"], rows)


def by_scene(of: Scores) -> str:
    chosen = left_out(of, lambda s: s.flip)

    def line(scene: str) -> list[str]:
        ours, theirs = of[scene][VERIFIED], of[scene][chosen[scene]]
        steps = ours.steps / max(theirs.steps, 1.0)
        return [
            f"`{scene}`", f"{chosen[scene][1]:g}",
            f"{ours.wrong_permille:.1f}", f"{theirs.wrong_permille:.1f}",
            f"{ours.flip:.4f}", f"{theirs.flip:.4f}", f"{ours.flip_p99:.3f}",
            f"{theirs.flip_p99:.3f}", f"{1 / max(work_ratio(of, scene, chosen[scene]), 1e-9):.2f}",
            f"{steps:.2f}",
        ]  # fmt: skip

    head = ["scene", "T", "wrong ‰, verified", "threshold", "FLIP, verified", "threshold"]
    head += ["p99, verified", "threshold", "nodes, verified ÷ threshold", "steps"]
    return table(head, map(line, sorted(of)))


def sweep(of: Scores) -> str:
    rules = [STRICTEST, VERIFIED, *(("threshold", t) for t in THRESHOLDS)]

    def line(rule: Rule) -> list[str]:
        errors = [
            format(statistics.fmean(error(of[s][rule]) for s in of), form)
            for _, form, error in ERRORS
        ]
        work = statistics.geometric_mean(work_ratio(of, s, rule) or 1e-9 for s in of)
        name = f"verified, {rule[1]:g} px" if rule[0] == "verified" else f"T = {rule[1]:g} U"
        return [name, *errors, f"{work:.3f}"]

    return table(["rule", *(name for name, _, _ in ERRORS), "nodes"], map(line, rules))


def tables() -> dict[str, str]:
    of = scores(read_rows(DATA / "acceptance.csv"))
    return {"summary": summary(of), "scenes": by_scene(of), "sweep": sweep(of)}


def store(outs: list[pathlib.Path]) -> None:
    paths = (path for out in outs for path in sorted(out.glob("*/samples.csv")))
    rows = [row | {"scene": row["scene"].split(" with ")[0]} for p in paths for row in read_rows(p)]
    if not scores(rows):
        sys.exit(f"{outs[0]} holds no samples; run with --measure first")
    write_rows(DATA / "acceptance.csv", some_columns(rows, COLUMNS))


DOCUMENT = Document("acceptance.md", in_places(tables), store, measure)
