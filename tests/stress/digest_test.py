"""Programs built from the same sources with different optimisation, and the same program with
wide vectors and narrow ones, give the same bits."""

import subprocess
import sys
import unittest

PROGRAMS = []


class Digests(unittest.TestCase):
    def test_they_are_equal(self):
        commands = [[program] for program in PROGRAMS] + [[PROGRAMS[-1], "--narrow"]]
        runs = [subprocess.run(command, capture_output=True, text=True, check=True)
                for command in commands]
        self.assertGreater(len(runs), 2)
        self.assertGreater(runs[0].stdout.count("certified"), 10)
        for command, run in zip(commands, runs):
            print(*command[1:], run.stderr.strip(), flush=True)
            self.assertEqual(run.stdout, runs[0].stdout, command)


if __name__ == "__main__":
    PROGRAMS = sys.argv[1:]
    unittest.main(argv=sys.argv[:1])
