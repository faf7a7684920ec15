# SPDX-License-Identifier: Apache-2.0
"""What is mutated: files of the project, of its fuzzers, and of `condyle simulate`; and the commands
that read them. {} stands for the mutated file, OUT/ for the folder that holds what is written."""
import glob
import os
import re
import subprocess
from collections import namedtuple

import captures
from mcap import Log, pieces

Target = namedtuple("Target", "name ending is_text seeds commands parts tame")
SHORT_SESSION = (b"[kinematic]\n[rest]\nduration_s = 1\n[opening]\nstrokes = 1\n"
                 b"[chewing]\nduration_s = 3\n[facebow]\nrate_Hz = 60\n")
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


def read(path, limit=None):
    with open(path if os.path.isabs(path) else os.path.join(ROOT, path), "rb") as file:
        return file.read(limit)


def after_choice(path):
    """A seed of a fuzzer whose first byte chooses options, without that byte."""
    return read(path)[1:]


def rows(data, count):
    return b"\n".join(data.split(b"\n")[:count]) + b"\n"


def simulated(condyle, scenario, folder):
    """The recording of a scenario and what is written beside it, by its ending."""
    out = os.path.join(folder, os.path.basename(scenario)[:-5])
    subprocess.run([condyle, "simulate", os.path.join(ROOT, scenario), "--out", f"{out}.csv",
                    "--truth", f"{out}.truth.csv"], check=True, stdout=subprocess.DEVNULL)
    return out


def jaws3d(seed):
    return seed + b"".join(b"%.3f %d %d %d\n" % (0.015 * i, i, 2 * i % 7, i * i % 11)
                           for i in range(2, 40))


def targets(condyle, box, folder, log):
    """`folder`: for what is made here; `log`: a session log of the box."""
    fuzz = "tests/fuzz/seeds/"
    muscle_driven = simulated(condyle, "host_sim/scenarios/free_opening.toml", folder)
    point = simulated(condyle, "host_sim/scenarios/point_mass.toml", folder)
    chewing = rows(read("host_sim/recordings/chewing_60hz.csv"), 400)
    axis = [chewing, after_choice(fuzz + "recording/axis_csv"), rows(read(point + ".csv"), 400)]
    points = [rows(read(muscle_driven + ".csv"), 200), after_choice(fuzz + "recording/points_csv")]
    plain = os.path.join(folder, "plain.csv")
    with open(plain, "wb") as file:
        file.write(rows(read(point + ".csv"), 900))
    body = os.path.join(folder, "body.csv")
    with open(body, "wb") as file:
        file.write(rows(read(muscle_driven + ".csv"), 900))
    drive = rows(read(point + ".drive.csv"), 900)
    muscles = read("host_sim/muscles/artisynth.toml")
    emg_file = os.path.join(folder, "emg.csv")
    emg = made_emg(muscles)
    with open(emg_file, "wb") as file:
        file.write(emg)
    head = b"time_s,acceleration_m_s2\n" + b"".join(
        b"%.3f,%.3f\n" % (i / 60, 3 * ((i % 30) / 15 - 1)) for i in range(600))
    facebow = os.path.join(ROOT, "hal/profiles/condyle_facebow.toml")
    muscles_file = os.path.join(ROOT, "host_sim/muscles/artisynth.toml")
    capture = os.path.join(folder, "capture.pcap")
    session = read(log)
    reports = Log(log).reports[:40]
    mapped = captures.USB_LINUX_MMAPPED
    with open(capture, "wb") as file:
        file.write(captures.pcap(reports))
    logs = [session, after_choice(fuzz + "session_log/complete"), after_choice(fuzz + "session_log/cut")]
    parts = [whole for whole in (list(pieces(one)) for one in logs[:2]) if whole]
    scenarios = [read(one) for one in sorted(glob.glob(os.path.join(ROOT, "host_sim/scenarios/*.toml")))]
    short = [short_scenario(one) for one in scenarios]
    kinematic = [one for one in short if b"[kinematic]" in one]
    session_file = os.path.join(folder, "tasks.toml")
    with open(session_file, "wb") as file:
        file.write(SHORT_SESSION)
    tasks = simulated(condyle, session_file, folder)
    analyse = [condyle, "analyse", tasks + ".csv", "--no-figures", "--out", "OUT/readings"]
    replay = [condyle, "replay", "{}"]
    out = ["--out", "OUT/out.csv"]

    def group(name, *endings):
        return [read(fuzz + name + "/" + one) for one in endings]

    def chosen(name, *endings):
        return [after_choice(fuzz + name + "/" + one) for one in endings]

    def target(name, ending, is_text, seeds, *commands, parts=None, tame=lambda data: data):
        return Target(name, ending, is_text, seeds, [list(one) for one in commands], parts, tame)

    pcaps = [captures.pcap(reports), captures.pcap(reports, ">", mapped)] + chosen("capture", "pcap")
    pcapngs = ([captures.pcapng(reports), captures.pcapng(reports, ">", mapped)] +
               chosen("capture", "pcapng"))
    descriptors = group("descriptor", "odd", "three_axes", "usage_zero", "vendor")
    return [
        target("CSV, one axis", ".csv", True, axis, replay + out,
               replay + out + ["--faults", "event"], replay + out + ["--estimator", "published"]),
        target("CSV, three points", ".csv", True, points, replay + out, replay + out + ["--lag", "3"],
               replay + out + ["--jaw-point-mm", "1", "2", "3", "--faults", "event"]),
        target("CSV, compare and tune", ".csv", True, axis[:1],
               [condyle, "compare", "{}", "--out", "OUT/out.csv"],
               [condyle, "tune", "{}", "--out", "OUT/out.toml", "--starts", "2"]),
        target("CSV of a drive", ".csv", True, [drive],
               [condyle, "replay", plain, "--drive", "{}", "--drive-missing", "0"] + out),
        target("CSV of EMG", ".csv", True, [emg], [condyle, "protocol", "emg", body, "--emg", "{}",
                                                   "--muscles", muscles_file, "--out", "OUT/out.json"]),
        target("CSV of the head", ".csv", True, [head],
               [condyle, "protocol", "head-motion", plain, "--acceleration", "{}", "--muscle-share",
                "0", "--out", "OUT/out.json"]),
        target("muscle file", ".toml", True, [muscles],
               [condyle, "protocol", "emg", body, "--emg", emg_file, "--muscles", "{}", "--out",
                "OUT/out.csv"]),
        target("ArtiSynth probe text", ".txt", True, chosen("recording", "probe_text"), replay + out),
        target("probe text with times", ".txt", True, [jaws3d(chosen("recording", "probe_text_times")[0])],
               replay + out),
        target("Zebris XML", ".xml", True, chosen("recording", "zebris_xml"),
               replay + out + ["--unit", "mm"]),
        target("SSFF", ".ssff", False, chosen("recording", "ssff"), replay + out),
        target("C3D", ".c3d", False, chosen("recording", "c3d_dec_integer", "c3d_intel_float",
                                            "c3d_mips_float"), replay + out),
        target("MAT", ".mat", False, chosen("recording", "mat_compressed", "mat_mview", "mat_plain",
                                            "mat_qualisys", "mat_struct"), replay + out),
        target("XDF", ".xdf", False, chosen("recording", "xdf_rate", "xdf_stamps"), replay + out),
        target("text of instruments", ".txt", True,
               chosen("recording", "carstens_pos", "motive_csv", "named_points_csv", "ndi_text",
                      "qualisys_tsv", "semicolons_csv", "titles_csv", "trc", "utf16_csv", "vicon_csv"),
               replay + out),
        target("MCAP, as it comes", ".mcap", False, logs, replay + out,
               replay + out + ["--values", "OUT/values"]),
        target("MCAP, checksums right", ".mcap", False, logs, replay + out, parts=parts),
        target("pcap", ".pcap", False, pcaps, replay + out + ["--profile", facebow]),
        target("pcapng", ".pcapng", False, pcapngs, replay + out + ["--profile", facebow]),
        target("profile", ".toml", True, group("profile", "condyle_facebow.toml", "pose.toml",
                                               "self_describing_3_axis.toml"),
               [condyle, "replay", capture, "--profile", "{}"] + out),
        target("parameters, recommended", ".toml", True, group("parameters", "recommended.toml"),
               [condyle, "replay", plain, "--parameters", "{}"] + out),
        target("parameters, published", ".toml", True, group("parameters", "shipped.toml"),
               [condyle, "replay", plain, "--estimator", "published", "--parameters", "{}"] + out),
        target("landmarks", ".toml", True, [read(tasks + ".landmarks.toml")],
               analyse + ["--landmarks", "{}"]),
        target("CSV of tasks", ".csv", True, [read(tasks + ".tasks.csv")], analyse + ["--tasks", "{}"]),
        *(target(name, ".toml", True, of_kind, [condyle, "simulate", "{}", "--out", "OUT/out.csv",
                                                "--truth", "OUT/truth.csv"], tame=not_long)
          for name, of_kind in (("scenario, kinematic", kinematic),
                                ("scenario", [one for one in short if one not in kinematic]))),
        target("report descriptor", ".bin", False, descriptors,
               [condyle, "inspect", "--descriptor", "{}"],
               [condyle, "inspect", "--descriptor", "{}", "--json"]),
        target("box.toml", ".toml", True, [read("firmware/box/box.toml"), full_box(),
                                           box_with_pose()],
               [box, "--config", "{}", "--check"]),
    ]


def made_emg(muscles):
    """As `condyle simulate` names the columns."""
    names = [line[len(b"[muscles."):-1] for line in muscles.split(b"\n")
             if line.startswith(b"[muscles.")]
    head = b"".join(b"," + name + b"_envelope" for name in names)
    return b"time_s" + head + b"\n" + b"".join(
        b"%.3f" % (i / 60) + b",0.25" * (len(names) - 1) + b",%.2f\n" % (i % 10 / 20)
        for i in range(900))


def short_scenario(text):
    """A second of it: the mutator needs its words, not its length."""
    text = re.sub(rb"(?m)^duration_s.*$", b"duration_s = 1", text)
    return text.replace(b"[chewing]\nduration_s = 1", b"[chewing]\nduration_s = 8")  # some cycles


def not_long(text):
    """A mutated scenario; one of hours takes the time that it asks for, so it gets 100 s or 6 strokes."""
    def shortened(match):
        most = b"6" if b"strokes" in match[1] else b"100"
        try:
            return match[1] + most if float(match[2]) > float(most) else match[0]
        except ValueError:
            return match[0]
    return re.sub(rb"(?m)^(\s*(?:duration_s|strokes)\s*=\s*)([-+\w.]+)", shortened, text)


def full_box():
    return (b'[facebow]\nsource = "synth:a.toml"\nserial = ""\npoint = 1\naxis = "z"\n'
            b'[companion.force]\nsource = "hid:force.toml"\n[estimator]\nparameters = ""\n'
            b'lag_samples = 0\nnode = "unix:s"\nnode_baud = 1000000\nnode_late_ms = 100\n'
            b'priority = 50\n[recording]\nfolder = "."\nreserve_MB = 256\n[udp]\n'
            b'address = "127.0.0.1"\nport = 0\n[http]\naddress = "::1"\nport = 8750\n'
            b'token_file = ""\nmost_listeners = 16\n')


def box_with_pose():
    return (b'[facebow]\nsource = "lsl:jaw@127.0.0.1"\nchannels = "jaw_x, jaw_y, jaw_z"\nunit = "mm"\n'
            b'[pose]\nestimate = true\ntwist_axis = "x"\n[jaw_point.incisor]\n'
            b'position_mm = [0, 80, -30]\n[cycles]\nfind = true\nclosing = "positive"\n[lsl]\n'
            b'name = "condyle"\naddress = "127.0.0.1"\n')
