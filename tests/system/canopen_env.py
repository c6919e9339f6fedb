# An environment that has python-canopen, made in the build folder once; a script that needs it starts again there.
import fcntl, os, shutil, subprocess, sys

CANOPEN = ["canopen==2.4.1", "python-can==4.6.1"]


def with_canopen():
    try:
        import canopen, can  # noqa: F401
        return
    except ImportError:
        pass
    folder = os.path.join(os.path.abspath(sys.argv[1]), "tools", "canopen-2.4.1")
    python = os.path.join(folder, "bin", "python")
    if "PNEUSERVO_CANOPEN_TRIED" not in os.environ:
        os.makedirs(os.path.dirname(folder), exist_ok=True)
        with open(folder + ".lock", "w", encoding="ascii") as lock:  # two tests may come at once
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not os.path.exists(python):
                made = subprocess.run([sys.executable, "-m", "venv", folder], check=False).returncode == 0
                if not made or subprocess.run([python, "-m", "pip", "install", "-q", *CANOPEN], check=False).returncode != 0:
                    shutil.rmtree(folder, ignore_errors=True)  # the next run tries again
        if os.path.exists(python):
            os.execve(python, [python, *sys.argv], {**os.environ, "PNEUSERVO_CANOPEN_TRIED": "1"})
    print("SKIPPED: python-canopen is not here and cannot be installed from PyPI")
    sys.exit(77)
