"""Links between the pages of the documentation lead somewhere, and the index lists every page."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/*.md"), *ROOT.glob("docs/scene/*.md")])

#: Target of a link or picture in Markdown, without the parts in code.
LINK = re.compile(r"\]\(([^)\s]+)\)")
CODE = re.compile(r"^```.*?^```|`[^`\n]*`", re.MULTILINE | re.DOTALL)


def anchors(page: Path) -> set[str]:
    """Anchors of a page's headings as GitHub makes them."""
    text = re.sub(
        r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL
    )
    made: dict[str, int] = {}
    found = set()
    for heading in re.findall(r"^#+ (.*)$", text, re.MULTILINE):
        anchor = re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
        times = made.get(anchor, 0)
        made[anchor] = times + 1
        found.add(f"{anchor}-{times}" if times else anchor)
    return found


def links(page: Path) -> list[str]:
    """Targets of a page's links that stay in the repository."""
    targets = LINK.findall(CODE.sub("`code`", page.read_text(encoding="utf-8")))
    return [target for target in targets if "://" not in target]


def broken(page: Path) -> list[str]:
    """Links of a page whose file or anchor does not exist."""
    wrong = []
    for target in links(page):
        name, _, anchor = target.partition("#")
        file = (page.parent / name).resolve() if name else page
        if not file.exists() or (anchor and anchor not in anchors(file)):
            wrong.append(target)
    return wrong


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_to_files_and_headings(page: Path) -> None:
    assert broken(page) == []


def test_a_broken_link_is_found(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(
        "# One\n[a](page.md#one) [b](none.md) ![c](#two) `[d](code.md)`\n", encoding="utf-8"
    )
    assert broken(page) == ["none.md", "#two"]


def test_the_index_lists_every_page() -> None:
    index = ROOT / "docs" / "README.md"
    reachable = {index.resolve()}
    for page in (index, ROOT / "docs" / "methods.md"):
        names = (target.partition("#")[0] for target in links(page))
        reachable |= {(page.parent / name).resolve() for name in names if name}
    assert set(ROOT.glob("docs/*.md")) - reachable == set()


def test_the_readme_stays_short() -> None:
    assert len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()) <= 180
