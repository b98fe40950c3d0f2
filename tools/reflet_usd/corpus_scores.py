"""Owns the measures of the corpus report: the results of all converters are scored alike.

A corpus folder may hold INDEX.tsv (kind and content of each root stage) and PEERS.tsv (results of
other converters). Rivals' rows and ours are scored here by the same functions.
"""

import csv
import dataclasses
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np

_BOX = "box in metres, Y up, earliest time"
_PEER_BOX = "world box (ok, units, axis, bad, none, -)"
KEYED_SKELETONS = "SkelAnimation keys"
"""Feature of stages in which a SkelAnimation has two time samples or more of any attribute.

INDEX.tsv counts prims only, so `validate` asks usd-core; the same stages count for everyone.
"""
_RIGS = "joints or weights animated, of those with keys"
"""Title of the measure; PEERS.tsv has no such count, so animated nodes are the rivals' bound."""
_CURVED = (
    "Sphere",
    "Cylinder",
    "Cone",
    "Capsule",
    "PointInstancer",
    "BasisCurves",
    "NurbsCurves",
    "Points",
)
_BOX_TOLERANCE, _CURVED_TOLERANCE = 0.001, 0.05
"""Tolerances as parts of the diagonal; the wider one with tessellated gprims or instancers."""


@dataclasses.dataclass
class Root:
    """One root stage of a corpus."""

    file: str
    opens: bool | None
    """Whether usd-core opens it; None where the corpus does not say."""
    box: list[float] | None
    """World box in meters, Y up, at the earliest time: lowest then highest corner."""
    features: dict[str, int]


@dataclasses.dataclass
class Score:
    """Measures of one converter's result for one root stage."""

    converted: bool
    validator_errors: int | None
    box: str
    """ok, bad, none (nothing drawn) or - (the corpus knows no box)."""
    materials: tuple[int, int]
    """Number of materials in the output, and the number expected; the next fields likewise."""
    images: int
    cameras: tuple[int, int]
    lights: tuple[int, int]
    animated: tuple[int, int]
    rigs: int | None = None
    """Animation channels of joints or weights; None if not counted."""


def read_roots(folder: Path) -> list[Root]:
    """The root stages of a corpus: those INDEX.tsv names, else every USD file below."""
    index = folder / "INDEX.tsv"
    if not index.is_file():
        suffixes = (".usd", ".usda", ".usdc", ".usdz")
        files = sorted(p for p in folder.rglob("*") if p.suffix.lower() in suffixes)
        return [Root(str(path.relative_to(folder)), None, None, {}) for path in files]
    roots = []
    for row in _rows(index):
        box = [float(value) for value in row[_BOX].split(";")] if row[_BOX] else None
        roots.append(Root(row["file"], row["opens"] == "1", box, _features(row)))
    return roots


def read_peers(folder: Path) -> dict[str, dict[str, Score]]:
    """Scores of other converters by name and file; empty without PEERS.tsv."""
    peers: dict[str, dict[str, Score]] = {}
    path = folder / "PEERS.tsv"
    for row in _rows(path) if path.is_file() else ():
        errors = row["validator errors"]
        peers.setdefault(row["peer"], {})[row["file"]] = Score(
            row["converted"] == "1",
            int(errors) if errors else None,
            row[_PEER_BOX],
            _pair(row["materials got/expected"]),
            int(row["images"] or 0),
            _pair(row["cameras got/expected"]),
            _pair(row["lights got/expected (no dome)"]),
            _pair(row["animated nodes/expected stages"]),
        )
    return peers


def score_output(
    root: Root, facts: dict[str, Any], errors: int | None, like: Score | None
) -> Score:
    """Score of our output from the re-read file's facts; a rival's row gives expected numbers."""

    def expected(name: str) -> int:
        return getattr(like, name)[1] if like is not None else 0

    known = like is None or like.box != "-"
    return Score(
        True,
        errors,
        _box_state(root, facts.get("box")) if known else "-",
        (facts.get("materials", 0), expected("materials")),
        facts.get("images", 0),
        (facts.get("cameras", 0), expected("cameras")),
        (facts.get("lights", 0), expected("lights")),
        (facts.get("animated_nodes", 0), expected("animated")),
        facts.get("animated_rigs", 0),
    )


def failed_score(root: Root, like: Score | None) -> Score:
    """Score of a stage that was not converted."""
    return dataclasses.replace(score_output(root, {}, None, like), converted=False)


def summary_rows(
    roots: Iterable[Root], columns: dict[str, dict[str, Score]]
) -> list[tuple[str, dict[str, str]]]:
    """Title of each measure, and "reached/of" by converter, over the stages it applies to."""
    roots = [root for root in roots if all(root.file in scores for scores in columns.values())]
    rows = []
    for title, applies, reached in _MEASURES:
        cells = {}
        for name, scores in columns.items():
            chosen = [root for root in roots if applies(root, scores[root.file])]
            count = sum(bool(reached(scores[root.file])) for root in chosen)
            bound = any(scores[root.file].rigs is None for root in chosen)
            cells[name] = f"{'at most ' * (bound and title == _RIGS)}{count}/{len(chosen)}"
        rows.append((title, cells))
    return rows


def _opens(root: Root, score: Score) -> bool:
    return root.opens is not False


def _has(name: str) -> Callable[[Root, Score], bool]:
    return lambda root, score: _opens(root, score) and root.features.get(name, 0) > 0


def _has_boxed(name: str) -> Callable[[Root, Score], bool]:
    return lambda root, score: _has(name)(root, score) and score.box != "-"


def _expects(name: str) -> Callable[[Root, Score], bool]:
    return lambda root, score: _opens(root, score) and getattr(score, name)[1] > 0


def _keeps(name: str) -> Callable[[Score], bool]:
    return lambda score: score.converted and getattr(score, name)[0] >= getattr(score, name)[1]


def _all_right(score: Score) -> bool:
    counted = all(_keeps(name)(score) for name in ("materials", "cameras", "lights", "animated"))
    return score.box == "ok" and score.validator_errors == 0 and counted


def _moves_a_rig(score: Score) -> bool:
    """Whether a rig moves; where only animated nodes were counted, any of them counts."""
    return score.animated[0] > 0 if score.rigs is None else score.rigs > 0


_MEASURES: list[tuple[str, Callable[[Root, Score], bool], Callable[[Score], bool]]] = [
    ("converted, of those that open", _opens, lambda s: s.converted),
    ("Khronos validator: 0 errors", _opens, lambda s: s.validator_errors == 0),
    ("broken files refused", lambda r, s: r.opens is False, lambda s: not s.converted),
    (
        "world box right (meters, Y up; no skeletons)",
        lambda r, s: _opens(r, s) and s.box != "-",
        lambda s: s.box == "ok",
    ),
    (
        "box, validator, and all counts right",
        lambda r, s: _opens(r, s) and s.box != "-",
        _all_right,
    ),
    ("all materials kept", _expects("materials"), _keeps("materials")),
    ("some texture kept", _has("shader:UsdUVTexture"), lambda s: s.images > 0),
    ("transform animation present", _has("xformAnim"), lambda s: s.animated[0] > 0),
    (_RIGS, _has(KEYED_SKELETONS), _moves_a_rig),
    ("box right with native instances", _has_boxed("instance"), lambda s: s.box == "ok"),
    ("box right with point instancers", _has_boxed("PointInstancer"), lambda s: s.box == "ok"),
    ("cameras, all", _expects("cameras"), _keeps("cameras")),
    ("lights, all but dome", _expects("lights"), _keeps("lights")),
]


def _box_state(root: Root, box: list[float] | None) -> str:
    if root.box is None:
        return "-"
    if box is None:
        return "none"
    wanted, found = np.array(root.box), np.array(box)
    diagonal = float(np.linalg.norm(wanted[3:] - wanted[:3])) or 1.0
    curved = any(name in root.features for name in _CURVED)
    tolerance = _CURVED_TOLERANCE if curved else _BOX_TOLERANCE
    return "ok" if float(np.abs(wanted - found).max()) <= tolerance * diagonal else "bad"


def _features(row: dict[str, str]) -> dict[str, int]:
    result = {}
    for item in (row["features (count)"] or "").split():
        name, _, count = item.rpartition("=")
        result[name] = int(count) if count.isdigit() else 1
    return result


def _pair(text: str) -> tuple[int, int]:
    got, _, expected = text.partition("/")
    return int(got or 0), int(expected or 0)


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream, delimiter="\t"))
