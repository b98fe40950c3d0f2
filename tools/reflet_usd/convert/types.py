"""Input and output of a conversion: options, warnings, result, error."""

from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

DEFAULT_PURPOSES = ("default", "render")
MOST_STEPS = 6
"""Highest `subdiv_level`."""


@dataclass(frozen=True)
class ConvertOptions:
    """Options of a conversion. The defaults keep what a final render would show."""

    frames: tuple[float, float] | None = None
    """First and last time code of the animation to keep; None keeps all keys."""
    purpose: tuple[str, ...] = DEFAULT_PURPOSES
    """The UsdGeom purposes that are kept."""
    variants: tuple[tuple[str, str, str], ...] = ()
    """Variant selections as (prim path, set name, variant name)."""
    strict: bool = False
    """Whether any warning becomes a `ConvertError` named `strict`."""
    extra_roots: tuple[Path, ...] = ()
    """Folders besides the stage's own from which layers and textures may be read."""
    subdiv_level: int = 0
    """Number of Catmull-Clark steps that refine subdivision meshes; 0 keeps the cage."""

    def __post_init__(self) -> None:
        # Options that traveled through JSON come back as lists and plain strings.
        plain = {
            "frames": None if self.frames is None else tuple(self.frames),
            "purpose": tuple(self.purpose),
            "variants": tuple(tuple(choice) for choice in self.variants),
            "extra_roots": tuple(Path(root) for root in self.extra_roots),
        }
        for name, value in plain.items():
            object.__setattr__(self, name, value)


@dataclass(frozen=True, order=True)
class Warning:
    """A value of the stage that the file does not carry as authored."""

    name: str
    prim: str
    message: str
    deviation: float | None = field(default=None, compare=False)
    """Maximum deviation of the file from the stage, as a share; None where it is not known."""

    def to_json(self) -> dict[str, Any]:
        """Plain data, without fields that are None."""
        return {key: value for key, value in asdict(self).items() if value is not None}


@dataclass
class ConvertResult:
    """Result of a conversion; the same data is in the JSON sidecar."""

    warnings: list[Warning] = field(default_factory=list)
    ledger: dict[str, dict[str, int]] = field(default_factory=dict)
    """Number of prims `carried` and `warned` about, by prim type."""
    info: dict[str, Any] = field(default_factory=dict)
    """Facts needed to compare the file with the stage (units, axis, time origin, counts)."""
    files: list[str] = field(default_factory=list)
    """Absolute paths of every layer, package and texture that was read, sorted."""
    absent: list[str] = field(default_factory=list)
    """Absolute paths of files that the stage names and that do not exist, sorted."""

    def __post_init__(self) -> None:
        self.warnings = [
            Warning(**entry) if isinstance(entry, dict) else entry for entry in self.warnings
        ]

    def to_json(self) -> dict[str, Any]:
        """The sidecar's content, plain data."""
        return {
            "warnings": [warning.to_json() for warning in self.warnings],
            "ledger": self.ledger,
            "info": self.info,
            "files": self.files,
            "absent": self.absent,
        }


def warning_count(count: int) -> str:
    """A count with its noun: `1 warning`, `2 warnings`."""
    return f"{count} warning{'' if count == 1 else 's'}"


class ConvertError(Exception):
    """A conversion that cannot be done, with the name of the reason."""

    def __init__(self, name: str, message: str, path: str = "") -> None:
        where = f"{path}: " if path else ""
        super().__init__(f"{where}{message} [{name}]")
        self.name = name
        self.message = message
        self.path = path
