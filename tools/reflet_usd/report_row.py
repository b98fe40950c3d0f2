"""Owns one row of the corpus report: a root stage with its conversion and check."""

import dataclasses
from typing import Any

from reflet_usd.corpus_scores import Root


@dataclasses.dataclass
class Row:
    """Result of converting and checking one root stage."""

    root: Root
    converted: bool
    reason: str = ""
    """Name of the error of conversion or check; empty where both ran."""
    message: str = ""
    validation: dict[str, Any] = dataclasses.field(default_factory=dict)
    """The JSON of `reflet-usd validate`."""
    warnings: list[dict[str, Any]] = dataclasses.field(default_factory=list)
    convert_s: float = 0.0

    @property
    def validator_errors(self) -> int | None:
        """Errors of the Khronos validator; None where it did not run."""
        khronos = self.validation.get("khronos")
        return khronos["errors"] if khronos else None

    @property
    def passed(self) -> bool:
        """Whether the stage was converted and passes every check, or is rightly refused."""
        if self.converted:
            return bool(self.validation.get("passed"))
        return self.root.opens is False and self.reason != "converter-internal"

    def to_json(self) -> dict[str, Any]:
        """Plain data; times are the only values that differ between runs."""
        return {
            "file": self.root.file,
            "opens": self.root.opens,
            "converted": self.converted,
            "passed": self.passed,
            "reason": self.reason,
            "message": self.message,
            "convert_s": round(self.convert_s, 3),
            "warnings": self.warnings,
            "proof": self.validation,
        }
