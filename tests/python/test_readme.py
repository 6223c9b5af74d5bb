"""What the README tells people to type works."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import cohaul
import pytest

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w+)( test)?\n(.*?)^```$", README, flags=re.MULTILINE | re.DOTALL)


def blocks(language: str) -> list[str]:
    """Fenced blocks of a language that are marked to be run."""
    return [text for name, marked, text in BLOCKS if name == language and marked]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """What the README's commands find around them, to be written to freely."""
    shutil.copytree(ROOT / "scenarios", tmp_path / "scenarios")
    return tmp_path


def test_the_two_commands_are_make_demo_and_make_test() -> None:
    unmarked = [text.strip() for name, marked, text in BLOCKS if name == "sh" and not marked]
    assert unmarked == ["make demo", "make test"]
    assert set(re.findall(r"\bmake \w+", README)) == {"make demo", "make test"}


def test_numbers_come_from_the_report_that_the_command_wrote() -> None:
    report = (ROOT / "scenarios/r2p2/RESULTS.md").read_text(encoding="utf-8")
    summary = report.split("## Summary")[1].split("\n## ")[0].strip()
    assert README.split("<!-- results -->")[1].split("<!-- end of results -->")[0].strip() == summary
    rows = {row[0]: row for row in (re.split(r"\s*\|\s*", line.strip("| ")) for line in summary.splitlines()[2:])}
    for name in cohaul.experiments():
        # each with the command that wrote it, on the seeds of the report
        command = re.search(rf"`cohaul reproduce {name} --world planar --trials (\d+) --seed 9001`", report)
        assert command and rows[name][2] == command[1]


def test_ci_runs_the_command_of_the_readme() -> None:
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    assert re.findall(r"^ *make .*$", script, flags=re.MULTILINE) == ["make test"]


@pytest.mark.parametrize("block", blocks("sh"))
def test_commands_succeed(folder: Path, block: str) -> None:
    # the console script stands beside the interpreter that runs this
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    command = ["bash", "-euo", "pipefail", "-c", block]
    done = subprocess.run(command, cwd=folder, env={**os.environ, "PATH": path}, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    named = set(re.findall(r"\bout/\S+\.\w+", block))
    named |= {"out/flat.html", "out/flat.mcap"} if "run scenarios/r2p2/flat.yaml" in block else set()
    assert named
    for name in named:
        assert (folder / name).stat().st_size > (10_000 if name.endswith((".html", ".mcap")) else 100), name


@pytest.mark.parametrize("block", blocks("python"))
def test_python_runs(folder: Path, block: str) -> None:
    done = subprocess.run([sys.executable, "-c", block], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("reached ")


def test_every_link_leads_somewhere() -> None:
    links = [link for link in re.findall(r"\]\(([^)#]+)\)", README) if "://" not in link]
    assert [link for link in links if not (ROOT / link).exists()] == []


def test_every_subcommand_is_in_the_table() -> None:
    script = Path(sys.executable).parent / "cohaul"
    listing = subprocess.run([script, "--help"], capture_output=True, text=True, check=True).stdout
    commands = re.findall(r"^  (\w+)  ", listing.split("Commands:")[1], flags=re.MULTILINE)
    told = re.findall(r"^\| `cohaul (\w+)", README, flags=re.MULTILINE)
    assert sorted(told) == sorted(set(commands) - {"help"})
