# Runs the scenarios inside the guest and writes what they found to the share: outcome and seconds of each, and figures.
import json, os, sys, time, unittest

import guest_tools

SHARE = "/share"


class Result(unittest.TextTestResult):
    """Keeps, for each test, how it went and how long it took on the guest's clock."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.outcomes = []

    def startTest(self, test):
        self.began = time.monotonic()
        super().startTest(test)

    def note(self, test, outcome, why=""):
        self.outcomes.append({"name": test.id(), "outcome": outcome, "guest_s": round(time.monotonic() - self.began, 2), "why": why})
        print(f"{outcome}: {test.id()} ({self.outcomes[-1]['guest_s']} s)\n{why}", flush=True)

    def addSuccess(self, test):
        super().addSuccess(test)
        self.note(test, "passed")

    def addFailure(self, test, error):
        super().addFailure(test, error)
        self.note(test, "FAILED", self.failures[-1][1])

    def addError(self, test, error):
        super().addError(test, error)
        self.note(test, "FAILED", self.errors[-1][1])

    def addSkip(self, test, reason):
        super().addSkip(test, reason)
        self.note(test, "skipped", reason)


def main():
    with open(os.path.join(SHARE, "plan.json")) as file:
        guest_tools.plan.update(json.load(file))
    names = guest_tools.plan["scenarios"]
    suite = unittest.TestSuite(unittest.defaultTestLoader.loadTestsFromName(name) for name in names)
    result = unittest.TextTestRunner(stream=sys.stdout, resultclass=Result, verbosity=0).run(suite)
    with open(os.path.join(SHARE, "results.json"), "w") as file:
        json.dump({"kernel": os.uname().release, "version": os.uname().version, "tests": result.outcomes,
                   "figures": guest_tools.figures}, file, indent=1)
    return 0 if result.wasSuccessful() and result.testsRun > 0 else 1


sys.exit(main())
