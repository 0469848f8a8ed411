"""The rules about the text of the sources hold, and would notice when they do not."""

import unittest

import source_text
from trees import PROJECT, MadeTree


class SourceText(unittest.TestCase):
    def test_files_are_short(self):
        self.assertEqual(source_text.too_long(PROJECT), [])

    def test_a_long_file_is_caught(self):
        with MadeTree({"core/math/a.cpp": "\n" * 401, "core/math/b.cpp": "\n" * 400}) as root:
            self.assertEqual(len(source_text.too_long(root)), 1)

    def test_nothing_forbidden_is_written(self):
        self.assertEqual(source_text.forbidden(PROJECT), [])

    def test_what_is_forbidden_is_caught(self):
        # Put together here, so that this file does not itself hold what it looks for.
        lines = [
            "add_compile_options(-ffast" + "-math)",
            "add_compile_options(-march" + "=native)",
            "const double t_e" + "psilon = 1e-4;",
            "const double kRayE" + "psilon = 1e-4;",
            "const double shadow_b" + "ias = 1e-4;",
            "// TO" + "DO: later",
            "GTEST" + "_SKIP();",
            "TEST(A, DISAB" + "LED_B) {}",
            "std::this_thread::sleep" + "_for(x);",
            'open("/t' + 'mp/x");',
        ]
        for line in lines:
            with self.subTest(line), MadeTree({"core/math/a.cpp": line + "\n"}) as root:
                self.assertEqual(len(source_text.forbidden(root)), 1)

    def test_the_word_epsilon_is_not_forbidden_as_such(self):
        lines = "double epsilon = 0.1;\nVerdict::kEpsilon;\nfloat max_epsilon_seen;\n"
        with MadeTree({"core/math/a.cpp": lines}) as root:
            self.assertEqual(source_text.forbidden(root), [])

    def test_every_source_is_built(self):
        self.assertEqual(source_text.not_built(PROJECT), [])

    def test_a_source_that_is_not_built_is_caught(self):
        files = {
            "core/math/CMakeLists.txt": "lt_library(lt_math SOURCES a.cpp sub/c.cpp # b.cpp\n)\n",
            "core/math/a.cpp": "",
            "core/math/b.cpp": "",
            "core/math/sub/c.cpp": "",
            "core/math/sub/a.cpp": "",
        }
        with MadeTree(files) as root:
            found = source_text.not_built(root)
        self.assertEqual([line.split(":")[0] for line in found],
                         ["core/math/b.cpp", "core/math/sub/a.cpp"])


if __name__ == "__main__":
    unittest.main()
