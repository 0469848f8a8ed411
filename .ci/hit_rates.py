"""hit_rates.py COLD.json WARM.json CLASSICAL.json FOLDER: the demo's table.

Reads the --stats files of three flights along one path, prints a table with a line for each frame,
and writes it to FOLDER/hit_rates.txt and its numbers to FOLDER/hit_rates.json. The hit rate is the
share of the pixels that show an object and were answered without a search of the scene but for
their eye ray's hit; intersect and shade are ratios to the classical frame's counts (paper, section
8).
"""

import json
import pathlib
import sys


def frames(path):
    return json.loads(pathlib.Path(path).read_text())["frames"]


def row(frame, classical):
    return {
        "hit_rate": (frame["interpolated"] + frame["replayed"])
                    / max(1, frame["pixels"] - frame["background"]),
        "intersect_ratio": frame["intersect"] / max(1, classical["intersect"]),
        "shade_ratio": frame["shade"] / max(1, classical["shade"]),
        "wall_ms": frame["wall_ms"],
        "cells_tried": frame["cells_tried"],
        "cache_bytes": frame["cache_bytes"],
    }


def table(rows):
    lines = [
        "        first flight (empty cache)           second flight (warm)                 classical",
        "frame   hits  intersect  shade  cells     ms   hits  intersect  shade  cells     ms      ms",
    ]
    for number, (cold, warm, classical_ms) in enumerate(rows, 1):
        halves = "  ".join(
            f"{r['hit_rate']:5.1%} {r['intersect_ratio']:10.2f} {r['shade_ratio']:6.2f}"
            f" {r['cells_tried']:6d} {r['wall_ms']:6.0f}" for r in (cold, warm))
        lines.append(f"{number:5d}  {halves} {classical_ms:7.0f}")
    return "\n".join(lines) + "\n"


def main(cold_file, warm_file, classical_file, folder):
    rows = [(row(cold, classical), row(warm, classical), classical["wall_ms"])
            for cold, warm, classical in zip(frames(cold_file), frames(warm_file),
                                             frames(classical_file), strict=True)]
    text = table(rows)
    folder = pathlib.Path(folder)
    (folder / "hit_rates.txt").write_text(text)
    (folder / "hit_rates.json").write_text(json.dumps(
        {"frames": [{"cold": c, "warm": w, "classical_ms": ms} for c, w, ms in rows]}, indent=2))
    print(text, end="")


main(*sys.argv[1:])
