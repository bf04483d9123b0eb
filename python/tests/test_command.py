"""The program within the package: output, files and exit codes are the program's."""

import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time

import pytest

import arclen

PROGRAM = os.environ.get("ARCLEN") and shutil.which(os.environ["ARCLEN"])
MODULE = [sys.executable, "-m", "arclen"]
LONG = ["--set", "path.max_step=1e-5", "--set", "path.max_points=1000000", "--no-pictures"]


def run(command, **options):
    return subprocess.run(command, capture_output=True, text=True, timeout=120, **options)


def test_the_installed_command_is_the_program(tmp_path):
    script = pathlib.Path(sys.executable).with_name("arclen")
    said = run([script, "--version"])
    assert (said.returncode, said.stdout) == (0, f"arclen {arclen.__version__}\n")
    said = run([*MODULE, "trace", "fig12", "--elements", "80", "--out", "o"], cwd=tmp_path)
    assert said.returncode == 0 and "fold" in said.stdout, said.stderr
    assert arclen.CaseBranch.load(tmp_path / "o") == arclen.trace("fig12", elements=80)


def test_exit_codes(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert arclen.main(["check", "fig12"]) == 0
    assert arclen.main(["trace", "fig13"]) == 2
    assert arclen.main([]) == 2
    assert arclen.main(["trace", "fig12", "--set", "path.max_points=5", "--no-pictures"]) == 3
    assert (tmp_path / "arclen-out/fig12/branch.csv").exists()
    with pytest.raises(TypeError):
        arclen.main("trace fig12")
    with pytest.raises(TypeError):
        arclen.main([3])


COMMANDS = [
    ["list"],
    ["check", "fig12", "--set", "path.end=0.9"],
    ["trace", "fig13"],
    ["trace", "bratu", "--json"],
    ["cycle", "fig12", "--elements", "60", "--json", "--quiet"],
    ["map", "fig12", "--over", "nothing"],
    ["figure", "8"],
    ["completions", "bash"],
    ["fit", "missing.csv"],
    ["--help"],
]


@pytest.mark.skipif(not PROGRAM, reason="ARCLEN is not the path of the program")
@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_the_program_says_the_same(words, tmp_path):
    def told(command):
        said = run([*command, *words], cwd=tmp_path)
        lines = [line for line in said.stdout.splitlines() if '"seconds"' not in line]
        return said.returncode, lines, re.sub(r"[\d.]+ s$", "", said.stderr, flags=re.MULTILINE)

    assert told(MODULE) == told([PROGRAM])


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_signals_keep_what_was_computed(name, tmp_path):
    words = ["trace", "fig12", "--elements", "100", *LONG, "--out", "o"]
    process = subprocess.Popen([*MODULE, *words], cwd=tmp_path, stdout=subprocess.DEVNULL)
    time.sleep(2)
    for _ in range(2):  # two at once are one request
        process.send_signal(getattr(signal, name))
    assert process.wait(60) == 3
    branch = arclen.CaseBranch.load(tmp_path / "o")
    assert branch.stopped_because == "interrupted" and len(branch) > 1


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
def test_the_interpreter_keeps_its_signals(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    before = signal.getsignal(signal.SIGINT)
    assert arclen.main(["trace", "bratu", "--quiet", "--no-pictures"]) == 0
    assert signal.getsignal(signal.SIGINT) is before
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)
        time.sleep(1)


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
def test_ctrl_c_stops_a_command_of_a_session(tmp_path):
    script = f"""
import os, signal, threading, time, arclen
threading.Timer(1.0, os.kill, (os.getpid(), signal.SIGINT)).start()
print(arclen.main({["trace", "fig12", "--quiet", *LONG]!r}), flush=True)
threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT)).start()
try:
    time.sleep(5)
except KeyboardInterrupt:
    print("as ever")
"""
    said = run([sys.executable, "-c", script], cwd=tmp_path)
    assert said.stdout == "3\nas ever\n", said.stderr
