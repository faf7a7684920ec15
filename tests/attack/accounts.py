# SPDX-License-Identifier: Apache-2.0
"""Is every report of a session in its logs, or counted?"""
import os
import subprocess

from mcap import Log


def problems(session, files):
    """`session`: of the status, after the session; `files`: its logs that are there."""
    found = []
    received, written = session["reports_received"], session["reports_written"]
    lost, paused = session["reports_lost"], session["reports_in_pauses"]
    if received != written + lost + paused:
        found.append(f"received {received}, but {written} written, {lost} lost, {paused} in pauses")
    if received == 0:
        found.append("nothing was received")
    recorded = 0
    for file in files:
        log = Log(file)
        recorded += len(log.counters)
        if log.missing() != log.not_recorded:
            found.append(f"{os.path.basename(file)}: {log.missing()} reports are missing, "
                         f"{log.not_recorded} are said to be")
    if recorded != written:
        found.append(f"{written} reports written, but {recorded} in the logs")
    return found


def replay_problems(build, files):
    found = []
    for file in files:
        run = subprocess.run([os.path.join(build, "bin/condyle"), "replay", file],
                             stdin=subprocess.DEVNULL, capture_output=True, text=True)
        # A log that was cut before its first report has no samples.
        if run.returncode == 2 and not Log(file).counters:
            continue
        if run.returncode != 0:
            found.append(f"replay of {os.path.basename(file)}: exit {run.returncode}: {run.stderr}")
    return found
