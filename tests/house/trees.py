"""Source trees for the tests of the rules: this project's, and small ones made to break a rule."""

import pathlib
import tempfile

PROJECT = pathlib.Path(__file__).resolve().parents[2]


class MadeTree:
    """A temporary folder that holds the given {path: text}; use it in a with statement."""

    def __init__(self, files):
        self._files = files

    def __enter__(self):
        self._folder = tempfile.TemporaryDirectory()
        root = pathlib.Path(self._folder.name)
        for path, text in self._files.items():
            (root / path).parent.mkdir(parents=True, exist_ok=True)
            (root / path).write_text(text)
        return root

    def __exit__(self, *unused):
        self._folder.cleanup()


def sources(root, folders, suffixes):
    """The files below root/folder with one of the suffixes, as paths relative to root, sorted."""
    return sorted(
        path.relative_to(root)
        for folder in folders
        for path in (root / folder).rglob("*")
        if path.suffix in suffixes and path.is_file()
    )
