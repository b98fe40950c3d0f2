"""tools/tell.py: the pages of docs say what the tables in docs/data say."""

import pathlib

import pytest
import tell
from documents import DOCUMENTS, document
from tables import digits, with_tables


@pytest.mark.parametrize("name", DOCUMENTS)
def test_a_page_is_told_from_the_stored_tables(name: str) -> None:
    page = document.DOCS / DOCUMENTS[name].page
    assert tell.told(DOCUMENTS[name]) == page.read_text(), f"tools/tell.py {name} writes it anew"


def test_a_table_is_written_into_its_one_place() -> None:
    place = "a\n<!-- table: one -->\n{}\n<!-- end -->\nb\n"
    assert with_tables(place.format("old\nrows"), {"one": "| new |"}) == place.format("| new |")
    for text in ("nowhere", 2 * place.format("twice")):
        with pytest.raises(SystemExit, match="places for the table 'one'"):
            with_tables(text, {"one": "| new |"})


def test_numbers_have_three_digits() -> None:
    shown = [digits(value) for value in (0, 0.00012, 0.01234, 1.234, 12.34, 123.4, 1234.5)]
    assert shown == ["0", "1.2e-4", "0.012", "1.23", "12.3", "123", "1234"]


def test_runs_that_were_not_measured_are_named(tmp_path: pathlib.Path) -> None:
    with pytest.raises(SystemExit, match=r"paper-s-walk/samples\.csv is missing"):
        document.samples(tmp_path, "paper's walk")
