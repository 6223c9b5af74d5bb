"""What a killed process leaves can be used."""

import random
import signal
import subprocess
import time
from pathlib import Path

import pytest
from example_log import example, recover_log
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

# what may be lost, messages: the promise to users; the writer flushes every 64
LOSS_LIMIT = 100


def kill_after(command: list[str | Path], *, seconds: float) -> int:
    """Runs a program that prints how many messages it has written; the last count before SIGKILL."""
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    first = process.stdout.readline()
    end = time.monotonic() + seconds
    last = int(first)
    # drain while it runs: a full pipe would stop it at a harmless place
    for line in process.stdout:
        last = int(line)
        if time.monotonic() > end:
            break
    process.send_signal(signal.SIGKILL)
    rest = [line for line in process.stdout if line.endswith("\n")]
    assert process.wait() == -signal.SIGKILL
    return int(rest[-1]) if rest else last


def count_messages(log: Path) -> int:
    """Messages of a whole log by its summary; those of one topic are decoded to see that they can be."""
    with log.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        assert all(decoded.robot == 0 for *_, decoded in reader.iter_decoded_messages(topics=["/r0/memory"]))
        return reader.get_summary().statistics.message_count


@pytest.mark.parametrize("seed", range(12))
def test_a_killed_writer_loses_at_most_100_messages(tmp_path: Path, seed: int) -> None:
    log, saved = tmp_path / "killed.mcap", tmp_path / "saved.mcap"
    delay = random.Random(seed).uniform(0.0, 1.0)
    # far more than it has time for: up to a million messages
    written = kill_after([example("write_log"), log, "1000000000", "--progress"], seconds=delay)
    report = recover_log(log, saved)
    recovered = int(report["messages"])
    assert report["reason"] != "none"
    assert report["missing"] == "0"
    assert written - recovered <= LOSS_LIMIT
    assert count_messages(saved) == recovered
    print(f"written {written}, recovered {recovered}")
    # pytest keeps the folders of its last runs
    log.unlink()
    saved.unlink()
