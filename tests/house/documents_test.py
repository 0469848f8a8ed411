"""Scene files have headers and the README's commands exist; if not, it would be noticed."""

import os
import pathlib
import unittest

import documents
from trees import PROJECT, MadeTree

PROGRAM = """#!/bin/sh
case "$1" in
  fly) echo "--scene --epsilon -o" ;;
  --help) echo "--listen" ;;
  *) exit 1 ;;
esac
"""


class Scenes(unittest.TestCase):
    def test_all_say_what_they_show(self):
        self.assertEqual(documents.scenes_without_header(PROJECT), [])
        self.assertGreater(len(list((PROJECT / "scenes").rglob("*.textproto"))), 10)

    def test_a_scene_without_header_is_caught(self):
        files = {
            "scenes/a.textproto": 'name: "a"\n',
            "scenes/paths/b.textproto": "# A path.\nframes: 3\n",
            "scenes/c.textproto": "# " + "word " * documents.MIN_HEADER_WORDS + "\nname: 'c'\n",
        }
        with MadeTree(files) as root:
            self.assertEqual(len(documents.scenes_without_header(root)), 2)


class Readme(unittest.TestCase):
    def test_its_commands_exist(self):
        programs = pathlib.Path(os.environ["LINETREE_PROGRAMS"])
        self.assertGreater(len(documents.readme_commands((PROJECT / "README.md").read_text())), 4)
        self.assertEqual(documents.commands_that_fail(PROJECT, programs), [])

    def test_commands_that_do_not_exist_are_caught(self):
        for command, complaints in [
            ("./run.sh", 0),
            ("./gone.sh", 1),
            ("bin/linetree fly --scene scenes/a.nff -o x.png", 0),
            ("bin/linetree fly name --epsilon=0.1", 0),
            ("bin/linetree walk --scene scenes/a.nff", 1),
            ("bin/linetree fly --speed 3", 1),
            ("bin/linetree fly --scene A=scenes/b.nff", 1),
            ("bin/linetreed --listen 127.0.0.1:0", 0),
            ("bin/linetreed --shout", 1),
            ("git clone somewhere --deep", 0),
        ]:
            with self.subTest(command), MadeTree(self._files(command)) as root:
                for name in ["run.sh", "bin/linetree", "bin/linetreed"]:
                    (root / name).chmod(0o755)
                found = documents.commands_that_fail(root, root / "bin")
                self.assertEqual(len(found), complaints, found)

    def test_continued_lines_and_prompts_are_read(self):
        text = "```console\n$ a \\\n  --b   # why\n```\n```proto\nnot { a: command }\n```\n"
        self.assertEqual(documents.readme_commands(text), [["a", "--b"]])

    def test_its_links_lead_somewhere(self):
        self.assertEqual(documents.links_that_lead_nowhere(PROJECT), [])

    def test_links_that_lead_nowhere_are_caught(self):
        text = "[a](core/a.h) [b](core/b.h) [c](https://example.org/c) ![d](d.png)\n"
        with MadeTree({"README.md": text, "core/a.h": ""}) as root:
            self.assertEqual(documents.links_that_lead_nowhere(root), ["core/b.h", "d.png"])

    @staticmethod
    def _files(command):
        return {
            "README.md": f"```sh\n{command}\n```\n",
            "run.sh": "#!/bin/sh\n",
            "bin/linetree": PROGRAM,
            "bin/linetreed": PROGRAM,
            "scenes/a.nff": "",
        }


class Root(unittest.TestCase):
    def test_it_is_bare(self):
        self.assertEqual(documents.strangers_in_the_root(PROJECT), [])

    def test_strangers_are_caught(self):
        files = {".gitignore": "/build/\n", "build/x": "", "README.md": "", "notes.txt": "",
                 "src/a.cpp": "", ".clang-tidy": ""}
        with MadeTree(files) as root:
            self.assertEqual(documents.strangers_in_the_root(root), ["notes.txt", "src"])


if __name__ == "__main__":
    unittest.main()
