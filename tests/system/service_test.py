"""Another language against the real server: scenes, frames, rays, refusals, health, reflection."""

import math
import struct
import tempfile
import threading
import time
import unittest

import grpc
from google.protobuf import text_format

import served
from served import PATIENCE_S, SERVICE, refused, scene_pb2, service_pb2, small_frame

CLASSICAL = service_pb2.RenderOptions(mode=service_pb2.CLASSICAL)
# Radiance crosses as float in a frame and as double in a batch: half a unit in the last place of
# 24 bits, with room for a factor of two.
FLOAT_ROUNDING = 2.0**-23
SERVING = b"\x08\x01"  # HealthCheckResponse { status: SERVING }


def assemble(chunks):
    """The frame's radiance as rows of (r, g, b), and its end."""
    pixels, end = {}, None
    for chunk in chunks:
        if chunk.HasField("end"):
            end = chunk.end
            continue
        tile = chunk.tile
        for i in range(tile.width * tile.height):
            at = tile.x + i % tile.width, tile.y + i // tile.width
            assert at not in pixels, at
            pixels[at] = tuple(tile.radiance[3 * i:3 * i + 3])
    return pixels, end


def eye_ray(camera, width, height, column, row):
    """As core/scene/camera.h defines it."""
    def unit(v):
        length = math.sqrt(sum(c * c for c in v))
        return [c / length for c in v]

    def cross(a, b):
        return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]

    eye = [camera.eye.x, camera.eye.y, camera.eye.z]
    at = [camera.look_at.x, camera.look_at.y, camera.look_at.z]
    forward = unit([a - e for a, e in zip(at, eye)])
    right = unit(cross(forward, [camera.up.x, camera.up.y, camera.up.z]))
    up = cross(right, forward)
    half = math.tan(math.radians(camera.fov_deg) / 2)
    x = (2 * (column + 0.5) / width - 1) * half
    y = (1 - 2 * (row + 0.5) / height) * half * height / width
    d = [f + x * r + y * u for f, r, u in zip(forward, right, up)]
    return service_pb2.Ray(origin=camera.eye,
                           direction=scene_pb2.Vec3(x=d[0], y=d[1], z=d[2]))


class Service(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        file = served.PROJECT / "scenes" / "gap.textproto"
        cls.server = cls.enterClassContext(served.Served("--scene", f"gap={file}"))
        cls.stub = cls.server.stub
        cls.server.load_ball()

    def frame(self, **fields):
        return assemble(self.stub.RenderFrame(small_frame(**fields), timeout=PATIENCE_S))

    def test_scenes_from_file_text_and_message(self):
        message = text_format.Parse(served.SCENE_TEXT, scene_pb2.Scene())
        by_message = self.stub.LoadScene(
            service_pb2.LoadSceneRequest(name="message", scene=message), timeout=PATIENCE_S)
        by_text = self.stub.DescribeScene(service_pb2.DescribeSceneRequest(scene="ball"),
                                          timeout=PATIENCE_S)
        self.assertEqual(by_message.scene_version, by_text.scene_version)
        self.assertEqual(by_text.objects, 2)
        self.assertEqual([c.name for c in by_text.cameras], ["front"])
        listed = self.stub.ListScenes(service_pb2.ListScenesRequest(), timeout=PATIENCE_S)
        self.assertEqual({s.name for s in listed.scenes}, {"ball", "gap", "message"})
        self.stub.UnloadScene(service_pb2.UnloadSceneRequest(scene="message"),
                              timeout=PATIENCE_S)

    def test_a_classical_frame_is_what_its_rays_are(self):
        pixels, end = self.frame(width=70, height=66, options=CLASSICAL)
        self.assertEqual(len(pixels), 70 * 66)
        places = [(x, y) for x in range(70) for y in range(0, 66, 5)]
        reply = self.stub.TraceRays(
            service_pb2.TraceRaysRequest(
                scene="ball", options=CLASSICAL,
                rays=[eye_ray(end.camera, 70, 66, x, y) for x, y in places]),
            timeout=PATIENCE_S)
        self.assertEqual(reply.scene_version, end.scene_version)
        self.assertEqual(len(reply.answers), len(places))
        different = 0
        for place, answer in zip(places, reply.answers):
            ray = (answer.radiance.r, answer.radiance.g, answer.radiance.b)
            if not all(math.isclose(a, b, rel_tol=FLOAT_ROUNDING, abs_tol=FLOAT_ROUNDING)
                       for a, b in zip(pixels[place], ray)):
                different += 1
        # A ray along an edge may fall to the other side: Python's tan is not bound to be C++'s.
        self.assertLessEqual(different, 1)
        self.assertGreater(len({pixels[p] for p in places}), 100, "a picture, not one colour")

    def test_counters_add_up(self):
        for _ in range(2):
            _, end = self.frame(options=service_pb2.RenderOptions(max_relative_error=0.25))
            stats = end.stats
            self.assertEqual(stats.pixels, 48 * 32)
            self.assertEqual(stats.interpolated + stats.traced + stats.background, 48 * 32)
            self.assertEqual(sum(stats.verdicts.values()), 48 * 32)
            self.assertEqual(stats.intersect, stats.base_intersect + stats.ip_intersect)
            self.assertEqual(end.max_relative_error, 0.25)
        reply = self.stub.GetStats(service_pb2.GetStatsRequest(scene="ball"), timeout=PATIENCE_S)
        self.assertGreaterEqual(reply.scenes[0].frames, 2)
        self.assertGreater(reply.uptime_s, 0)

    def test_certified_frames_are_classical(self):
        classical, _ = self.frame(width=128, height=128, options=CLASSICAL)
        certified = service_pb2.RenderOptions(judge=service_pb2.JUDGE_CERTIFIED,
                                              max_relative_error=0)
        for _ in range(2):
            pixels, end = self.frame(width=128, height=128, options=certified)
            self.assertEqual(pixels, classical)
            self.assertEqual(end.stats.intersect,
                             end.stats.eye_rays + end.stats.reflected_rays +
                             end.stats.refracted_rays + end.stats.shadow_rays -
                             end.stats.listed_shadow_rays - end.stats.listed_branch_rays)
        self.assertGreater(end.stats.listed_shadow_rays, 0)

    def test_what_frames_leave_out_is_explained(self):
        def explain(**fields):
            request = service_pb2.ExplainRequest(scene="ball", **fields)
            return self.server.stub.Explain(request, timeout=PATIENCE_S)

        options = service_pb2.RenderOptions(lanes=service_pb2.LANES_SIMD)
        for _ in range(2):
            list(self.server.stub.RenderFrame(small_frame(options=options), timeout=PATIENCE_S))
        reply = explain()
        objects = reply.objects_asked + reply.objects_skipped
        self.assertEqual(sum(count.objects for count in reply.reasons), objects)
        self.assertEqual(len(reply.objects), objects)
        self.assertGreaterEqual(reply.decisions, 1)
        points = [plan.points for plan in reply.objects]
        self.assertEqual(points, sorted(points, reverse=True))
        notes = {note.feature: note for note in reply.features}
        self.assertEqual(notes["all objects"].count, objects)
        exact = {note.feature: note for note in explain(max_relative_error=0).features}
        self.assertNotEqual(exact["diffuse sums"], notes["diffuse sums"])
        self.assertEqual(len(explain(max_objects=1).objects), 1)
        for fields in ({"max_relative_error": math.nan}, {"max_objects": 0}):
            with refused(self, grpc.StatusCode.INVALID_ARGUMENT, next(iter(fields)) + ": "):
                explain(**fields)

    def test_scenes_from_the_servers_folder(self):
        folder = served.PROJECT / "scenes"
        def load(server, **fields):
            return server.stub.LoadScene(service_pb2.LoadSceneRequest(name="file", **fields),
                                         timeout=PATIENCE_S)
        with refused(self, grpc.StatusCode.PERMISSION_DENIED, "file:"):
            load(self.server, file="gap.textproto")
        with served.Served("--scene-root", str(folder)) as server:
            info = load(server, file="gap.textproto")
            gap = self.stub.DescribeScene(service_pb2.DescribeSceneRequest(scene="gap"))
            self.assertEqual(info.scene_version, gap.scene_version)
            with refused(self, grpc.StatusCode.PERMISSION_DENIED, "file:"):
                load(server, file="../README.md")
            with refused(self, grpc.StatusCode.NOT_FOUND, "file:"):
                load(server, file="gone.nff")

    def test_a_server_is_ready_when_its_scenes_are_warm(self):
        path = self.enterContext(tempfile.NamedTemporaryFile("w"))
        path.write("frames: 12 keyframes { camera { eye { y: 1.6 z: 2.7 } look_at { y: 1.1 } } }")
        path.flush()
        with served.Served("--scene", f"room={served.PROJECT / 'scenes' / 'room.textproto'}",
                           "--warm-up", f"room={path.name}",
                           "--scene-weight", "room=3") as server:
            def is_ready():
                return server.call_raw("/grpc.health.v1.Health/Check", b"") == SERVING
            def room():
                return server.stub.DescribeScene(service_pb2.DescribeSceneRequest(scene="room"),
                                                 timeout=PATIENCE_S)
            self.assertFalse(is_ready())
            self.assertGreater(room().warm_up_frames_left, 0)
            self.assertEqual(len(list(server.stub.RenderFrame(
                small_frame(scene="room"), timeout=PATIENCE_S))), 2, "served all the same")
            while not is_ready():
                time.sleep(0.05)
            self.assertEqual(room().warm_up_frames_left, 0)
            server.load_ball()
            self.assertEqual(room().memory_budget_bytes, 3 << 28)

    def test_the_server_has_a_default_judge(self):
        with served.Served("--judge", "paper") as server:
            server.load_ball()
            for _ in range(2):
                chunks = server.stub.RenderFrame(small_frame(width=128, height=128),
                                                 timeout=PATIENCE_S)
                _, end = assemble(chunks)
            self.assertGreater(end.stats.interpolated, 0)
            self.assertEqual(end.stats.listed_shadow_rays, 0)

    def test_a_flight_answers_every_viewpoint_in_order(self):
        def viewpoints():
            for i in range(5):
                camera = scene_pb2.Camera(eye={"x": i, "y": 3, "z": 8}, look_at={"y": 1})
                yield service_pb2.FlyRequest(sequence=10 + i,
                                             frame=small_frame(camera=camera, options=CLASSICAL))
        frames = {}
        for reply in self.stub.Fly(viewpoints(), timeout=PATIENCE_S):
            frames.setdefault(reply.sequence, []).append(reply.chunk)
        self.assertEqual(list(frames), [10, 11, 12, 13, 14])
        for i, chunks in enumerate(frames.values()):
            pixels, end = assemble(chunks)
            self.assertEqual(len(pixels), 48 * 32)
            self.assertEqual(end.camera.eye.x, i)

    def test_a_frame_in_every_codec(self):
        floats, _ = self.frame(options=CLASSICAL)
        halves = {}
        files = {}
        codecs = {service_pb2.CODEC_HALF: b"", service_pb2.CODEC_EXR: b"v/1\x01",
                  service_pb2.CODEC_PNG: b"\x89PNG\r\n", service_pb2.CODEC_JPEG: b"\xff\xd8\xff"}
        for codec, magic in codecs.items():
            frame = small_frame(options=CLASSICAL, codec=codec)
            for chunk in self.stub.RenderFrame(frame, timeout=PATIENCE_S):
                self.assertLessEqual(chunk.ByteSize(), 256 * 1024)
                if chunk.HasField("file"):
                    file = files.setdefault(codec, b"")
                    self.assertEqual(chunk.file.offset, len(file))
                    files[codec] = file + chunk.file.data
                    self.assertTrue(files[codec].startswith(magic))
                    self.assertGreaterEqual(chunk.file.file_bytes, len(files[codec]))
                elif chunk.HasField("tile"):
                    tile = chunk.tile
                    values = struct.unpack(f"<{3 * tile.width * tile.height}e", tile.radiance_half)
                    for i in range(tile.width * tile.height):
                        at = tile.x + i % tile.width, tile.y + i // tile.width
                        halves[at] = values[3 * i:3 * i + 3]
        self.assertEqual(len(files), 3)
        self.assertEqual(set(halves), set(floats))
        for at, pixel in floats.items():
            for a, b in zip(pixel, halves[at]):
                self.assertLessEqual(abs(a - b), max(2**-11 * a, 2**-25))

    def test_a_client_that_steers_gets_its_newest_viewpoint(self):
        sent = []
        seen = threading.Event()

        def viewpoints():
            while not seen.is_set():
                sent.append(len(sent))
                yield service_pb2.FlyRequest(sequence=sent[-1], frame=small_frame(),
                                             pacing=service_pb2.PACING_NEWEST)
        ends = []
        for reply in self.stub.Fly(viewpoints(), timeout=PATIENCE_S):
            if reply.chunk.HasField("end"):
                ends.append(reply)
                if reply.skipped:
                    seen.set()
        self.assertEqual(len(ends) + sum(end.skipped for end in ends), len(sent))
        self.assertEqual(ends[-1].sequence, sent[-1])

    def test_refusals_name_the_field(self):
        nan = float("nan")
        invalid, exhausted = grpc.StatusCode.INVALID_ARGUMENT, grpc.StatusCode.RESOURCE_EXHAUSTED
        for code, field, fields in [
            (invalid, "camera.eye", {"camera": scene_pb2.Camera(eye={"x": nan})}),
            (invalid, "width", {"width": 0}),
            (exhausted, "height", {"height": 2**31}),
            (grpc.StatusCode.NOT_FOUND, "scene", {"scene": "gone"}),
            (invalid, "options.max_relative_error",
             {"options": service_pb2.RenderOptions(max_relative_error=2)}),
        ]:
            with self.subTest(field), refused(self, code, field):
                self.frame(**fields)
        ray = service_pb2.Ray(direction={"z": 1})
        with refused(self, exhausted, "rays"):
            self.stub.TraceRays(
                service_pb2.TraceRaysRequest(scene="ball", rays=[ray] * (2**20 + 1)),
                timeout=PATIENCE_S)
        with refused(self, invalid, "bad:1:"):
            self.stub.LoadScene(service_pb2.LoadSceneRequest(name="bad", text="objects { x }"),
                                timeout=PATIENCE_S)
        self.assertEqual(len(self.frame()[0]), 48 * 32)

    def test_half_a_message_is_invalid(self):
        whole = small_frame(options=CLASSICAL).SerializeToString()
        for method in ["RenderFrame", "TraceRays", "LoadScene"]:
            with self.subTest(method), refused(self, grpc.StatusCode.INVALID_ARGUMENT, method):
                self.server.call_raw(f"/{SERVICE}/{method}", whole[:-1])

    def test_health_is_served(self):
        for service in ["", SERVICE]:
            name = service.encode()
            request = bytes([0x0A, len(name)]) + name if name else b""
            self.assertEqual(self.server.call_raw("/grpc.health.v1.Health/Check", request),
                             SERVING)

    def test_reflection_lists_the_service(self):
        list_services = b"\x3a\x00"  # ServerReflectionRequest { list_services: "" }
        replies = self.server.channel.stream_stream(
            "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo")(
                iter([list_services]), timeout=PATIENCE_S)
        self.assertIn(SERVICE.encode(), b"".join(replies))


if __name__ == "__main__":
    unittest.main()
