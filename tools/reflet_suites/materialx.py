"""MaterialX documents of others: which the converter of USD carries, and their losses.

The suite's folder holds a clone of MaterialX, of OpenPBR, or both. A stage that binds each
material of a document to a square of its own is converted like any other.
"""

import json
import re
from collections.abc import Mapping
from pathlib import Path

from reflet_usd.convert.types import ConvertError, ConvertOptions
from reflet_usd.materialx_document import DocumentError, read_document
from reflet_usd.sandbox import run_convert
from tables import Row, write_rows

FOLDERS = ("MaterialX/resources/Materials/Examples", "OpenPBR/examples")
MODEL = "material-approximated"
"""The loss of a document that is carried but for its surface's formulas."""
DETAIL = r"; without (.+)$|node (ND_\w+)|shader '(ND_\w+)'|^@(.+?)@"
SQUARE = """def Mesh "{name}" (prepend apiSchemas = ["MaterialBindingAPI"]) {{
  int[] faceVertexCounts = [4]
  int[] faceVertexIndices = [0, 1, 2, 3]
  point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
  texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1)] (interpolation = "vertex")
  uniform token subdivisionScheme = "none"
  rel material:binding = </Materials/{name}>
}}
"""


def stage(document: Path, materials: list[str]) -> str:
    """Text of a stage with a square of each material of a document."""
    reference = f"@{document.resolve()}@</MaterialX/Materials>"
    head = '#usda 1.0\n(\n  metersPerUnit = 1\n  upAxis = "Y"\n)\n'
    looks = f'def Scope "Materials" (references = {reference}) {{}}\n'
    return head + looks + "".join(SQUARE.format(name=name) for name in materials)


def loss(warning: Mapping[str, str]) -> str:
    """A warning's name, with the inputs, the node or the file that it names."""
    found = re.search(DETAIL, warning["message"])
    return f"{warning['name']} ({found[found.lastindex or 0]})" if found else warning["name"]


def convert(document: Path, root: Path, out: Path) -> Row:
    """Number of a document's materials, the error that refuses it, and its losses."""
    row = {"materials": "", "refused": "", "losses": ""}
    text = out / f"{document.stem}.usda"
    account = text.with_suffix(".glb.json")
    try:
        layer = read_document(str(document.resolve()), (str(root.resolve()),)).layer
        found = layer.GetPrimAtPath("/MaterialX/Materials")
        materials = [prim.name for prim in found.nameChildren] if found else []
        row["materials"] = str(len(materials))
        text.write_text(stage(document, materials), encoding="utf-8")
        if not account.exists():
            run_convert(text, text.with_suffix(".glb"), ConvertOptions(extra_roots=(root,)))
    except (ConvertError, DocumentError) as error:
        return row | {"refused": error.name}
    warnings = json.loads(account.read_text(encoding="utf-8"))["warnings"]
    return row | {"losses": "; ".join(sorted({loss(warning) for warning in warnings}))}


def measure(_program: Path, suite: Path, out: Path) -> None:
    """Writes materialx.csv: a row for each document."""
    rows: list[Row] = []
    for folder in FOLDERS:
        for document in sorted((suite / folder).rglob("*.mtlx")):
            name = document.relative_to(suite / folder)
            place = out / folder / name.parent
            place.mkdir(parents=True, exist_ok=True)
            repository = folder.split("/")[0]
            row = convert(document, suite / repository, place)
            rows.append({"repository": repository, "document": name.as_posix(), **row})
            print(" ".join(rows[-1].values()), flush=True)
    write_rows(out / "materialx.csv", rows)
