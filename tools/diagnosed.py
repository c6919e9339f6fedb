# One diagnosis by the built program, kept: what is there is not made again.
import pathlib
import subprocess


def answered(program, folder, answer, jobs=1, more=()):
    """Whether `answer` holds what `pneuservo diagnose` says of the config and recordings in `folder`; says why where it does not."""
    if answer.is_file():
        return True
    draft = answer.with_suffix(".draft.json")  # so that a run that was stopped leaves no half of an answer
    command = [program, "diagnose", folder / "rig.yaml", *sorted(pathlib.Path(folder).glob("recording-*.csv.gz")), "--json", draft, "--quiet",
               "--jobs", jobs, *more]
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        print(f"{folder.name}: no answer: {(done.stderr.strip().splitlines() or ['?'])[-1]}", flush=True)
        return False
    draft.rename(answer)
    return True
