"""Logs that are damaged, cut, foreign or no logs, and what is exported of those that are not."""

import os
import time

from command import FOREIGN, InFolder, main


class Damage(InFolder):
    def setUp(self):
        super().setUp()
        self.bytes = self.run_short().read_bytes()

    def damaged(self, data):
        (self.folder / "bad.mcap").write_bytes(data)
        done = self.pliant("log", "info", "bad.mcap")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("whole       no: ", done.stdout)
        self.assertIn("`pliant log repair bad.mcap` makes a whole log of what is readable", done.stdout)
        return done.stdout

    def repaired(self):
        told = self.ends(0, "log", "repair", "bad.mcap", "good.mcap", "--force")
        self.ends(0, "log", "info", "good.mcap")
        return told

    def test_that_is_none_is_said_to_be_none(self):
        self.assertIn("whole       yes\n", self.ends(0, "log", "info", "out/logs/run.mcap"))

    def test_by_a_cut_is_told_wherever_it_is(self):
        for size in range(8, len(self.bytes), len(self.bytes) // 15):
            self.damaged(self.bytes[:size])
            self.repaired()

    def test_of_a_single_bit_is_found_wherever_it_is(self):
        size = len(self.bytes)
        for at in range(8, size - 8, size // 30):
            data = bytearray(self.bytes)
            data[at] ^= 4
            (self.folder / "bad.mcap").write_bytes(data)
            info = self.pliant("log", "info", "bad.mcap")
            self.assertIn(info.returncode, (0, 1), info.stderr)
            if info.returncode == 0:  # the index, which has no checksum to hold it against
                self.ends(0, "replay", "bad.mcap")
            self.repaired()

    def test_that_leaves_no_row_is_no_report_and_no_replay(self):
        self.damaged(self.bytes[:40000])
        self.assertIn("kept 0 messages", self.repaired())
        self.refuses("good.mcap: the log has no row; a report needs whole runs",
                     "report", "good.mcap", "--out", "report")
        self.refuses("good.mcap: the log has no row of arm.measured_position", "replay", "good.mcap")

    def test_of_a_hundred_megabytes_takes_no_time(self):
        begun = time.monotonic()
        (self.folder / "noise.mcap").write_bytes(os.urandom(100_000_000))
        for words in (["log", "info", "noise.mcap"], ["log", "repair", "noise.mcap", "new.mcap"],
                      ["replay", "noise.mcap"], ["export", "noise.mcap", "new.csv"]):
            self.refuses("noise.mcap: not an MCAP file: it does not begin with \\x89MCAP0\\r\\n", *words)
        self.damaged(self.bytes[: len(self.bytes) // 2] + os.urandom(100_000_000))
        self.repaired()
        self.damaged(self.bytes[:8] + bytes(100_000_000))
        self.assertLess(time.monotonic() - begun, 20)

    def test_what_is_no_log_is_refused(self):
        (self.folder / "empty.mcap").write_bytes(b"")
        for name, message in [("empty.mcap", "empty.mcap: not an MCAP file: it is empty"),
                              (".", "cannot read .: it is not a file"),
                              ("/dev/zero", "cannot read /dev/zero: it is not a file"),
                              ("none.mcap", "cannot read none.mcap: No such file or directory")]:
            self.refuses(message, "log", "info", name)
            self.refuses(message, "report", name, "--out", "report")

    def test_a_repair_writes_over_nothing(self):
        self.damaged(self.bytes[:-10])
        self.refuses("cannot repair bad.mcap in its place; name another file to write",
                     "log", "repair", "bad.mcap", "bad.mcap", "--force")
        self.refuses("out/logs/run.mcap exists; give --force to write over it, or another place",
                     "log", "repair", "bad.mcap", "out/logs/run.mcap")


class Foreign(InFolder):
    def test_logs_are_told_of_but_are_no_runs(self):
        for name in ("foreign", "lz4", "zstd", "plain", "no_chunks", "no_index", "no_statistics"):
            log = FOREIGN / f"{name}.mcap"
            self.assertIn("whole       yes\n", self.ends(0, "log", "info", log))
            self.assertIn(str(log), self.ends(2, "replay", log))
            self.assertIn(str(log), self.ends(2, "report", log, "--out", "report"))
        self.assertIn(" is an MCAP file of '@mcap/core 2.2.2' and holds no recording of pliant\nits topics:\n",
                      self.ends(2, "export", FOREIGN / "foreign.mcap", "x.csv"))


class Export(InFolder):
    def setUp(self):
        super().setUp()
        self.log = self.run_short().relative_to(self.folder)

    def test_makes_columns_with_their_units(self):
        self.ends(0, "export", self.log, "a.csv", "--signal", "arm.position", "--signal", "arm.energy")
        lines = (self.folder / "a.csv").read_text().splitlines()
        self.assertEqual(len(lines), 102)
        self.assertTrue(lines[0].startswith("time (s),arm.position[joint_1] (rad),"))
        self.ends(0, "export", self.log, "all.csv")
        self.assertGreater(len((self.folder / "all.csv").read_text().split("\n")[0].split(",")), 100)

    def test_makes_hdf5(self):
        for name in ("a.h5", "b.hdf5"):
            self.ends(0, "export", self.log, name)
            self.assertEqual((self.folder / name).read_bytes()[:8], b"\x89HDF\r\n\x1a\n")

    def test_refuses_what_it_cannot_do_and_writes_nothing(self):
        kinds = "expected a file that ends in .h5, .hdf5 or .csv"
        self.write("there.csv", "mine")
        os.symlink("/dev/full", self.folder / "full.csv")
        for words, message in [
                (["a.txt"], f"a.txt: {kinds}"), (["a"], f"a: {kinds}"), ([".csv"], f".csv: {kinds}"),
                ([self.log, "--force"], f"{self.log}: {kinds}"),
                (["a.csv", "--signal", "arm.positon"],
                 "the recording has no signal 'arm.positon'; did you mean 'arm.position'?"),
                (["a.h5", "--signal", "arm.position"],
                 "--signal picks columns of a .csv; an HDF5 file gets all"),
                (["there.csv"], "there.csv exists; give --force to write over it, or another place"),
                (["full.csv", "--force"], "cannot write full.csv: it is there and not a file"),
                (["/proc/a.csv"], "cannot write /proc/a.csv: No such file or directory"),
                (["none/a.csv"], "cannot write none/a.csv: No such file or directory")]:
            self.refuses(message, "export", self.log, *words)
        self.ends(0, "export", self.log, "there.csv", "--force")


class Contacts(InFolder):
    def setUp(self):
        super().setUp()
        self.run_short()

    def contacts(self, *words):
        return ("log", "contacts", "out/logs/run.mcap", *words)

    def test_are_held_against_what_a_hand_bears(self):
        self.assertEqual(self.ends(0, *self.contacts("--signal", "push_1.force", "--body", "palm_nd", "--area-cm2", 1)),
                         "1 contact of push_1.force; transient 30.0 N of 280 N, 30.0 N/cm² of 520 N/cm²\n"
                         "within the limits of palm_nd (hands and fingers): yes\n"
                         "source: ISO/TS 15066:2016, table A.2; transient: the first half second\n")

    def test_that_pass_a_limit_end_with_1(self):
        done = self.pliant(*self.contacts("--signal", "push_1.force", "--body", "temple"))
        self.assertEqual(done.returncode, 1)
        self.assertIn("transient 30.0 N, where none is permitted\n", done.stdout)

    def test_that_are_none_are_named(self):
        self.assertIn("pliant: --body: there is no 'palm_n'; did you mean 'palm_d'?\n  known: middle_of_forehead, temple",
                      self.ends(2, *self.contacts("--signal", "push_1.force", "--body", "palm_n")))
        self.refuses("out/logs/run.mcap: arm.position has no force: expected a contact or a wrench, with elements "
                     "force[x], … or fx, …; it is a joint position",
                     *self.contacts("--signal", "arm.position", "--body", "palm_d"))
        self.refuses("--area-cm2 must be >= 0 cm², got -1",
                     *self.contacts("--signal", "push_1.force", "--body", "palm_d", "--area-cm2", "-1"))


if __name__ == "__main__":
    main()
