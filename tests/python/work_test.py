"""Long work: its progress, Ctrl-C, several threads at once, and that the interpreter goes on meanwhile."""

import concurrent.futures
import os
import signal
import subprocess
import sys
import threading
import time
import unittest

import numpy as np

import fettle

# Minutes of work, so that ending early can be seen.
LONG = {"filter": "median", "window": 101, "passes": 1000}


class Progress(unittest.TestCase):
    def test_stage_and_share_are_told(self):
        told = []

        def progress(stage, share):
            told.append((stage, share))
            if len(told) == 5:
                raise StopIteration

        field = fettle.synth(size=(512, 512))
        with self.assertRaises(StopIteration):
            field.filter(**LONG, progress=progress)
        self.assertEqual(len(told), 5)
        for stage, share in told:
            self.assertTrue(stage)
            self.assertTrue(0.0 <= share <= 1.0)

    def test_an_exception_in_it_ends_the_work_and_the_field_can_be_used_again(self):
        field = fettle.synth(size=(256, 256))
        before = field.hash

        def progress(stage, share):
            raise RuntimeError("enough")

        with self.assertRaisesRegex(RuntimeError, "enough"):
            field.filter(**LONG, progress=progress)
        self.assertEqual(field.hash, before)
        self.assertEqual(field.filter("box").shape, field.shape)


INTERRUPTED = """
import sys, time, fettle
field = fettle.synth(size=(512, 512))
print("begins", flush=True)
try:
    field.filter("median", window=101, passes=1000)
    print("was not interrupted")
except KeyboardInterrupt:
    print("interrupted at", time.monotonic(), flush=True)
print(field.filter("box").shape)
"""


class Interrupt(unittest.TestCase):
    def test_ctrl_c_ends_long_work_as_keyboard_interrupt(self):
        program = subprocess.Popen(
            [sys.executable, "-c", INTERRUPTED], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        self.assertEqual(program.stdout.readline(), "begins\n")
        time.sleep(0.5)
        pressed = time.monotonic()
        program.send_signal(signal.SIGINT)
        line = program.stdout.readline()
        self.assertTrue(line.startswith("interrupted at"), line + program.stderr.read() if not line else line)
        took = float(line.split()[-1]) - pressed
        print(f"Ctrl-C took effect after {1000 * took:.0f} ms")
        self.assertEqual(program.communicate(timeout=60)[0], "(512, 512)\n")
        self.assertEqual(program.returncode, 0)

    def test_signals_are_those_of_python(self):
        before = signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM)
        fettle.synth(size=(64, 64)).filter("box")
        self.assertEqual((signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM)), before)


class Threads(unittest.TestCase):
    def test_several_threads_compute_what_one_does(self):
        field = fettle.synth(size=(200, 150))
        work = [("median", 5), ("box", 9), ("gaussian", 7), ("tgv", 3), ("planes", 3), ("bilateral", 5)] * 3
        one = [field.filter(name, window=window).hash for name, window in work]
        with concurrent.futures.ThreadPoolExecutor(8) as pool:
            many = list(pool.map(lambda each: field.filter(each[0], window=each[1]).hash, work))
        self.assertEqual(many, one)

    def test_warnings_and_errors_are_those_of_the_thread_that_called(self):
        field = fettle.synth(size=(64, 64))

        def refused(k):
            try:
                fettle.read(f"/no/{k}.tif")
            except fettle.InputError as error:
                return error.where
            finally:
                field.filter("box")

        with concurrent.futures.ThreadPoolExecutor(8) as pool:
            self.assertEqual(list(pool.map(refused, range(40))), [f"/no/{k}.tif" for k in range(40)])

    def test_other_threads_of_python_go_on_during_long_work(self):
        field = fettle.synth(size=(512, 512))
        counted = 0
        ends = threading.Event()

        def count():
            nonlocal counted
            while not ends.is_set():
                counted += 1
                time.sleep(0)

        counter = threading.Thread(target=count)
        counts = []

        def progress(stage, share):
            counts.append(counted)
            if len(counts) == 4:
                raise StopIteration

        counter.start()
        with self.assertRaises(StopIteration):
            field.filter(**LONG, progress=progress)
        ends.set()
        counter.join()
        self.assertEqual(sorted(set(counts)), counts)

    def test_arrays_go_in_and_out_on_several_threads(self):
        heights = np.random.default_rng(0).random((300, 400)).astype(np.float32)
        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            for out in pool.map(lambda _: np.asarray(fettle.Field(heights)), range(16)):
                np.testing.assert_array_equal(out, heights)


class Quiet(unittest.TestCase):
    def test_nothing_is_printed(self):
        script = (
            "import fettle, warnings; warnings.simplefilter('ignore')\n"
            "f = fettle.synth(size=(64, 64)); f.filter('tgv'); f.info(); f.compare(f); f.suggest('1mm')\n"
            "try: fettle.read('/no.tif')\nexcept fettle.Error: pass\n"
        )
        done = subprocess.run([sys.executable, "-c", script], capture_output=True, check=True, env=dict(os.environ))
        self.assertEqual((done.stdout, done.stderr), (b"", b""))


if __name__ == "__main__":
    unittest.main()
