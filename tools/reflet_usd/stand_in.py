"""Files in whose place there are others: pointers of Git LFS, and web pages."""


def stand_in(start: bytes) -> str:
    """Message about a file in whose place its first bytes show another one; empty for others."""
    if start.startswith(b"version https://git-lfs.github.com/spec/"):
        return "a pointer of Git LFS in place of the file: run `git lfs pull` in its repository"
    if start.lstrip(b"\xef\xbb\xbf \r\n\t").lower().startswith((b"<!doctype html", b"<html")):
        return "a web page in place of the file: download it anew"
    return ""
