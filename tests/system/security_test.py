"""Who gets in: TLS with real certificates, tokens, roles, and the rules about public addresses."""

import os
import pathlib
import queue
import signal
import ssl
import subprocess
import tempfile
import unittest

import grpc

import served
from served import PATIENCE_S, PROGRAMS, fetch, refused, service_pb2, small_frame

LARGE_BYTES = 40 << 20
VIEWER, ADMIN = "looks-and-no-more", "may-do-everything"


def bearer(token):
    return [("authorization", f"Bearer {token}")]


class Certificates:
    """A root, a server's certificate and a client's, made by openssl."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self._openssl("req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256",
                      "-nodes", "-days", "2", "-subj", "/CN=root", "-keyout", "root.key",
                      "-out", "root.pem")
        self._issue("server", "subjectAltName=IP:127.0.0.1,DNS:localhost")
        self._issue("client", "extendedKeyUsage=clientAuth")

    def _openssl(self, *arguments):
        subprocess.run(["openssl", *arguments], cwd=self.folder, check=True, capture_output=True)

    def _issue(self, name, extension):
        self._openssl("req", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes",
                      "-subj", f"/CN={name}", "-keyout", f"{name}.key", "-out", f"{name}.csr")
        (self.folder / "extensions").write_text(extension)
        self._openssl("x509", "-req", "-in", f"{name}.csr", "-CA", "root.pem", "-CAkey",
                      "root.key", "-CAcreateserial", "-days", "2", "-extfile", "extensions",
                      "-out", f"{name}.pem")

    def path(self, name):
        return str(self.folder / name)

    def read(self, name):
        return (self.folder / name).read_bytes()

    def channel(self, with_client=False):
        key, cert = (self.read("client.key"), self.read("client.pem")) if with_client else (None, None)
        return grpc.ssl_channel_credentials(self.read("root.pem"), key, cert)


class Security(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = cls.enterClassContext(tempfile.TemporaryDirectory())
        cls.certificates = Certificates(folder)
        cls.tokens = os.path.join(folder, "tokens")
        pathlib.Path(cls.tokens).write_text(f"viewer {VIEWER}\nadmin {ADMIN}\n")
        cls.tls = ["--tls-cert", cls.certificates.path("server.pem"),
                   "--tls-key", cls.certificates.path("server.key")]

    def linetree(self, *arguments, token=None):
        environment = {k: v for k, v in os.environ.items() if k != "LINETREE_TOKEN"}
        if token is not None:
            environment["LINETREE_TOKEN"] = token
        return subprocess.run([PROGRAMS / "linetree", *arguments], capture_output=True, text=True,
                              timeout=PATIENCE_S, check=False, env=environment)

    def refusal_of(self, *flags):
        run = subprocess.run([served.PROGRAM, *flags], capture_output=True, text=True,
                             timeout=PATIENCE_S, check=False)
        self.assertNotEqual(run.returncode, 0)
        self.assertEqual(run.stdout, "")
        return run.stderr

    def test_a_public_address_needs_tls_and_token(self):
        scene = str(served.PROJECT / "tests" / "system" / "ball.textproto")
        public = ["--tls-cert", "--tls-key", "--token-file", "--insecure"]
        for flags in [[], self.tls, ["--token-file", self.tokens]]:
            text = self.refusal_of("--listen", "0.0.0.0:0", *flags)
            for flag in ["--listen", *public]:
                self.assertIn(flag, text)
        self.assertIn("--http", self.refusal_of("--http", "0.0.0.0:0", "--listen", "127.0.0.1:0"))
        with served.Served("--insecure", "--scene", f"ball={scene}", listen="0.0.0.0:0") as server:
            port = server.address.split(":")[-1]
            with grpc.insecure_channel(f"127.0.0.1:{port}") as channel:
                stub = served.service_pb2_grpc.RadianceCacheStub(channel)
                stub.ListScenes(service_pb2.ListScenesRequest(), timeout=PATIENCE_S)
        with served.Served(*self.tls, "--token-file", self.tokens, "--http", "0.0.0.0:0",
                           listen="0.0.0.0:0", credentials=self.certificates.channel()) as server:
            self.assertEqual(server.stop(), 0)

    def test_bad_files_are_named(self):
        client_key = self.certificates.path("client.key")
        server_cert = self.certificates.path("server.pem")
        for flags, words in [
            (["--tls-cert", server_cert, "--tls-key", client_key], ["--tls-key", client_key]),
            (["--tls-cert", client_key, "--tls-key", client_key], ["--tls-cert", client_key]),
            (["--tls-cert", server_cert, "--tls-key", "gone.pem"], ["--tls-key", "gone.pem"]),
            ([*self.tls, "--tls-client-ca", self.tokens], ["--tls-client-ca", self.tokens]),
            (["--token-file", server_cert], ["--token-file", f"{server_cert}:1:"]),
        ]:
            with self.subTest(flags):
                text = self.refusal_of("--listen", "127.0.0.1:0", *flags)
                for word in words:
                    self.assertIn(word, text)

    def test_roles_over_tls(self):
        with served.Served(*self.tls, "--token-file", self.tokens, "--http", "127.0.0.1:0",
                           credentials=self.certificates.channel()) as server:
            load = service_pb2.LoadSceneRequest(name="ball", text=served.SCENE_TEXT)
            with refused(self, grpc.StatusCode.UNAUTHENTICATED, "authorization: "):
                server.stub.LoadScene(load, timeout=PATIENCE_S)
            with refused(self, grpc.StatusCode.PERMISSION_DENIED, "authorization: LoadScene"):
                server.stub.LoadScene(load, timeout=PATIENCE_S, metadata=bearer(VIEWER))
            server.stub.LoadScene(load, timeout=PATIENCE_S, metadata=bearer(ADMIN))
            frame = list(server.stub.RenderFrame(small_frame(), timeout=PATIENCE_S,
                                                 metadata=bearer(VIEWER)))
            self.assertTrue(frame[-1].HasField("end"))
            with refused(self, grpc.StatusCode.UNAUTHENTICATED, "authorization: "):
                list(server.stub.RenderFrame(small_frame(), timeout=PATIENCE_S,
                                             metadata=bearer("not-the-token-at-all")))
            # Health answers anybody; so do the probes, but not the metrics.
            self.assertEqual(server.call_raw("/grpc.health.v1.Health/Check", b""), b"\x08\x01")
            url = f"https://{server.http}"
            self.assertEqual(fetch(f"{url}/livez")[0], 200)
            self.assertEqual(fetch(f"{url}/readyz")[0], 200)
            self.assertEqual(fetch(f"{url}/metrics")[0], 401)
            status, text = fetch(f"{url}/metrics", Authorization=f"Bearer {VIEWER}")
            self.assertEqual(status, 200)
            self.assertIn('linetree_calls_total{code="PERMISSION_DENIED",rpc="LoadScene"} 1', text)
            series = 'linetree_calls_total{code="UNAUTHENTICATED",rpc="RenderFrame"} 1'
            self.assertIn(series, text)
            self.check_client(server)

    def test_strangers_requests_are_not_read(self):
        with served.Served(*self.tls, "--token-file", self.tokens,
                           credentials=self.certificates.channel()) as server:
            before = served.peak_bytes(server.process)
            request = service_pb2.LoadSceneRequest(name="ball", text=" " * LARGE_BYTES)
            with refused(self, grpc.StatusCode.UNAUTHENTICATED, "authorization: "):
                server.stub.LoadScene(request, timeout=PATIENCE_S)
            self.assertLess(served.peak_bytes(server.process) - before, LARGE_BYTES // 2)
            # An admin's is: a scene without anything in it.
            server.stub.LoadScene(request, timeout=PATIENCE_S, metadata=bearer(ADMIN))
            self.assertGreater(served.peak_bytes(server.process) - before, LARGE_BYTES)

    def check_client(self, server):
        """The linetree command by TLS, with a token from a file or from the environment."""
        tls = ["--server", server.address, "--tls-ca", self.certificates.path("root.pem")]
        run = self.linetree("stats", *tls, token=VIEWER)
        self.assertEqual(run.returncode, 0, run.stderr)
        run = self.linetree("stats", "--limits", *tls, token=VIEWER)
        self.assertIn("max_frame_bytes", run.stdout)
        token_file = pathlib.Path(self.certificates.path("token"))
        token_file.write_text(f"{VIEWER}\n")
        run = self.linetree("stats", *tls, "--token-file", str(token_file), token="ignored")
        self.assertEqual(run.returncode, 0, run.stderr)
        run = self.linetree("stats", *tls)
        self.assertEqual(run.returncode, 1)
        self.assertIn("authorization: expected", run.stderr)
        run = self.linetree("stats", "--server", server.address, "--connect-timeout", "1")
        self.assertEqual(run.returncode, 1)
        self.assertIn(server.address, run.stderr)

    def test_secrets_are_read_anew_while_streams_go_on(self):
        folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        fresh = Certificates(folder)  # another root
        tokens, cert, key = (folder / name for name in ["tokens", "live.pem", "live.key"])
        tokens.write_text(f"viewer {VIEWER}\n")
        cert.write_bytes(self.certificates.read("server.pem"))
        key.write_bytes(self.certificates.read("server.key"))
        scene = str(served.PROJECT / "tests" / "system" / "ball.textproto")
        with served.Served("--tls-cert", str(cert), "--tls-key", str(key), "--token-file",
                           str(tokens), "--http", "127.0.0.1:0", "--scene", f"ball={scene}",
                           credentials=self.certificates.channel()) as server:
            viewpoints = queue.SimpleQueue()
            flight = server.stub.Fly(iter(viewpoints.get, None), timeout=PATIENCE_S,
                                     metadata=bearer(VIEWER))

            def expect_a_frame():
                viewpoints.put(service_pb2.FlyRequest(frame=small_frame()))
                self.assertTrue(any(reply.chunk.HasField("end") for reply in
                                    iter(lambda: next(flight), None)))

            def reload(*lines):
                server.process.send_signal(signal.SIGHUP)
                for words in lines:
                    while words not in (line := server.process.stderr.readline()):
                        self.assertTrue(line, f"no line '{words}'")

            def answer(root, token):
                with grpc.secure_channel(server.address, root.channel()) as channel:
                    stub = served.service_pb2_grpc.RadianceCacheStub(channel)
                    try:
                        stub.ListScenes(service_pb2.ListScenesRequest(), timeout=PATIENCE_S,
                                        metadata=bearer(token))
                    except grpc.RpcError as error:
                        return error.code()
                    return grpc.StatusCode.OK

            def shown_by_https():
                host, port = server.http.rsplit(":", 1)
                return ssl.get_server_certificate((host, int(port)))

            expect_a_frame()
            # What is bad, or half written, changes nothing.
            key.write_bytes(fresh.read("server.key"))
            tokens.write_text("viewer short\n")
            reload(f"--tls-key: {key}: expected the key of {cert}; the old ones stay",
                   "tokens:1: expected a token of")
            expect_a_frame()
            self.assertEqual(answer(self.certificates, VIEWER), grpc.StatusCode.OK)
            self.assertEqual(shown_by_https(), cert.read_text())

            cert.write_bytes(fresh.read("server.pem"))
            tokens.write_text(f"viewer {ADMIN}\n")
            reload("certificate and key are read anew", "tokens are read anew")
            expect_a_frame()
            self.assertEqual(shown_by_https(), fresh.read("server.pem").decode())
            self.assertEqual(answer(fresh, ADMIN), grpc.StatusCode.OK)
            self.assertEqual(answer(fresh, VIEWER), grpc.StatusCode.UNAUTHENTICATED)
            self.assertEqual(answer(self.certificates, ADMIN), grpc.StatusCode.UNAVAILABLE)
            # New calls over the connection that was there show a new token, too.
            with refused(self, grpc.StatusCode.UNAUTHENTICATED, "authorization: "):
                server.stub.ListScenes(service_pb2.ListScenesRequest(), timeout=PATIENCE_S,
                                       metadata=bearer(VIEWER))
            viewpoints.put(None)
            self.assertEqual(list(flight), [])
            self.assertEqual(server.stop(), 0)

    def test_clients_may_have_to_show_a_certificate(self):
        root = self.certificates.path("root.pem")
        with served.Served(*self.tls, "--tls-client-ca", root,
                           credentials=self.certificates.channel(with_client=True)) as server:
            server.load_ball()
            tls = ["--server", server.address, "--connect-timeout", "2", "--tls-ca", root]
            mine = ["--tls-cert", self.certificates.path("client.pem"),
                    "--tls-key", self.certificates.path("client.key")]
            run = self.linetree("stats", *tls, *mine)
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertEqual(self.linetree("stats", *tls).returncode, 1)
            with grpc.secure_channel(server.address, self.certificates.channel()) as stranger:
                stub = served.service_pb2_grpc.RadianceCacheStub(stranger)
                with self.assertRaises(grpc.RpcError) as caught:
                    stub.ListScenes(service_pb2.ListScenesRequest(), timeout=PATIENCE_S)
                self.assertEqual(caught.exception.code(), grpc.StatusCode.UNAVAILABLE)


if __name__ == "__main__":
    unittest.main()
