"""Programs built from the same sources with different optimisation give the same bits."""

import subprocess
import sys
import unittest

PROGRAMS = []


class Digests(unittest.TestCase):
    def test_they_are_equal(self):
        digests = [subprocess.run([program], capture_output=True, text=True, check=True).stdout
                   for program in PROGRAMS]
        self.assertGreater(len(digests), 1)
        self.assertGreater(digests[0].count("certified"), 10)
        for program, digest in zip(PROGRAMS, digests):
            self.assertEqual(digest, digests[0], program)


if __name__ == "__main__":
    PROGRAMS = sys.argv[1:]
    unittest.main(argv=sys.argv[:1])
