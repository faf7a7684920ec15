# SPDX-License-Identifier: Apache-2.0
"""The mutated build: one build holds all mutants, switched; the others are compiled apart."""
import functools
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

import mutants as m

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
PROGRAMS = {
    "estimator": ["estimator_tests"],
    "hal": ["hal_tests", "device_tests", "link_tests", "back_end_tests",
            "libusb_tests", "session_log_tests"],
}
# What reads devices has its tests in the test bed of tests/hil, optimised as there.
BED_FILES = ["hal/src/usb/device_list.cpp", "hal/src/usb/hidapi_source.cpp", "hal/src/usb/libusb_source.cpp",
             "hal/src/usb/usb_device.cpp", "hal/src/usb/usb_device.h"]
BASE_FLAGS = ("-w -Wpedantic -DGTEST_HAS_PTHREAD=1 -DEIGEN_DONT_PARALLELIZE -DEIGEN_DONT_VECTORIZE "
              "-DEIGEN_MAX_STATIC_ALIGN_BYTES=0 -fno-tree-slp-vectorize -ffp-contract=off "
              "-fno-math-errno -std=c++20")


def write_if_other(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_bytes() != text:
        path.write_bytes(text)


def run(command, **more):
    return subprocess.run(command, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          errors="replace", **more)


def project_files():
    """All files of the project but those that git ignores."""
    names = run(["git", "-C", ROOT, "ls-files", "-co", "--exclude-standard"]).stdout.split("\n")
    return [ROOT / name for name in sorted(filter(None, names)) if (ROOT / name).is_file()]


class Build:
    def __init__(self, folder, jobs, programs):
        self.folder, self.jobs, self.programs = folder, jobs, programs
        self.tree, self.build = folder / "tree", folder / "build"
        self.all = m.sample(ROOT)
        self.apart_file = folder / "apart.txt"  # what a switch cannot hold, found by compiling
        self.apart = set()
        if self.apart_file.exists():
            self.apart = set(self.apart_file.read_text().split())

    def is_switched(self, mutant):
        return mutant.region is not None and mutant.id not in self.apart

    def prepare(self):
        """Builds the test programs with all mutants that a switch can hold."""
        self.texts = {str(path.relative_to(ROOT)): path.read_bytes() for path in project_files()}
        self._write_prefix()
        while True:
            for name, text in self.texts.items():
                write_if_other(self.tree / name, self.switched(name, text))
            if not (self.build / "build.ninja").exists():
                self._configure()
            print("building the test programs", flush=True)
            result = run(["ninja", "-C", self.build, f"-j{self.jobs}", "-k0", *self.programs])
            if result.returncode == 0:
                break
            self._put_apart(result.stdout)
        self._read_build()

    def switched(self, name, text, but=None):
        here = [x for x in self.all if x.path == name and self.is_switched(x) and x is not but]
        return m.with_switches(here[0].source, here).encode() if here else text

    def _write_prefix(self):
        include = self.folder / "include"
        for name in ("mutant_switch.h", "prefix.h"):
            write_if_other(include / name, (HERE / name).read_bytes())
        if not (include / "prefix.h.gch").exists():
            subprocess.run(["g++", *BASE_FLAGS.split(), "-O1", "-isystem", "/usr/include/eigen3",
                            "-x", "c++-header", include / "prefix.h", "-o",
                            include / "prefix.h.gch"], check=True)
        listener = self.folder / "listener.o"
        source = HERE / "reached_listener.cpp"
        if not listener.exists() or listener.stat().st_mtime < source.stat().st_mtime:
            subprocess.run(["g++", *BASE_FLAGS.split(), "-O1", f"-I{include}", "-c",
                            source, "-o", listener], check=True)

    def _configure(self):
        # Read by project(): not by CMake's own test of the compiler.
        settings = self.folder / "settings.cmake"
        settings.write_text(
            f'add_compile_options(-w -isystem /usr/include/eigen3 "SHELL:-include '
            f'{self.folder}/include/prefix.h")\n'
            "add_compile_definitions(GTEST_HAS_PTHREAD=1)\n"
            # Programs that tests start have no GoogleTest of their own.
            f'set(CMAKE_CXX_STANDARD_LIBRARIES "{self.folder}/listener.o -lgtest")\n')
        result = run(["cmake", "-S", self.tree, "-B", self.build, "-G", "Ninja",
                      "-DCMAKE_BUILD_TYPE=None", "-DCMAKE_CXX_FLAGS=-O1",
                      "-DCMAKE_CXX_COMPILER=g++", "-DCMAKE_UNITY_BUILD=OFF",
                      "-DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON",
                      "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON",
                      f"-DCMAKE_PROJECT_condyle_INCLUDE={settings}"])
        if result.returncode != 0:
            sys.exit(f"cannot configure the mutated build:\n{result.stdout}")

    def _put_apart(self, output):
        """The mutants on the lines that the compiler complains of."""
        prefix = re.escape(str(self.tree)) + r"/([\w/.]+):(\d+):\d+:"
        for pattern in (prefix + r" error", prefix):
            places = {(name, int(line)) for name, line in re.findall(pattern, output)}
            found = {x.id for x in self.all if self.is_switched(x) and any(
                (x.path, line) in places for line in self._lines(x))}
            if found:
                print(f"{len(found)} mutants cannot be switched", flush=True)
                self.apart |= found
                self.apart_file.write_text("\n".join(sorted(self.apart)) + "\n")
                return
        sys.exit(f"the mutated build fails:\n{output[-6000:]}")

    @staticmethod
    def _lines(mutant):
        tokens = mutant.source.tokens
        first = mutant.source.line_of(tokens[mutant.region.first].start)
        return range(first, mutant.source.line_of(tokens[mutant.region.last].end) + 1)

    # For mutants compiled apart.
    def _read_build(self):
        self.commands = {}
        for entry in json.loads((self.build / "compile_commands.json").read_text()):
            words = shlex.split(entry["command"])
            self.commands[words[words.index("-o") + 1]] = words
        self.files_of = {}
        for block in run(["ninja", "-C", self.build, "-t", "deps"]).stdout.split("\n\n"):
            lines = block.strip().split("\n")
            target = lines[0].split(":")[0]
            self.files_of[target] = {os.path.normpath(self.build / x.strip()) for x in lines[1:]}
        self.links = {}
        for program in self.programs:
            last = run(["ninja", "-C", self.build, "-t", "commands", program]).stdout
            last = [x for x in last.split("\n") if f"-o bin/{program} " in x][-1]
            last = last.split("&&")[1].strip() if last.startswith(": &&") else last
            self.links[program] = shlex.split(last)

    def including(self, path, program):
        """The object files of the program's tests that hold the file, the closest first."""
        whole = str(self.tree / path)
        stem = pathlib.Path(path).stem
        objects = [x for x in self.links[program] if x.endswith("_test.cpp.o")]
        objects = [x for x in objects if whole in self.files_of.get(x, ()) or path.endswith(".cpp")]

        def distance(name):
            test = pathlib.Path(name).name.replace("_test.cpp.o", "")
            common = set(test.split("_")) & set(stem.split("_"))
            return (test != stem, not test.startswith(stem), -len(common), test)
        return sorted(objects, key=distance)

    @functools.lru_cache(None)
    def members(self, program, test):
        """The object files of the libraries that a program of this one test file links."""
        output = run([*self._link(program, test, {}), "-o", os.devnull, "-Wl,-t,-t"],
                     cwd=self.build).stdout
        found = set()
        for archive, member in re.findall(r"(lib\w+)\.a\)?\(?(\w+\.cpp\.o)\)?", output):
            found |= {x for x in self.commands if f"/{archive[3:]}.dir/" in x
                      and x.endswith("/" + member)}
        return found

    def _link(self, program, test, replaced):
        words, own = [], []
        source = self.links[program]
        skip = False
        for word in source:
            if skip or word == "-o":
                skip = not skip
                continue
            if word.endswith("_test.cpp.o") and word != test:
                continue
            if word.endswith(".cpp.o"):
                own.append(word)
            words.append(replaced.get(word, word))
        first = next(i for i, x in enumerate(words) if x.endswith(".o"))
        libraries = [x for obj, x in replaced.items() if obj not in own]
        return words[:first] + libraries + words[first:]

    def compile_apart(self, mutant, program, test, place, done):
        """A program of one test file with the mutant in it; `done` keeps objects between calls.

        Returns the program's path, or None and the compiler's words.
        """
        changed = str(self.tree / mutant.path)
        wanted = [x for x in {test} | self.members(program, test)
                  if changed in self.files_of.get(x, ())
                  or self.commands[x][-1] == changed]
        for name in sorted(wanted):
            if name not in done:
                done[name] = str(place / f"{len(done)}.o")
                result = run(self._elsewhere(self.commands[name], place, done[name]), cwd=self.build)
                if result.returncode != 0:
                    return None, result.stdout
        replaced = {x: done[x] for x in wanted}
        path = self.build / "bin" / place.name  # beside the programs that tests run
        result = run([*self._link(program, test, replaced), "-o", path], cwd=self.build)
        return (path, "") if result.returncode == 0 else (None, result.stdout)

    def _elsewhere(self, words, place, output):
        """A compiler's command, with the mutated copies of estimator/ and hal/."""
        words = [x.replace(f"{self.tree}/estimator", f"{place}/estimator").replace(
            f"{self.tree}/hal", f"{place}/hal") for x in words]
        words[words.index("-o") + 1] = output
        return words

    def write_apart(self, mutant, place):
        """Copies of estimator/ and hal/ with this mutant as text and the others switched."""
        shutil.rmtree(place, ignore_errors=True)
        for name, text in self.texts.items():
            if name.startswith(("estimator/", "hal/")):
                if name == mutant.path:
                    text = m.with_mutant(mutant.source.text, mutant).encode()
                else:
                    text = self.switched(name, text)
                write_if_other(place / name, text)

    # Trivial compiler equivalence: the same object files, optimised, as without the mutant.
    def is_equivalent(self, mutant, place):
        changed = str(self.tree / mutant.path)
        objects = []
        for program in PROGRAMS[mutant.folder]:
            tests = self.including(mutant.path, program)
            libraries = [x for x in self.commands if x.startswith(("estimator/", "hal/"))]
            for name in libraries + tests:
                if (changed in self.files_of.get(name, ()) or self.commands[name][-1] == changed) \
                        and name not in objects:
                    objects.append(name)
        if not objects:
            return False
        shutil.rmtree(place, ignore_errors=True)
        for name, text in self.texts.items():
            if name.startswith(("estimator/", "hal/")):
                write_if_other(place / name, text)
        for name in objects:
            pair = []
            for text in (self.texts[mutant.path], m.with_mutant(mutant.source.text, mutant).encode()):
                (place / mutant.path).write_bytes(text)
                words = self._elsewhere(self.commands[name], place, str(place / "object.o"))
                words = ["-O2" if x == "-O1" else x for x in words]
                at = words.index("-include")
                words[at:at + 2] = []
                if run(words, cwd=self.build).returncode != 0:
                    return False
                pair.append((place / "object.o").read_bytes())
            if pair[0] != pair[1]:
                return False
        return True

    # The test bed: a build as users have it, in which the readers of devices alone hold mutants.
    def prepare_bed(self):
        self.bed = self.folder / "bed"
        for name, text in self.texts.items():
            if name in BED_FILES:
                text = self._bed_text(name, self.switched(name, text))
            elif name == "hal/CMakeLists.txt":
                readers = " ".join(x[len("hal/"):] for x in BED_FILES if x.endswith(".cpp"))
                text += f"set_source_files_properties({readers} PROPERTIES COMPILE_OPTIONS -w)\n".encode()
            write_if_other(self.bed / name, text)
        write_if_other(self.bed / "hal/src/mutant_switch.h", (HERE / "mutant_switch.h").read_bytes())
        build = self.bed / "build/release"
        if not (build / "build.ninja").exists():
            result = run(["cmake", "--preset", "release", "-DCMAKE_UNITY_BUILD=OFF",
                          "-DCONDYLE_BUILD_BOX=OFF"], cwd=self.bed)
            if result.returncode != 0:
                raise RuntimeError(f"cannot configure the test bed:\n{result.stdout[-3000:]}")
        print("building the test bed", flush=True)
        result = run(["ninja", "-C", build, f"-j{self.jobs}", "hil_tests"])
        if result.returncode != 0:
            raise RuntimeError(f"the test bed fails:\n{result.stdout[-3000:]}")
        return build / "bin/hil_tests"

    @staticmethod
    def _bed_text(name, text):
        return b'#include "mutant_switch.h"\n' + text if name.endswith(".cpp") else text

    def put_in_bed(self, mutant):
        """Builds the reader with this mutant as text, or, with None, without."""
        for name in BED_FILES:
            if mutant is not None and name == mutant.path:
                text = m.with_mutant(mutant.source.text, mutant).encode()
            else:
                text = self.switched(name, self.texts[name])
            write_if_other(self.bed / name, self._bed_text(name, text))
        return run(["ninja", "-C", self.bed / "build/release", "read_reports"]).returncode == 0
