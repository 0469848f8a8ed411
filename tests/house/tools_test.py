"""Formatting is obeyed; the linter's settings switch on what they list."""

import unittest

import tools
from trees import PROJECT, MadeTree


class Formatter(unittest.TestCase):
    def test_the_project_is_formatted(self):
        self.assertEqual(tools.misformatted(PROJECT), [])

    def test_bad_formatting_is_caught(self):
        style = (PROJECT / ".clang-format").read_text()
        files = {".clang-format": style, "core/a.cpp": "int  a ;\n", "core/b.cpp": "int b;\n"}
        with MadeTree(files) as root:
            self.assertEqual(tools.misformatted(root), [str(root / "core/a.cpp")])


class Linter(unittest.TestCase):
    def test_enough_checks_are_enabled(self):
        self.assertGreaterEqual(len(tools.enabled_checks(PROJECT / ".clang-tidy")),
                                tools.MIN_CHECKS)

    def test_every_entry_matches_a_check(self):
        self.assertEqual(tools.entries_without_effect(PROJECT / ".clang-tidy"), [])

    def test_a_missing_comma_is_caught_wherever_it_is_missing(self):
        lines = (PROJECT / ".clang-tidy").read_text().splitlines(keepends=True)
        commas = [i for i, line in enumerate(lines) if line.endswith(",\n")]
        self.assertGreater(len(commas), 30)
        for i in commas:
            broken = lines[:i] + [lines[i].replace(",\n", "\n")] + lines[i + 1:]
            with self.subTest(lines[i]), MadeTree({".clang-tidy": "".join(broken)}) as root:
                self.assertNotEqual(tools.entries_without_effect(root / ".clang-tidy"), [])


if __name__ == "__main__":
    unittest.main()
