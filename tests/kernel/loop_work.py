# What a tick costs with recording, CAN codec and checks, beside the bare loop, counted in instructions.
import unittest

from guest_tools import *

MOST_MORE_US = 20.0


class Work(unittest.TestCase):
    """tests/kernel: work per tick."""

    def test_beside_the_bare_loop(self):
        run = subprocess.run(["/tmp/kernel_loop_work", CONFIG, str(20 if plan["long"] else 4), "/tmp/work.csv.gz"],
                             capture_output=True, text=True)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        work = json.loads(run.stdout)
        figures["work"] = work
        more_us = work["with_codec_and_recording"]["work_us"]["p99_99"] - work["bare"]["work_us"]["p99_99"]
        work["more_at_p99_99_us"] = round(more_us, 3)
        self.assertLess(more_us, MOST_MORE_US)
