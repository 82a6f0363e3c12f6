"""Sessions: steps, states, journal and replay, beside those of the program."""

import os
import shutil
import tempfile
import unittest

import numpy as np

import fettle

from program import run

TOUCHED = os.path.join(os.environ["FETTLE_SOURCE"], "tests/haptic/journal/sessions/contact_revision_1.fettle")


class Sessions(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = os.path.join(folder.name, "work.fettle")

    def touched(self):
        shutil.copy(TOUCHED, self.path)  # opening a session may write beside it
        return fettle.Session(self.path)

    def test_its_journal_is_that_of_the_program(self):
        session = self.touched()
        self.assertEqual(session.journal, run("journal", self.path)["entries"])
        self.assertGreater(len(session.journal), 0)

    def test_replay_gives_the_present_state_again(self):
        session = self.touched()
        made = session.replay()
        self.assertEqual(made.hash, session.field.hash)
        self.assertEqual(made.hash, run("replay", self.path, self.path + ".tif")["hash"])
        self.assertEqual(fettle.replay(self.path).hash, made.hash)

    def test_states_lead_from_the_original_to_the_present(self):
        session = self.touched()
        self.assertEqual(session.at(0).hash, session.original.hash)
        self.assertEqual(session.at(session.state).hash, session.field.hash)
        self.assertEqual([step.number for step in session.steps], list(session.states)[1:])
        self.assertEqual(fettle.read(self.path).hash, session.field.hash)
        with self.assertRaises(fettle.InputError):
            session.at(session.states[-1] + 1)

    def test_a_field_is_written_with_what_it_began_as(self):
        scan = fettle.synth(size=(128, 96), seed=2)
        scan.mark(edges=True, lines_out=True).filter("median").write(self.path)
        session = fettle.Session(self.path)
        self.assertEqual(session.original.hash, scan.hash)
        self.assertGreater(len(session.field.lines), 0)
        self.assertTrue(session.field.marks.any())
        np.testing.assert_array_equal(np.asarray(session.original), np.asarray(scan))

    def test_a_recipe_applies_to_a_field(self):
        scan = fettle.synth(size=(128, 96), seed=2)
        recipe = os.path.join(os.path.dirname(self.path), "clean.toml")
        with open(recipe, "w", encoding="ascii") as file:
            file.write('recipe = 1\n\n[[step]]\ndo = "filter"\nfilter = "median"\nwindow = 5\n')
        self.assertEqual(scan.apply(recipe).hash, scan.filter("median", window=5).hash)

    def test_what_is_no_session_is_refused(self):
        with self.assertRaises(fettle.InputError):
            fettle.Session(os.path.join(os.path.dirname(self.path), "none.fettle"))
        with self.assertRaises(fettle.InputError):
            scan = os.path.join(os.path.dirname(self.path), "scan.tif")
            fettle.synth(size=(64, 64)).write(scan)
            fettle.Session(scan)
        with self.assertRaises(fettle.InputError):
            fettle.synth(size=(64, 64)).filter("box").write(self.path)
            fettle.Session(self.path).replay()


if __name__ == "__main__":
    unittest.main()
