# The wheel around the built module: installed in a folder of its own it is the package, without the build's folder.
import os
import pathlib
import subprocess
import sys

import pneuservo

SOURCE = pathlib.Path(__file__).resolve().parents[2]


def test_an_installed_wheel_is_the_package(tmp_path):
    module = pathlib.Path(pneuservo._core.__file__)
    subprocess.run([sys.executable, "-m", "pip", "wheel", "-q", SOURCE, "--no-deps", "--no-build-isolation", "-w", tmp_path,
                    "-C", f"build-dir={tmp_path}/build", "-C", f"cmake.define.PNEUSERVO_PYTHON_MODULE={module}"], check=True)
    wheel, = tmp_path.glob("*.whl")
    assert wheel.stat().st_size < 5e6
    installed = tmp_path / "installed"
    subprocess.run([sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--no-index", "--target", installed, wheel], check=True)
    code = f"import pneuservo as p; print(p.__file__); print(p.Config({str(SOURCE / 'config/cylinder-10m-7.65mm.yaml')!r}).period_s)"
    out = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=True, capture_output=True, text=True,
                         env={**os.environ, "PYTHONPATH": str(installed)}).stdout.split()
    assert out == [str(installed / "pneuservo/__init__.py"), "0.001"]
    assert (installed / "pneuservo/_core.pyi").exists()


def test_the_module_for_newer_processors_is_taken_where_it_is_there_and_runs(tmp_path, monkeypatch):
    from pneuservo import _processor

    assert _processor.folders(str(tmp_path)) == [str(tmp_path)]
    newer = tmp_path / "x86-64-v3"
    newer.mkdir()
    monkeypatch.setattr(_processor, "_flags", lambda: _processor._V3 | {"sse2"})
    assert _processor.folders(str(tmp_path)) == [str(newer), str(tmp_path)]
    monkeypatch.setattr(_processor, "_flags", lambda: _processor._V3 - {"avx2"})
    assert _processor.folders(str(tmp_path)) == [str(tmp_path)]
