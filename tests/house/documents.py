"""Scenes say what they show; what the README tells people to type and to open exists; the root holds
nothing that it does not name."""

import os
import re
import shlex
import subprocess

SCENE_SUFFIXES = {".textproto"}
PROGRAMS = {"linetree", "linetreed"}
# A header of fewer words than this says nothing.
MIN_HEADER_WORDS = 12
# What may stand in the root, apart from dotfiles and what .gitignore names.
ROOT = {"README.md", "CMakeLists.txt", "demo.sh", "test.sh",
        "client", "core", "peers", "proto", "scenes", "server", "tests"}
_LINK = re.compile(r"\]\(([^)#:]+)\)")
_FENCE = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)


def scenes_without_header(root):
    """Scene and path files that do not start with a comment of at least MIN_HEADER_WORDS words."""
    found = []
    for path in sorted((root / "scenes").rglob("*")):
        if path.suffix not in SCENE_SUFFIXES:
            continue
        words = 0
        for line in path.read_text().splitlines():
            if not line.startswith("#"):
                break
            words += len(line.lstrip("# ").split())
        if words < MIN_HEADER_WORDS:
            found.append(f"{path.relative_to(root)}: expected a header comment")
    return found


def readme_commands(text):
    """The commands in the shell blocks of a README, each as a list of words."""
    commands = []
    for language, block in _FENCE.findall(text):
        if language not in {"sh", "bash", "console"}:
            continue
        for line in block.replace("\\\n", " ").splitlines():
            words = shlex.split(line.removeprefix("$ "), comments=True)
            if words:
                commands.append(words)
    return commands


def commands_that_fail(root, programs):
    """What is wrong with the README's commands: scripts, programs, subcommands, options and scene
    files that do not exist. Programs are looked for in the folder `programs`."""
    found = []
    for words in readme_commands((root / "README.md").read_text()):
        name = os.path.basename(words[0])
        if name in PROGRAMS:
            help_text = _help(programs / name, words[1:])
        elif words[0].startswith("./"):
            help_text = _script_help(root / words[0])
        else:
            continue
        if help_text is None:
            found.append(f"{' '.join(words)}: there is no such program or subcommand")
            continue
        found += _bad_words(root, words, help_text)
    return found


def _help(program, words):
    """What the program says to --help of the subcommands that the words start with."""
    subcommands = []
    for word in words:
        if not re.fullmatch(r"[a-z]+", word):
            break
        subcommands.append(word)
    # A plain word after the subcommands may be an argument (a name): leave words off until it works.
    for count in range(len(subcommands), -1 if program.name == "linetreed" else 0, -1):
        if program.exists():
            run = subprocess.run([program, *subcommands[:count], "--help"],
                                 capture_output=True, text=True, check=False)
            if run.returncode == 0:
                return run.stdout
    return None


def _script_help(script):
    if not os.access(script, os.X_OK):
        return None
    return subprocess.run([script, "--help"], capture_output=True, text=True, check=False).stdout


def _bad_words(root, words, help_text):
    found = []
    for word in words[1:]:
        option = word.split("=")[0]
        if re.match(r"-", word) and not re.search(rf"(?<![\w-]){re.escape(option)}(?![\w-])", help_text):
            found.append(f"{' '.join(words)}: {option} is not in the program's help")
        for file in re.findall(r"scenes/[\w./-]+", word):
            if not (root / file).exists():
                found.append(f"{' '.join(words)}: {file} does not exist")
    return found


def links_that_lead_nowhere(root):
    """Relative links of the README to files and folders that do not exist."""
    targets = _LINK.findall((root / "README.md").read_text())
    return [target for target in targets if not (root / target).exists()]


def strangers_in_the_root(root):
    """Entries of the root that ROOT does not list."""
    ignored = {line.strip("/ ") for line in (root / ".gitignore").read_text().splitlines()}
    return sorted(entry.name for entry in root.iterdir()
                  if entry.name not in ROOT | ignored and not entry.name.startswith("."))
