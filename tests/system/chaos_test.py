"""Clients and servers that misbehave, stop and die. Whatever happens to some, every frame that others
get is held against the classical one, memory stays bounded, and the server ends well."""

import itertools
import pathlib
import queue
import random
import re
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import unittest

import grpc

import served
from served import PATIENCE_S, PROGRAMS, scene_pb2, service_pb2, small_frame

EPSILON = 0.1
WHITE = 1.0
# Beyond the budget of the caches: code, libraries, threads, packets, frames in work, which are some
# twenty bytes a pixel. The address sanitizer keeps what was freed for a while, up to 256 MiB.
RSS_BEYOND_BUDGET_BYTES = (256 << 20) + (512 << 20) * served.SANITIZED
MEMORY_BYTES = 2 << 20
# A ray along an edge, and radiance as float: see service_test.py.
FLOAT_ROUNDING = 2.0**-22


def radiance_of(chunks):
    """Tiles by their place, and the end of the frame."""
    tiles, end = {}, None
    for chunk in chunks:
        if chunk.HasField("end"):
            end = chunk.end
        else:
            tiles[chunk.tile.x, chunk.tile.y] = list(chunk.tile.radiance)
    return tiles, end


def eye(step):
    """Places around the ball."""
    return scene_pb2.Camera(eye={"x": 7 - step % 14, "y": 2 + step % 3, "z": 8}, look_at={"y": 1},
                            up={"y": 1}, fov_deg=45)


class Oracle:
    """Classical frames of a server, each asked for once; and others held against them."""

    def __init__(self, stub):
        self.stub = stub
        self.frames = {}
        self.lock = threading.Lock()

    def classical(self, step, scene="ball"):
        request = small_frame(scene=scene, camera=eye(step))
        request.options.mode = service_pb2.CLASSICAL
        tiles, end = radiance_of(self.stub.RenderFrame(request, timeout=PATIENCE_S))
        with self.lock:
            self.frames[step % 42, end.scene_version] = tiles

    def errors(self, step, tiles, end):
        """How many channels of a frame are further from the classical one than was promised."""
        with self.lock:
            classical = self.frames[step % 42, end.scene_version]
        assert tiles.keys() == classical.keys()
        return sum(
            abs(a - c) > EPSILON * max(c, WHITE / 1024) + FLOAT_ROUNDING * c
            for place, tile in tiles.items() for a, c in zip(tile, classical[place], strict=True))


def cached_frame(step, **fields):
    request = small_frame(camera=eye(step), **fields)
    request.options.max_relative_error = EPSILON
    return request


class Chaos(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = cls.enterClassContext(served.Served(
            "--memory", str(MEMORY_BYTES), "--http", "127.0.0.1:0", "--audit", "0.01",
            stderr=subprocess.DEVNULL))
        cls.stub = cls.server.stub
        cls.server.load_ball()
        cls.oracle = Oracle(cls.stub)
        for step in range(6):
            cls.oracle.classical(step)

    @classmethod
    def tearDownClass(cls):
        # What all of them together have left behind.
        stats = cls.stub.GetStats(service_pb2.GetStatsRequest(), timeout=PATIENCE_S)
        assert all(s.audit.violations == 0 for s in stats.scenes), stats
        assert sum(s.cache_bytes for s in stats.scenes) <= MEMORY_BYTES, stats
        assert served.peak_bytes(cls.server.process) < MEMORY_BYTES + RSS_BEYOND_BUDGET_BYTES
        assert cls.server.stop() == 0

    def expect_good_frames(self, count=3):
        for step in range(count):
            tiles, end = radiance_of(self.stub.RenderFrame(cached_frame(step), timeout=PATIENCE_S))
            self.assertEqual(self.oracle.errors(step, tiles, end), 0)

    def test_cancel_storm(self):
        random.seed(20261123)

        def cancel_many():
            with grpc.insecure_channel(self.server.address) as channel:
                stub = served.service_pb2_grpc.RadianceCacheStub(channel)
                for i in range(40):
                    call = stub.RenderFrame(cached_frame(i, width=700, height=500),
                                            timeout=PATIENCE_S)
                    threading.Event().wait(random.random() / 100)
                    call.cancel()

        storm = [threading.Thread(target=cancel_many) for _ in range(5)]
        for thread in storm:
            thread.start()
        # Whoever does not cancel comes through, perhaps at the second attempt.
        good = 0
        while good < 5:
            try:
                tiles, end = radiance_of(
                    self.stub.RenderFrame(cached_frame(good), timeout=PATIENCE_S))
            except grpc.RpcError as error:
                self.assertEqual(error.code(), grpc.StatusCode.RESOURCE_EXHAUSTED)
                continue
            self.assertEqual(self.oracle.errors(good, tiles, end), 0)
            good += 1
        for thread in storm:
            thread.join()
        self.expect_good_frames()

    def test_slow_reader(self):
        viewpoints = queue.SimpleQueue()
        for step in range(30):
            viewpoints.put(service_pb2.FlyRequest(sequence=step, frame=cached_frame(
                step % 6, width=400, height=300)))
        replies = self.stub.Fly(iter(viewpoints.get, None), timeout=PATIENCE_S)
        next(replies)
        self.expect_good_frames()
        replies.cancel()
        viewpoints.put(None)
        self.expect_good_frames()

    def test_half_open_sockets(self):
        host, port = self.server.address.rsplit(":", 1)
        preface = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + b"\0\0\0\4\0\0\0\0\0"
        sockets = []
        for count in range(60):
            s = socket.create_connection((host, int(port)))
            s.sendall(preface[:count])
            sockets.append(s)
        http = [socket.create_connection(tuple(self.server.http.split(":"))) for _ in range(3)]
        self.expect_good_frames()
        self.assertEqual(served.fetch(f"http://{self.server.http}/livez")[0], 200)
        for s in sockets + http:
            s.close()

    def test_a_network_that_swallows_everything(self):
        with Swallower(self.server.address) as network:
            channel = grpc.insecure_channel(network.address)
            stub = served.service_pb2_grpc.RadianceCacheStub(channel)
            calls = [stub.RenderFrame(cached_frame(0, width=900, height=900), timeout=PATIENCE_S)
                     for _ in range(3)]
            next(calls[0])
            network.swallow.set()
            self.expect_good_frames()
        channel.close()
        self.expect_good_frames()

    def test_a_client_that_is_stopped_goes_on(self):
        reader = subprocess.Popen(
            [sys.executable, "-c", _SLOW_READER, self.server.address, served.STUBS],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        with reader:
            self.assertEqual(reader.stdout.readline(), "reading\n")
            reader.send_signal(signal.SIGSTOP)
            self.expect_good_frames()
            reader.send_signal(signal.SIGCONT)
            reader.stdin.close()
            self.assertEqual(reader.stdout.read(), "done\n")

    def test_scenes_that_are_replaced_while_they_are_rendered(self):
        texts = [served.SCENE_TEXT, served.SCENE_TEXT.replace("radius: 1", "radius: 1.5")]
        for text in texts:
            self.stub.LoadScene(service_pb2.LoadSceneRequest(name="changing", text=text,
                                                             replace=True), timeout=PATIENCE_S)
            for step in range(3):
                self.oracle.classical(step, scene="changing")
        stop = threading.Event()

        def replace():
            for text in itertools.cycle(texts):
                if stop.is_set():
                    break
                self.stub.LoadScene(service_pb2.LoadSceneRequest(
                    name="changing", text=text, replace=True), timeout=PATIENCE_S)

        replacer = threading.Thread(target=replace)
        replacer.start()
        versions = set()
        for step in itertools.count():
            tiles, end = radiance_of(self.stub.RenderFrame(
                cached_frame(step % 3, scene="changing"), timeout=PATIENCE_S))
            self.assertEqual(self.oracle.errors(step % 3, tiles, end), 0)
            versions.add(end.scene_version)
            if step >= 40 and len(versions) == 2:
                break
        stop.set()
        replacer.join()


class Swallower:
    """A network between a client and a server that may swallow all that is sent, both ways."""

    def __init__(self, address):
        self.target = address.rsplit(":", 1)
        self.swallow = threading.Event()
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.address = "127.0.0.1:" + str(self.listener.getsockname()[1])
        self.sockets = []

    def __enter__(self):
        threading.Thread(target=self._accept, daemon=True).start()
        return self

    def __exit__(self, *unused):
        for s in [self.listener, *self.sockets]:
            s.close()

    def _accept(self):
        try:
            while True:
                near = self.listener.accept()[0]
                far = socket.create_connection((self.target[0], int(self.target[1])))
                self.sockets += [near, far]
                for a, b in [(near, far), (far, near)]:
                    threading.Thread(target=self._pass, args=(a, b), daemon=True).start()
        except OSError:
            pass

    def _pass(self, source, sink):
        try:
            while (data := source.recv(65536)) and not self.swallow.is_set():
                sink.sendall(data)
        except OSError:
            pass


# Reads the beginning of a frame, and the rest once its standard input ends.
_SLOW_READER = """
import sys
sys.path.insert(0, sys.argv[2])
import grpc
from linetree.v1 import service_pb2, service_pb2_grpc
stub = service_pb2_grpc.RadianceCacheStub(grpc.insecure_channel(sys.argv[1]))
request = service_pb2.RenderFrameRequest(scene="ball", width=1000, height=1000)
chunks = stub.RenderFrame(request)
next(chunks)
print("reading", flush=True)
sys.stdin.read()
print("done" if list(chunks)[-1].HasField("end") else "broken")
"""


class Endings(unittest.TestCase):
    def test_drain_under_load(self):
        with served.Served("--drain-timeout-ms", "20000", stderr=subprocess.DEVNULL) as server:
            server.load_ball()
            oracle = Oracle(server.stub)
            for step in range(3):
                oracle.classical(step)
            results, began = queue.SimpleQueue(), threading.Barrier(9)

            def render():
                began.wait()
                for step in itertools.count():
                    try:
                        tiles, end = radiance_of(server.stub.RenderFrame(
                            cached_frame(step % 3), timeout=PATIENCE_S))
                    except grpc.RpcError as error:
                        if error.code() != grpc.StatusCode.RESOURCE_EXHAUSTED:
                            return results.put(error.code())
                    else:
                        if oracle.errors(step % 3, tiles, end):
                            return results.put("a wrong frame")

            threads = [threading.Thread(target=render) for _ in range(8)]
            for thread in threads:
                thread.start()
            began.wait()
            served.wait_until(lambda: server.stub.GetStats(
                service_pb2.GetStatsRequest(), timeout=PATIENCE_S).scenes[0].frames > 20)
            self.assertEqual(server.stop(), 0)
            for thread in threads:
                thread.join()
            # What arrives while gRPC itself is going down is cancelled, whatever we do.
            self.assertLessEqual({results.get() for _ in threads},
                                 {grpc.StatusCode.UNAVAILABLE, grpc.StatusCode.CANCELLED})

    def test_a_flight_outlives_its_server(self):
        scene = str(served.PROJECT / "scenes" / "gap.textproto")
        path = str(served.PROJECT / "scenes" / "paths" / "room_walk.textproto")
        folder = self.enterContext(tempfile.TemporaryDirectory())
        flags = ["--scene", f"gap={scene}"]
        fly = [PROGRAMS / "linetree", "fly", "--path", path, "--frames", "30", "--width", "160",
               "--height", "120", "--epsilon", str(EPSILON)]
        classical = subprocess.run(
            [*fly, "--local", "--scene", scene, "--mode", "classical", "-q",
             "-o", f"{folder}/classical_%02d.exr"], check=False, timeout=PATIENCE_S)
        self.assertEqual(classical.returncode, 0)
        with served.Served(*flags, stderr=subprocess.DEVNULL) as first:
            flight = subprocess.Popen(
                [*fly, "--scene", "gap", "--server", first.address,
                 "-o", f"{folder}/flown_%02d.exr"], stdout=subprocess.PIPE, text=True)
            served.wait_until(lambda: pathlib.Path(f"{folder}/flown_03.exr").exists())
            first.process.kill()
            first.process.wait()
            with served.Served(*flags, listen=first.address, stderr=subprocess.DEVNULL) as second:
                flight.communicate(timeout=PATIENCE_S)
                self.assertEqual(flight.returncode, 0)
                stats = second.stub.GetStats(service_pb2.GetStatsRequest(), timeout=PATIENCE_S)
                self.assertIn(stats.scenes[0].frames, range(1, 30))
                self.assertEqual(second.stop(), 0)
        for frame in range(1, 31):
            compared = subprocess.run(
                [PROGRAMS / "linetree", "compare", f"{folder}/flown_{frame:02d}.exr",
                 f"{folder}/classical_{frame:02d}.exr", "--epsilon", str(EPSILON)],
                capture_output=True, text=True, check=False, timeout=PATIENCE_S)
            self.assertEqual(compared.returncode, 0, compared.stdout)

    def test_memory_after_ten_thousand_frames_of_64_sessions(self):
        frames = 16 if served.SANITIZED else 160
        scene = str(served.PROJECT / "scenes" / "room.textproto")
        path = str(served.PROJECT / "scenes" / "paths" / "room_walk.textproto")
        with served.Served("--scene", f"room={scene}", "--memory", str(MEMORY_BYTES),
                           stderr=subprocess.DEVNULL) as server:
            run = subprocess.run(
                [PROGRAMS / "linetree", "load", "--server", server.address, "--scene", "room",
                 "--path", path, "--clients", "64", "--frames", str(frames), "--width",
                 "24", "--height", "16", "-q"], capture_output=True, text=True, check=False,
                timeout=PATIENCE_S)
            self.assertEqual(run.returncode, 0, run.stderr)
            stats = server.stub.GetStats(service_pb2.GetStatsRequest(), timeout=PATIENCE_S)
            self.assertEqual(stats.scenes[0].frames, 64 * frames)
            self.assertLessEqual(stats.scenes[0].cache_bytes, MEMORY_BYTES)
            self.assertLess(served.peak_bytes(server.process),
                            MEMORY_BYTES + RSS_BEYOND_BUDGET_BYTES)
            self.assertEqual(server.stop(), 0)

    def test_the_example_of_the_library(self):
        scene = str(served.PROJECT / "scenes" / "gap.textproto")
        with served.Served() as server:
            run = subprocess.run([PROGRAMS / "orbit", server.address, "gap", scene],
                                 capture_output=True, text=True, check=False, timeout=PATIENCE_S)
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertEqual(len(re.findall(r"^frame \d: \d+ % from the cache$", run.stdout,
                                            re.MULTILINE)), 8, run.stdout)


if __name__ == "__main__":
    unittest.main()
