"""What whoever runs a server sees of it: probes, metrics, logs, configuration, the service manager."""

import json
import os
import pathlib
import re
import signal
import socket
import subprocess
import tempfile
import unittest

import grpc

import served
from served import PATIENCE_S, fetch, refused, service_pb2, small_frame, wait_until

SERVING, NOT_SERVING = b"\x08\x01", b"\x08\x02"


def health(server, service):
    name = service.encode()
    request = bytes([0x0A, len(name)]) + name if name else b""
    return server.call_raw("/grpc.health.v1.Health/Check", request)


def metrics(server):
    """Values by series, as Prometheus would read them."""
    status, text = fetch(f"http://{server.http}/metrics")
    assert status == 200, text
    values = {}
    for line in text.splitlines():
        if not line.startswith("#"):
            series, value = line.rsplit(" ", 1)
            values[series] = float(value)
    return values


class Watching(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = cls.enterClassContext(served.Served("--http", "127.0.0.1:0"))
        cls.stub = cls.server.stub
        cls.server.load_ball()

    def test_health_knows_every_scene(self):
        self.assertEqual(health(self.server, "scene/ball"), SERVING)
        with refused(self, grpc.StatusCode.NOT_FOUND, ""):
            health(self.server, "scene/gone")
        self.server.load_ball("other")
        self.assertEqual(health(self.server, "scene/other"), SERVING)
        self.stub.UnloadScene(service_pb2.UnloadSceneRequest(scene="other"), timeout=PATIENCE_S)
        self.assertEqual(health(self.server, "scene/other"), NOT_SERVING)

    def test_probes(self):
        url = f"http://{self.server.http}"
        self.assertEqual(fetch(f"{url}/livez"), (200, "ok\n"))
        self.assertEqual(fetch(f"{url}/readyz"), (200, "ok\n"))
        self.assertEqual(fetch(f"{url}/elsewhere")[0], 404)
        self.assertEqual(fetch(f"{url}/../../etc/passwd")[0], 404)

    def test_metrics_are_those_of_the_stats(self):
        before = metrics(self.server)
        for _ in range(3):
            list(self.stub.RenderFrame(small_frame(), timeout=PATIENCE_S))
        with refused(self, grpc.StatusCode.NOT_FOUND, "scene"):
            list(self.stub.RenderFrame(small_frame(scene="gone"), timeout=PATIENCE_S))
        stats = self.stub.GetStats(service_pb2.GetStatsRequest(scene="ball"), timeout=PATIENCE_S)
        # A call counts once its end has gone out.
        series = 'linetree_calls_total{code="NOT_FOUND",rpc="RenderFrame"}'
        wait_until(lambda: metrics(self.server).get(series, 0) > before.get(series, 0))
        now = metrics(self.server)
        scene = stats.scenes[0]
        self.assertEqual(now['linetree_frames_total{scene="ball"}'], scene.frames)
        for source, count in scene.answers.sources.items():
            self.assertEqual(now[f'linetree_answers_total{{scene="ball",source="{source}"}}'], count)
        self.assertEqual(sum(scene.answers.sources.values()), scene.answers.answers)
        self.assertEqual(sum(scene.answers.verdicts.values()), scene.answers.answers)
        self.assertEqual(
            sum(o.answers.answers for o in scene.objects) + scene.answers.sources["background"],
            scene.answers.answers)
        series = 'linetree_call_seconds_count{rpc="RenderFrame"}'
        self.assertEqual(now[series] - before.get(series, 0), 4)
        self.assertGreater(now["process_resident_memory_bytes"], 1 << 20)
        self.assertEqual(now['linetree_queue_length{queue="renders"}'], 0)

    def test_limits_are_listed(self):
        limits = self.stub.GetLimits(service_pb2.GetLimitsRequest(), timeout=PATIENCE_S).limits
        values = {limit.name: limit.value for limit in limits}
        self.assertEqual(len(values), len(limits))
        with refused(self, grpc.StatusCode.RESOURCE_EXHAUSTED, "width"):
            list(self.stub.RenderFrame(small_frame(width=values["render.max_side"] + 1),
                                       timeout=PATIENCE_S))


class Logs(unittest.TestCase):
    def test_lines_of_json_with_request_ids(self):
        with served.Served("--log-format", "json", "--log-level", "debug") as server:
            call = server.stub.LoadScene.with_call(
                service_pb2.LoadSceneRequest(name="ball", text=served.SCENE_TEXT),
                timeout=PATIENCE_S, metadata=[("x-request-id", "shot-7")])[1]
            self.assertIn(("x-request-id", "shot-7"), call.initial_metadata())
            with refused(self, grpc.StatusCode.NOT_FOUND, "scene"):
                list(server.stub.RenderFrame(small_frame(scene="gone"), timeout=PATIENCE_S))
            # Protobuf complains of what is no UTF-8: in our words, not in its own on the same stream.
            with refused(self, grpc.StatusCode.INVALID_ARGUMENT, ""):
                server.call_raw(f"/{served.SERVICE}/DescribeScene", b"\x0a\x01\xff")
            server.process.send_signal(signal.SIGTERM)
            lines = [json.loads(line) for line in server.process.communicate()[1].splitlines()]
        calls = {line["rpc"]: line for line in lines if line["message"] == "call"}
        self.assertEqual(calls["/linetree.v1.RadianceCache/LoadScene"]["request_id"], "shot-7")
        self.assertEqual(calls["/linetree.v1.RadianceCache/LoadScene"]["code"], "OK")
        self.assertTrue(any(line["message"].startswith("Protobuf: ") for line in lines))
        loaded = [line for line in lines if line["message"].startswith("scene ball loaded")]
        self.assertEqual([line["request_id"] for line in loaded], ["shot-7"])
        frame = calls["/linetree.v1.RadianceCache/RenderFrame"]
        self.assertEqual(frame["code"], "NOT_FOUND")
        self.assertRegex(frame["request_id"], r"^[0-9a-f]{32}$")
        self.assertGreater(float(frame["ms"]), 0)

    def test_a_full_disk_or_a_reader_that_stops_costs_lines_only(self):
        read_end, write_end = os.pipe()
        self.addCleanup(os.close, read_end)
        with open("/dev/full", "w", encoding="utf-8") as full, os.fdopen(write_end) as pipe:
            for stderr in [full, pipe]:
                with served.Served("--log-level", "debug", "--http", "127.0.0.1:0",
                                   stderr=stderr) as server:
                    server.load_ball()
                    for _ in range(1500):
                        server.stub.ListScenes(service_pb2.ListScenesRequest(), timeout=PATIENCE_S)
                    self.assertGreater(metrics(server)["linetree_log_lines_lost_total"], 0)
                    self.assertEqual(server.stop(), 0)


class Starting(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def run_with(self, *flags):
        return subprocess.run([served.PROGRAM, *flags], capture_output=True, text=True,
                              timeout=PATIENCE_S, check=False)

    def test_version(self):
        run = self.run_with("--version")
        self.assertEqual(run.returncode, 0)
        self.assertRegex(run.stdout, r"^linetreed \d+\.\d+\.\d+\n$")

    def test_a_configuration_says_what_flags_say(self):
        scene = served.PROJECT / "tests" / "system" / "ball.textproto"
        config = self.folder / "linetreed.conf"
        config.write_text(f'# a comment\nscene = ["a={scene}", "b={scene}"]\n'
                          'memory = "64MiB"\nepsilon = 0.5\nhttp = "127.0.0.1:0"\n'
                          'audit = 0.25\n')
        with served.Served("--config", str(config), "--epsilon", "0.125") as server:
            stats = server.stub.GetStats(service_pb2.GetStatsRequest(), timeout=PATIENCE_S)
            self.assertEqual([s.scene for s in stats.scenes], ["a", "b"])
            self.assertEqual(stats.memory_budget_bytes, 64 << 20)
            self.assertEqual(stats.audit_share, 0.25)
            chunks = server.stub.RenderFrame(small_frame(scene="a"), timeout=PATIENCE_S)
            self.assertEqual(list(chunks)[-1].end.max_relative_error, 0.125)
        config.write_text("epsilom = 0.5\n")
        run = self.run_with("--config", str(config))
        self.assertNotEqual(run.returncode, 0)
        self.assertIn("epsilom", run.stderr)
        run = self.run_with("--config", str(self.folder / "gone"))
        self.assertNotEqual(run.returncode, 0)
        self.assertIn("gone", run.stderr)

    def test_every_flag_may_stand_in_the_configuration(self):
        text = self.run_with("--help").stdout
        flags = set(re.findall(r"^  --([a-z-]+)", text, re.MULTILINE)) - {"help", "version", "config"}
        self.assertGreater(len(flags), 15)
        shipped = (served.PROJECT / "server" / "linetreed.conf").read_text()
        for name in re.findall(r"^#? ?([a-z-]+) = ", shipped, re.MULTILINE):
            self.assertIn(name, flags)

    def test_the_service_manager_is_told(self):
        path = str(self.folder / "notify")
        for name in [path, "\0linetree-test-" + str(os.getpid())]:
            with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
                manager.bind(name)
                manager.settimeout(PATIENCE_S)
                env = {**os.environ, "NOTIFY_SOCKET": name.replace("\0", "@")}
                with served.Served(env=env) as server:
                    self.assertEqual(manager.recv(100), b"READY=1")
                    self.assertEqual(server.stop(), 0)
                    self.assertEqual(manager.recv(100), b"STOPPING=1")


if __name__ == "__main__":
    unittest.main()
