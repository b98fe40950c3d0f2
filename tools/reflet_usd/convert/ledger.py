"""The ledger of a conversion: named warnings by prim path, and the prims that were carried."""

from collections import defaultdict
from collections.abc import Iterable

from .types import Warning


class Ledger:
    """Collects warnings once each and remembers every prim that found its place in the file."""

    def __init__(self) -> None:
        self._warnings: dict[Warning, None] = {}
        self._carried: set[str] = set()
        self._skipped: list[str] = []
        self._instancers: list[str] = []
        self._by_prim: dict[str, list[Warning]] = defaultdict(list)

    def warn(self, name: str, prim: object, message: str, deviation: float | None = None) -> None:
        """Record that `prim` (a prim or a path) is not carried as authored."""
        entry = Warning(name, _path_text(prim), message, deviation)
        if entry not in self._warnings:
            self._warnings[entry] = None
            self._by_prim[entry.prim].append(entry)

    def warn_frozen(self, name: str, prim: object, attributes: Iterable[str]) -> None:
        """Record that animated attributes of `prim`, if there are any, do not move."""
        if listed := ", ".join(sorted(attributes)):
            self.warn(name, prim, f"animated {listed} stay at their first value")

    def repeat(self, first: object, other: object) -> None:
        """Repeat the warnings of `first` for `other`: both share what was converted once."""
        for entry in list(self._by_prim[_path_text(first)]):
            self.warn(entry.name, other, entry.message, entry.deviation)

    def skip_subtree(self, name: str, prim: object, message: str) -> None:
        """Warn once for `prim`, and account for every prim below it."""
        self.warn(name, prim, message)
        self._skipped.append(_path_text(prim).rstrip("/") + "/")

    def carry(self, prim: object) -> None:
        """Record that `prim` has its counterpart in the file."""
        self._carried.add(_path_text(prim))

    def note_instancer(self, prim: object) -> None:
        """Remember an instancer: of the prims below it only prototypes are drawn."""
        self._instancers.append(_path_text(prim) + "/")

    def warnings(self) -> list[Warning]:
        """All warnings, in the order of prim path, then name."""
        return sorted(self._warnings, key=lambda entry: (entry.prim, entry.name, entry.message))

    def close(self, prims: list[tuple[str, str]]) -> dict[str, dict[str, int]]:
        """Counts per type over `prims` (path, type name); warns about each prim that was missed."""
        warned = {entry.prim for entry in self._warnings}
        skipped = tuple(self._skipped)
        warned |= {path for path, _ in prims if skipped and path.startswith(skipped)}
        for path, type_name in prims:
            if path not in warned and path not in self._carried:
                self._warn_missed(path, type_name or "typeless prim")
                warned.add(path)
        counts: dict[str, dict[str, int]] = defaultdict(lambda: {"carried": 0, "warned": 0})
        for path, type_name in prims:
            counts[type_name or "untyped"]["warned" if path in warned else "carried"] += 1
        return {name: counts[name] for name in sorted(counts)}

    def _warn_missed(self, path: str, kind: str) -> None:
        if kind == "Material":
            self.warn("material-unused", path, "no drawn prim is bound to the material")
        elif kind in ("Shader", "NodeGraph"):
            self.warn("shader-unused", path, "no carried material reads the node")
        elif kind == "SkelAnimation":
            self.warn("animation-unused", path, "no carried skeleton or shape uses it")
        elif path.startswith(tuple(self._instancers)):
            message = "it is below an instancer and no prototype, so nothing draws it"
            self.warn("prototype-unused", path, message)
        else:
            self.warn("schema-ignored", path, f"glTF has no place for a {kind}")


def _path_text(prim: object) -> str:
    get_path = getattr(prim, "GetPath", None)
    return str(get_path() if get_path is not None else prim)
