"""Files in whose place there are others: pointers of Git LFS, web pages, errors of servers."""


def stand_in(start: bytes) -> str:
    """Message about a file in whose place its first bytes show another one; empty for others."""
    if start.startswith(b"version https://git-lfs.github.com/spec/"):
        return "a pointer of Git LFS in place of the file: run `git lfs pull` in its repository"
    text = start.lstrip(b"\xef\xbb\xbf \r\n\t").lower()
    if text.startswith((b"<!doctype html", b"<html")):
        return "a web page in place of the file: download it anew"
    if text.startswith(b"<?xml") and b"<error>" in text:
        return "an error of a server in place of the file: download it anew"
    return ""
