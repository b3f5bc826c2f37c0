#!/usr/bin/env python3
"""Programs that draw nothing load no library that draws.

    programs_test.py PALPATE PROGRAM...
"""
import re
import subprocess
import sys
import unittest

PALPATE, *PROGRAMS = sys.argv[1:]


def loaded(program):
    return subprocess.run(["ldd", program], capture_output=True, text=True, check=True).stdout


class Programs(unittest.TestCase):
    def test_those_that_do_not_draw_load_no_cairo(self):
        self.assertIn("libcairo", loaded(PALPATE))
        for program in PROGRAMS:
            with self.subTest(program=program):
                self.assertEqual(re.findall(r"libcairo\S*", loaded(program)), [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
