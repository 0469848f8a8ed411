"""`linetree cache sim` against plain twins of four policies, and what a server records and is told."""

import json
import os
import random
import struct
import subprocess
import tempfile
import unittest

import grpc
from policy_twins import TWINS
from served import PATIENCE_S, Served, refused, service_pb2, small_frame

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

    def test_a_server_records_what_its_sessions_use(self):
        with tempfile.TemporaryDirectory() as folder:
            trace = os.path.join(folder, "ball.trace")
            with Served("--record-trace", trace, "--policy", "lru") as server:
                server.load_ball()
                for _ in range(5):
                    list(server.stub.RenderFrame(small_frame(width=320, height=240), timeout=PATIENCE_S))
                self.assertEqual(server.stop(), 0)
            with open(trace, "rb") as file:
                records = list(struct.iter_unpack("<IQIq", file.read()))
            self.assertEqual(os.path.getsize(trace + ".cost"), 4 * len(records))
            self.assertEqual({time for time, *_ in records}, set(range(5)))
            following = {}
            for i in reversed(range(len(records))):
                _, item, _, next_use = records[i]
                self.assertEqual(next_use, following.get(item, -1))
                following[item] = i
            rows = self.simulate(folder, "--trace", trace, "--policy", "all", "--budget", "100%")
            for row in rows:
                self.assertEqual(row["hits"], len(records) - len(following), row["policy"])
                self.assertAlmostEqual(row["regret"], 1, places=4)

    def test_policies_are_switched_while_a_server_runs(self):
        with Served("--memory", "1MiB") as server:
            server.load_ball()

            def tune(**fields):
                request = service_pb2.TuneCacheRequest(scene="ball", **fields)
                return server.stub.TuneCache(request, timeout=PATIENCE_S)

            frame = small_frame(width=320, height=240)
            for policy in ("sieve", "gdsf", "lru"):
                self.assertEqual(tune(policy=policy).policy, policy)
                list(server.stub.RenderFrame(frame, timeout=PATIENCE_S))
            self.assertEqual(tune().policy, "lru")
            self.assertEqual(tune().memory_budget_bytes, 1 << 20)
            stats = server.stub.GetStats(service_pb2.GetStatsRequest(), timeout=PATIENCE_S).scenes[0]
            self.assertEqual(stats.eviction_policy, "lru")
            self.assertLessEqual(stats.cache_bytes, 1 << 20)
            for code, fields in ((grpc.StatusCode.INVALID_ARGUMENT, {"policy": "mru"}),
                                 (grpc.StatusCode.INVALID_ARGUMENT, {"policy": ""})):
                with refused(self, code, "policy: "):
                    tune(**fields)
            words = ["cache", "policy", "fifo", "--scene", "ball", "--server", server.address]
            run = subprocess.run([PROGRAM, *words], capture_output=True, text=True)
            self.assertEqual((run.returncode, run.stdout), (0, "ball: fifo, 1.0 MiB at most\n"), run.stderr)
            self.assertEqual(tune().policy, "fifo")


if __name__ == "__main__":
    unittest.main()
