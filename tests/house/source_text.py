"""Rules about the text of the sources: length, words that must not stand in it, files that no build
lists."""

import re

from trees import sources

MAX_LINES = 400
CODE = ["core", "peers", "server", "client"]

# What must not stand in code, tests or build files, and why. The patterns are written so that they
# do not match themselves.
FORBIDDEN = [
    (re.compile(r"-ffast[-]math"), "the classical result must be reproducible bit for bit"),
    (re.compile(r"-march=nativ[e]"), "what is built here runs on other machines"),
    (
        re.compile(r"\b[kt]?_?(t|ray|hit|shadow|self)_?(eps(ilon)?|bias)_?\b", re.IGNORECASE),
        "rays are never offset: self-intersection is excluded combinatorially",
    ),
    (re.compile(r"\b(TO[D]O|FIXM[E]|XX[X])\b"), "unfinished work belongs in an issue"),
    (re.compile(r"\b(GTEST_SKI[P]|DISABLE[D]_)"), "a test that does not run proves nothing"),
    (re.compile(r"\b(sleep_fo[r]|sleep_unti[l]|uslee[p])\b"), "wait for what happens, not for time"),
    (re.compile(r"/[t]mp/|/[w]ork/|/[h]ome/"), "a path of one machine"),
]


def too_long(root):
    """Files of code with more than MAX_LINES lines."""
    found = []
    for path in sources(root, CODE, {".h", ".cpp"}):
        lines = (root / path).read_text().count("\n")
        if lines > MAX_LINES:
            found.append(f"{path}: {lines} lines, at most {MAX_LINES} (one job a file)")
    return found


def forbidden(root):
    """Lines that hold what FORBIDDEN lists."""
    paths = sources(root, CODE + ["tests", "proto"], {".h", ".cpp", ".py", ".txt", ".proto"})
    paths += [p.relative_to(root) for p in root.glob("*") if p.suffix in {".txt", ".sh", ".md"}]
    found = []
    for path in paths:
        for number, line in enumerate((root / path).read_text().splitlines(), 1):
            for pattern, reason in FORBIDDEN:
                if pattern.search(line):
                    found.append(f"{path}:{number}: '{pattern.search(line).group()}': {reason}")
    return found


def not_built(root):
    """Sources that no CMakeLists.txt of their folder, or of one above it, names."""
    found = []
    for path in sources(root, CODE + ["tests"], {".cpp"}):
        if not any(_names(root / folder / "CMakeLists.txt", path.relative_to(folder))
                   for folder in path.parents):
            found.append(f"{path}: no CMakeLists.txt lists it")
    return found


def _names(lists_file, relative):
    """Whether the file exists and holds the path as a word, outside of comments."""
    if not lists_file.exists():
        return False
    text = re.sub(r"#.*", "", lists_file.read_text())
    return re.search(rf"(?<![\w./-]){re.escape(relative.as_posix())}(?![\w./-])", text) is not None
