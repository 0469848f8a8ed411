"""What a server keeps on its disk: warm when it comes back, whatever ended it, and never wrong.

LINETREE_STRESS_LONG=1 kills it a hundred times."""

import os
import pathlib
import random
import re
import signal
import subprocess
import tempfile
import unittest

import served
from served import PATIENCE_S, PROGRAMS, service_pb2

ROOM = str(served.PROJECT / "scenes" / "room.textproto")
LONG = os.environ.get("LINETREE_STRESS_LONG", "0") not in ("", "0")
KILLS = 100 if LONG else 4


def frame(stub, camera="", epsilon=0.0, mode=service_pb2.CACHED, size=96):
    """Bytes of all tiles, and the end."""
    request = service_pb2.RenderFrameRequest(
        scene="room", camera_name=camera, width=size, height=size)
    request.options.mode = mode
    request.options.max_relative_error = epsilon
    tiles, end = [], None
    for chunk in stub.RenderFrame(request, timeout=PATIENCE_S):
        if chunk.HasField("end"):
            end = chunk.end
        else:
            tiles.append(chunk.tile.SerializeToString())
    return tiles, end


def hit_rate(end):
    hits = end.stats.interpolated + end.stats.replayed
    return hits / (end.stats.interpolated + end.stats.traced)


class Store(unittest.TestCase):

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def serve(self, *flags, **popen):
        return served.Served("--scene", f"room={ROOM}", "--data-dir", str(self.folder), *flags,
                             stderr=subprocess.DEVNULL, **popen)

    def store_of(self, stub):
        return stub.GetStats(service_pb2.GetStatsRequest(), timeout=PATIENCE_S).scenes[0].store

    def tool(self, *arguments):
        return subprocess.run([PROGRAMS / "linetree", "store", *arguments, "--data-dir",
                               str(self.folder)], capture_output=True, text=True, check=False)

    def test_a_restarted_server_is_warm_from_its_first_frame_on(self):
        with self.serve() as server:
            for _ in range(6):
                _, end = frame(server.stub, size=192)
            warm = hit_rate(end)
            self.assertGreater(warm, 0.9)
            server.process.send_signal(signal.SIGTERM)
            self.assertEqual(server.process.wait(PATIENCE_S), 0)
        with self.serve() as server:
            restored = self.store_of(server.stub).cells_restored
            self.assertGreater(restored, 100)
            tiles, end = frame(server.stub, size=192)
            self.assertGreaterEqual(hit_rate(end), 0.9 * warm)
            self.assertEqual(tiles, frame(server.stub, size=192, mode=service_pb2.CLASSICAL)[0])
            # Who has one server's folder runs without.
            with self.serve() as other:
                self.assertFalse(other.stub.GetStats(service_pb2.GetStatsRequest()).scenes[0]
                                 .HasField("store"))
                self.assertEqual(frame(other.stub, size=192)[0], tiles)
            # Who looks may do so meanwhile.
            self.assertRegex(self.tool("stat").stdout, r"room +[0-9a-f]{32} ")
            self.assertNotEqual(self.tool("prune", "--all").returncode, 0)
        self.assertEqual(self.tool("verify").returncode, 0)
        self.assertRegex(self.tool("prune", "--scene", "room").stdout, r"[1-9]\d* pages")
        with self.serve() as server:
            self.assertEqual(self.store_of(server.stub).cells_restored, 0)

    def test_it_may_be_killed_at_any_moment(self):
        seed = int(os.environ.get("LINETREE_STRESS_SEED", "1"))
        moments = random.Random(seed)
        with self.serve() as server:
            cameras = [camera.name for camera in server.stub.DescribeScene(
                service_pb2.DescribeSceneRequest(scene="room")).cameras]
            classical = {camera: frame(server.stub, camera, mode=service_pb2.CLASSICAL, size=192)[0]
                         for camera in cameras}
        committed = 0
        for round_ in range(KILLS):
            with self.serve() as server:
                store = self.store_of(server.stub)
                self.assertEqual(store.pages_odd, 0, f"round {round_}, seed {seed}")
                self.assertGreaterEqual(store.cells_restored + store.cells_left, committed,
                                        f"round {round_}, seed {seed}")
                committed = store.cells_restored + store.cells_left
                for camera in moments.sample(cameras, moments.randint(1, len(cameras))):
                    tiles, _ = frame(server.stub, camera, size=192)
                    self.assertEqual(tiles, classical[camera], f"round {round_}, seed {seed}")
                if moments.random() < 0.5:
                    served.wait_until(
                        lambda: self.store_of(server.stub).waiting_bytes == 0)
                    committed += self.store_of(server.stub).cells_written
                server.process.send_signal(signal.SIGKILL)
                server.process.wait(PATIENCE_S)
        self.assertGreater(committed, 100)

    def test_a_disk_that_is_full_costs_cells_only(self):
        log = self.folder / "log"
        # No file may become longer than 64 KiB: as on a full disk, writing fails.
        limited = ["prlimit", "--fsize=65536", "--"]
        with log.open("w") as err:
            with served.Served("--scene", f"room={ROOM}", "--data-dir", str(self.folder / "data"),
                               stderr=err, before=limited) as server:
                for _ in range(3):
                    tiles, _ = frame(server.stub, size=192)
                served.wait_until(lambda: self.store_of(server.stub).cells_lost > 0)
                self.assertEqual(tiles, frame(server.stub, size=192, mode=service_pb2.CLASSICAL)[0])
        self.assertRegex(log.read_text(), "cells are not kept")

    def test_what_is_odd_is_put_aside(self):
        with self.serve() as server:
            frame(server.stub)
            server.process.send_signal(signal.SIGTERM)
            server.process.wait(PATIENCE_S)
        data = self.folder / "cells" / "data.mdb"
        data.write_bytes(random.Random(1).randbytes(data.stat().st_size))
        self.assertEqual(self.tool("verify").returncode, 1)
        with self.serve() as server:
            self.assertEqual(self.store_of(server.stub).cells_restored, 0)
            frame(server.stub)
        self.assertTrue((self.folder / "cells" / "data.mdb.odd").exists())

    def test_tools_say_what_they_expected(self):
        missing = self.tool("stat")
        self.assertEqual(missing.returncode, 1)
        self.assertRegex(missing.stderr, "^linetree: .*cells")
        self.assertTrue(re.search("stat.*verify.*prune", self.tool("--help").stdout, re.DOTALL))


if __name__ == "__main__":
    unittest.main()
