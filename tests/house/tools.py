"""The formatter's and the linter's settings: that they are obeyed, and that they are switched on."""

import concurrent.futures
import fnmatch
import os
import subprocess

from trees import sources

# .clang-tidy enabled 152 checks when this was written. A count well below means that an entry was
# lost; fewer on purpose means lowering this number on purpose.
MIN_CHECKS = 150


def misformatted(root):
    """C++ files that clang-format would change."""
    files = [str(root / path) for path in
             sources(root, ["core", "peers", "server", "client", "tests"], {".h", ".cpp"})]
    workers = os.cpu_count() or 1
    shares = [files[i::workers] for i in range(workers) if files[i::workers]]
    with concurrent.futures.ThreadPoolExecutor() as pool:
        outputs = pool.map(_format_complaints, shares)
    return sorted({line.split(":")[0] for output in outputs for line in output})


def _format_complaints(files):
    run = subprocess.run(["clang-format", "--dry-run", "-Werror", *files],
                         capture_output=True, text=True, check=False)
    return [line for line in run.stderr.splitlines() if "clang-format-violations" in line]


def enabled_checks(config):
    """Names of the checks that a .clang-tidy file switches on."""
    return _checks([f"--config-file={config}"])


def entries_without_effect(config):
    """Entries of the file's Checks list that match no check that clang-tidy has: misspelt, or two
    entries that a missing comma made one."""
    known = _checks(["--config={}", "--checks=*"])
    return [entry for entry in _entries(config)
            if not fnmatch.filter(known, entry.removeprefix("-"))]


def _checks(options):
    run = subprocess.run(["clang-tidy", *options, "--list-checks"],
                         capture_output=True, text=True, check=True)
    return [line.strip() for line in run.stdout.splitlines() if line.startswith("    ")]


def _entries(config):
    """The comma-separated entries of the folded block that follows "Checks:"."""
    block = []
    inside = False
    for line in config.read_text().splitlines():
        if inside and not line.startswith("  "):
            break
        if inside:
            block.append(line.strip())
        inside = inside or line.startswith("Checks:")
    return [entry.strip() for entry in " ".join(block).split(",") if entry.strip()]
