"""policy_oracle.py --modules FOLDER TRACE...: `linetree cache sim` against what others wrote.

    apt-get install nodejs npm liblemon-utils
    npm install --prefix FOLDER --ignore-scripts lru-cache@11.5.3 @neophi/sieve-cache@1.5.0
    linetree bench policies --frames 40 --traces CORPUS
    policy_oracle.py --modules FOLDER --programs build/release/bin CORPUS/*.trace

LRU and SIEVE are held against these two packages of npm's registry, Belady against the optimum that
LEMON's `dimacs-solver` finds: with C items at a time, whoever holds an item from one use of it to the
next occupies one of the C - 1 places that the uses in between leave, so the most hits are a cheapest
flow of C - 1 units through the line of all uses, along arcs that each stand for a hit. Prints hit
ratios in per cent; exit status 1 where two differ by more than 0.1 points.
"""

import argparse
import itertools
import json
import os
import pathlib
import struct
import subprocess
import sys
import tempfile

RECORD = struct.Struct("<IQIq")
POLICIES = ("lru", "sieve", "belady")
MOST_POINTS = 0.1


def requests_of(trace):
    return [record[1] for record in RECORD.iter_unpack(pathlib.Path(trace).read_bytes())]


def ours(program, trace, capacities):
    with tempfile.TemporaryDirectory() as folder:
        figures = os.path.join(folder, "figures.json")
        subprocess.run([program, "cache", "sim", "--quiet", "--trace", trace, "--ignore-size", "--policy",
                        ",".join(POLICIES), "--budget", ",".join(map(str, capacities)), "--json", figures],
                       check=True, stdout=subprocess.DEVNULL)
        rows = json.loads(pathlib.Path(figures).read_text())
    return {(row["policy"], row["budget_bytes"]): row["hits"] for row in rows}


def packages(modules, trace, capacities):
    script = pathlib.Path(__file__).with_name("replay.mjs")
    run = subprocess.run(["node", script, modules, trace, *map(str, capacities)],
                         check=True, capture_output=True, text=True)
    figures = json.loads(run.stdout)
    return figures["versions"], {(row["policy"], row["capacity"]): row["hits"] for row in figures["rows"]}


def hit_arcs(requests):
    """Pairs (i, j): the item used at i is used again at j > i. Node k is the moment before use k."""
    last = {}
    for j, item in enumerate(requests):
        if item in last:
            yield last[item], j
        last[item] = j


def optimum(requests, capacity):
    """The most hits that any choice of victims leaves, items being brought in when they are missed."""
    arcs, free = [], 0
    for i, j in hit_arcs(requests):
        if j == i + 1:
            free += 1  # nothing lies in between
        else:
            arcs.append((i + 1, j))
    # Moments at which no arc begins or ends are left out.
    moments = sorted(set(itertools.chain.from_iterable(arcs)))
    if capacity == 1 or not moments:
        return free
    number = {moment: k + 1 for k, moment in enumerate(moments)}
    places = capacity - 1
    lines = [f"p min {len(moments)} {len(arcs) + len(moments) - 1}",
             f"n 1 {places}", f"n {len(moments)} {-places}"]
    lines += [f"a {k} {k + 1} 0 {places} 0" for k in range(1, len(moments))]
    lines += [f"a {number[i]} {number[j]} 0 1 -1" for i, j in arcs]
    run = subprocess.run(["dimacs-solver"], input="\n".join(lines) + "\n", check=True,
                         capture_output=True, text=True)
    cost = [line for line in (run.stdout + run.stderr).splitlines() if line.startswith(("s ", "Min flow cost"))]
    if not cost:
        sys.exit(f"dimacs-solver: no cost in what it prints:\n{run.stderr[-400:]}")
    return free - int(cost[-1].split()[-1])


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--modules", required=True)
    parser.add_argument("--programs", default="build/release/bin")
    parser.add_argument("--shares", default="0.1,0.25,0.5,0.75", help="capacities, of all items")
    parser.add_argument("traces", nargs="+")
    flags = parser.parse_args()
    shares = [float(share) for share in flags.shares.split(",")]
    largest = dict.fromkeys(POLICIES, 0.0)
    compared = 0
    for trace in flags.traces:
        requests = requests_of(trace)
        capacities = [max(1, int(share * len(set(requests)))) for share in shares]
        found = ours(os.path.join(flags.programs, "linetree"), trace, capacities)
        versions, expected = packages(flags.modules, trace, capacities)
        expected |= {("belady", capacity): optimum(requests, capacity) for capacity in capacities}
        for (policy, capacity), hits in sorted(expected.items()):
            points = 100 * abs(found[policy, capacity] - hits) / len(requests)
            largest[policy] = max(largest[policy], points)
            compared += 1
            print(f"{os.path.basename(trace):40} {policy:7} {capacity:8} items: {100 * hits / len(requests):7.3f} %, "
                  f"ours {100 * found[policy, capacity] / len(requests):7.3f} %", flush=True)
    print(f"{compared} ratios, {', '.join(f'{name} {version}' for name, version in versions.items())}; largest "
          "difference in points: " + ", ".join(f"{policy} {points:.4f}" for policy, points in largest.items()))
    sys.exit(any(points > MOST_POINTS for points in largest.values()))


if __name__ == "__main__":
    main()
