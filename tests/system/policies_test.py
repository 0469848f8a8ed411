"""`linetree cache sim` against plain twins of four policies, on a trace that is written here."""

import json
import os
import random
import struct
import subprocess
import tempfile
import unittest

from policy_twins import TWINS

PROGRAM = os.path.join(os.environ["LINETREE_PROGRAMS"], "linetree")


def zipf_and_scans(count, items, seed):
    """Skewed use of some items, interrupted by scans of items that are used once or come again."""
    rng = random.Random(seed)
    weights = [1 / (rank + 1) ** 0.9 for rank in range(items)]
    requests, fresh = [], items
    while len(requests) < count:
        requests += rng.choices(range(items), weights, k=rng.randrange(500, 2000))
        if rng.random() < 0.5:
            requests += range(fresh, fresh + 400)
            fresh += 400
        else:
            begin = rng.randrange(items)
            requests += ((begin + i) % items for i in range(300))
    return requests[:count]


def write_trace(requests, path):
    last, records = {}, []
    for i in reversed(range(len(requests))):
        records.append(struct.pack("<IQIq", i, requests[i], 100, last.get(requests[i], -1)))
        last[requests[i]] = i
    with open(path, "wb") as file:
        file.writelines(reversed(records))


class Policies(unittest.TestCase):
    def simulate(self, folder, *words):
        figures = os.path.join(folder, "figures.json")
        run = subprocess.run([PROGRAM, "cache", "sim", "--json", figures, *words], capture_output=True, text=True)
        self.assertEqual(run.returncode, 0, run.stderr)
        with open(figures) as file:
            return json.load(file)

    def test_hits_equal_those_of_the_twins(self):
        requests = zipf_and_scans(20_000, 2000, seed=7)
        with tempfile.TemporaryDirectory() as folder:
            trace = os.path.join(folder, "zipf.trace")
            write_trace(requests, trace)
            sizes = (60, 333, 1000)
            rows = self.simulate(folder, "--trace", trace, "--policy", ",".join(TWINS), "--ignore-size",
                                 "--budget", ",".join(map(str, sizes)))
            self.assertEqual(len(rows), len(TWINS) * len(sizes))
            for row in rows:
                expected = TWINS[row["policy"]](requests, row["budget_bytes"])
                self.assertEqual(row["hits"], expected, row["policy"])
                self.assertGreater(row["hits"], 0)
            # With sizes, of which all are equal, the same.
            sized = self.simulate(folder, "--trace", trace, "--policy", "lru,s3-fifo", "--budget", "33000")
            for row in sized:
                self.assertEqual(row["hits"], TWINS[row["policy"]](requests, 330), row["policy"])


if __name__ == "__main__":
    unittest.main()
