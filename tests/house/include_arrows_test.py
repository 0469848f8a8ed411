"""The include arrows hold, and each kind of wrong arrow would be noticed."""

import unittest

import include_arrows
from trees import PROJECT, MadeTree


class IncludeArrows(unittest.TestCase):
    def test_the_project_follows_them(self):
        self.assertEqual(include_arrows.complaints(PROJECT), [])

    def test_arrows_that_are_right_are_left_alone(self):
        files = {
            "core/render/a.cpp": '#include "core/math/b.h"\n#include <vector>\n#include "absl/x.h"\n',
            "core/io/a.cpp": '#include "core/render/a.h"\n#include "linetree/v1/scene.pb.h"\n',
            "server/a.cpp": '#include "client/library/t.h"\n#include <grpcpp/grpcpp.h>\n',
            "client/program/a.cpp": '#include "client/library/c.h"\n#include "core/io/l.h"\n',
            "client/program/b.cpp": '#include "peers/peer.h"\n',
            "peers/a.cpp": '#include "peers/embree/t.h"\n#include "core/io/pov.h"\n',
            "peers/embree/a.cpp": '#include "peers/embree/b.h"\n#include "core/trace/hit.h"\n',
        }
        with MadeTree(files) as root:
            self.assertEqual(include_arrows.complaints(root), [])

    def test_arrows_that_are_wrong_are_caught(self):
        wrong = {
            "core/math/a.h": '#include "core/scene/scene.h"',
            "core/trace/b.cpp": '  #  include "core/tree/cell.h"',
            "core/tree/c.cpp": '#include "core/io/load_scene.h"',
            "core/scene/d.h": '#include "linetree/v1/scene.pb.h"',
            "core/scene/e.h": "#include <google/protobuf/message.h>",
            "core/io/f.cpp": "#include <grpcpp/grpcpp.h>",
            "core/io/g.cpp": '#include "linetree/v1/service.grpc.pb.h"',
            "core/io/h.cpp": '#include "server/options.h"',
            "core/render/i.cpp": '#include "client/library/client.h"',
            "client/library/j.cpp": '#include "server/options.h"',
            "client/library/k.cpp": '#include "client/program/main.h"',
            "server/l.cpp": '#include "client/program/main.h"',
            "core/math/m.cpp": '#include "vec3.h"',
            "core/render/n.cpp": '#include "peers/peer.h"',
            "client/library/o.cpp": '#include "peers/peer.h"',
            "server/p.cpp": '#include "peers/peer.h"',
            "peers/q.cpp": '#include "client/command/table.h"',
            "peers/embree/r.cpp": '#include "peers/peer.h"',
        }
        for path, text in wrong.items():
            with self.subTest(path), MadeTree({path: text + "\n"}) as root:
                self.assertEqual(len(include_arrows.complaints(root)), 1)


if __name__ == "__main__":
    unittest.main()
