"""How linetreed ends, and how it takes it when others do."""

import queue
import signal
import subprocess
import sys
import time
import unittest

import grpc

import served
from served import PATIENCE_S, service_pb2, small_frame

# Asks for a large frame and stops reading after its first chunk.
_LAZY_READER = """
import sys
sys.path.insert(0, sys.argv[2])
import grpc
from linetree.v1 import service_pb2, service_pb2_grpc
stub = service_pb2_grpc.RadianceCacheStub(grpc.insecure_channel(sys.argv[1]))
request = service_pb2.RenderFrameRequest(scene="ball", width=1000, height=1000)
request.options.mode = service_pb2.CLASSICAL
for chunk in stub.RenderFrame(request):
    print("reading", flush=True)
    sys.stdin.read()
"""


def frame_ends(replies):
    return sum(1 for reply in replies if reply.HasField("end"))


class Signals(unittest.TestCase):
    def test_both_end_it_well(self):
        for number in [signal.SIGTERM, signal.SIGINT]:
            with self.subTest(number), served.Served() as server:
                server.load_ball()
                self.assertEqual(server.stop(number), 0)

    def test_an_idle_flight_does_not_keep_it(self):
        with served.Served("--drain-timeout-ms", "3600000") as server:
            server.load_ball()
            viewpoints = queue.SimpleQueue()
            viewpoints.put(service_pb2.FlyRequest(frame=small_frame()))
            replies = server.stub.Fly(iter(viewpoints.get, None), timeout=PATIENCE_S)
            next(replies)
            self.assertEqual(server.stop(), 0)
            with self.assertRaises(grpc.RpcError) as caught:
                for _ in replies:
                    pass
            viewpoints.put(None)
            self.assertEqual(caught.exception.code(), grpc.StatusCode.UNAVAILABLE)

    def test_a_frame_under_way_is_finished_first(self):
        with served.Served() as server:
            server.load_ball()
            chunks = server.stub.RenderFrame(small_frame(width=500, height=500),
                                             timeout=PATIENCE_S)
            next(chunks)
            server.process.send_signal(signal.SIGTERM)
            self.assertEqual(frame_ends(chunks), 1)
            self.assertEqual(server.process.wait(timeout=PATIENCE_S), 0)


class Draining(unittest.TestCase):
    def slow_frame(self, server):
        """A frame whose client has read its beginning and reads no more."""
        server.load_ball()
        chunks = server.stub.RenderFrame(small_frame(width=1500, height=1500), timeout=PATIENCE_S)
        next(chunks)
        return chunks

    def test_it_is_not_ready_but_lives_until_all_is_done(self):
        with served.Served("--http", "127.0.0.1:0", "--drain-timeout-ms", "3600000") as server:
            chunks = self.slow_frame(server)
            server.process.send_signal(signal.SIGTERM)
            url = f"http://{server.http}"
            served.wait_until(lambda: served.fetch(f"{url}/readyz")[0] == 503)
            self.assertEqual(served.fetch(f"{url}/livez")[0], 200)
            with grpc.insecure_channel(server.address) as channel:
                stub = served.service_pb2_grpc.RadianceCacheStub(channel)
                with self.assertRaises(grpc.RpcError) as caught:
                    stub.ListScenes(service_pb2.ListScenesRequest(), timeout=PATIENCE_S)
            self.assertEqual(caught.exception.code(), grpc.StatusCode.UNAVAILABLE)
            self.assertIsNone(server.process.poll())
            self.assertEqual(frame_ends(chunks), 1)
            self.assertEqual(server.process.wait(timeout=PATIENCE_S), 0)

    def test_what_is_not_done_in_time_is_cancelled(self):
        with served.Served("--drain-timeout-ms", "100") as server:
            chunks = self.slow_frame(server)
            self.assertEqual(server.stop(), 0)
            with self.assertRaises(grpc.RpcError):
                frame_ends(chunks)

    def test_a_second_signal_ends_it_at_once(self):
        with served.Served("--http", "127.0.0.1:0", "--drain-timeout-ms", "3600000") as server:
            chunks = self.slow_frame(server)
            server.process.send_signal(signal.SIGTERM)
            served.wait_until(lambda: served.fetch(f"http://{server.http}/readyz")[0] == 503)
            self.assertEqual(server.stop(), 128 + signal.SIGTERM)
            chunks.cancel()


class Vanishing(unittest.TestCase):
    def test_a_client_that_is_killed_mid_stream_does_no_harm(self):
        with served.Served() as server:
            server.load_ball()
            for _ in range(3):
                reader = subprocess.Popen(
                    [sys.executable, "-c", _LAZY_READER, server.address, served.STUBS],
                    stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
                self.assertEqual(reader.stdout.readline(), "reading\n")
                reader.kill()
                reader.communicate()
                chunks = server.stub.RenderFrame(small_frame(), timeout=PATIENCE_S)
                self.assertEqual(frame_ends(chunks), 1)
            self.assertEqual(server.stop(), 0)


    def test_a_client_that_is_killed_costs_no_more_rays(self):
        # Its frame would take minutes; there is one place to render.
        endless = ('width=4000, height=4000, options={"mode": "CLASSICAL", "max_depth": 16, '
                   '"min_weight": 0}, sampling={"samples": 25}')
        program = _LAZY_READER.replace("width=1000, height=1000", endless).replace(
            "for chunk in", 'print("asking", flush=True)\nfor chunk in')
        with served.Served("--render-slots", "1") as server:
            server.load_ball()
            reader = subprocess.Popen(
                [sys.executable, "-c", program, server.address, served.STUBS],
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
            self.assertEqual(reader.stdout.readline(), "asking\n")
            while server.process_cpu_s() < 1:  # then it is being rendered
                time.sleep(0.01)
            with self.assertRaises(grpc.RpcError) as late:
                list(server.stub.RenderFrame(small_frame(), timeout=0.3))
            self.assertEqual(late.exception.code(), grpc.StatusCode.DEADLINE_EXCEEDED)
            reader.kill()
            reader.communicate()
            chunks = server.stub.RenderFrame(small_frame(), timeout=PATIENCE_S)
            self.assertEqual(frame_ends(chunks), 1)
            stats = server.stub.GetStats(service_pb2.GetStatsRequest(), timeout=PATIENCE_S)
            self.assertEqual(stats.scenes[0].frames, 1, "neither the endless nor the late one")
            self.assertEqual(server.stop(), 0)


class BadStarts(unittest.TestCase):
    def run_with(self, *flags):
        return subprocess.run([served.PROGRAM, *flags], capture_output=True, text=True,
                              timeout=PATIENCE_S, check=False)

    def test_bad_flags_are_named(self):
        for flags in [["--epsilon", "2"], ["--scene", "noequals"], ["--memory", "12"],
                      ["--max-depth", "99"], ["--max-flight-s", "-1"],
                      ["--warm-up", "gone=path"], ["--scene-weight", "a"],
                      ["--scene-root", "/gone"], ["--threads", "-3"], ["--judge", "supreme"]]:
            with self.subTest(flags):
                run = self.run_with(*flags)
                self.assertNotEqual(run.returncode, 0)
                self.assertIn(flags[0], run.stderr)
                self.assertEqual(run.stdout, "")

    def test_a_missing_scene_file_is_named(self):
        run = self.run_with("--scene", "a=gone.textproto")
        self.assertEqual(run.returncode, 1)
        self.assertIn("gone.textproto", run.stderr)

    def test_a_taken_port_is_an_error(self):
        with served.Served() as server:
            run = self.run_with("--listen", server.address)
            self.assertEqual(run.returncode, 1)
            self.assertIn("--listen", run.stderr)


if __name__ == "__main__":
    unittest.main()
