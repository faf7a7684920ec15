# SPDX-License-Identifier: Apache-2.0
"""Mutants of the sources of estimator/ and hal/, and the fixed sample of them."""
import hashlib
import pathlib
import re
import sys
from collections import Counter

from cpp_source import Source

FOLDERS = {"estimator": ("estimator/include",), "hal": ("hal/include", "hal/src")}
KINDS = ("arithmetic", "condition", "constant", "statement")
PER_KIND = 25  # of each folder: 2 folders x 4 kinds x 25 = 200
SEED = "condyle 1"

ARITHMETIC = {"+": "-", "-": "+", "*": "/", "/": "*",
              "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*="}
CONDITION = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "&&": "||",
             "||": "&&"}


class Mutant:
    def __init__(self, path, source, kind, first, last, replacement):
        self.path, self.source, self.kind = path, source, kind
        self.first, self.last, self.replacement = first, last, replacement
        self.start, self.end = source.tokens[first].start, source.tokens[last].end
        self.original = source.slice(first, last)
        self.line = source.line_of(self.start)
        self.region = self._innermost_region()
        self.id, self.folder, self.number = "", "", 0  # given when it is drawn

    def _innermost_region(self):
        holding = [r for r in self.source.regions if r.first <= self.first and self.last <= r.last]
        if not holding:
            return None
        return max(holding, key=lambda r: r.first)

    def place(self):
        """What identifies the mutant; edits elsewhere in the file, or its move, leave it as it is."""
        text = self.source.line_text(self.start)
        column = self.start - (self.source.text.rfind("\n", 0, self.start) + 1)
        before = text[:column].strip()
        return "|".join((pathlib.Path(self.path).name, self.kind, text.strip(), before, self.original, self.replacement))

    def text_of_region(self):
        """The region's text with the mutant in it."""
        source, region = self.source, self.region
        before = source.slice(region.first, self.first - 1) if self.first > region.first else ""
        after = source.slice(self.last + 1, region.last) if self.last < region.last else ""
        return f"{before} {self.replacement} {after}"

    def describe(self):
        return f"{self.path}:{self.line}: {self.original} -> {self.replacement or '(dropped)'}"


def other_number(text):
    """Another value of a literal: 0 and 1 of each other, integers one more, fractions twice."""
    match = re.fullmatch(r"(0[xX][\da-fA-F']+|0[bB][01']+|[\d']+)([uUlLzZ]*)", text)
    if not match:
        return f"({text} * 2)" if float_value(text) != 0 else text.replace("0.0", "1.0", 1)
    digits, suffix = match[1].replace("'", ""), match[2]
    value = int(digits, 8 if re.fullmatch("0[0-7]+", digits) else 0)
    if value in (0, 1):
        return f"{1 - value}{suffix}"
    return (hex(value + 1) if digits[:2] in ("0x", "0X") else str(value + 1)) + suffix


def joins_text(source, i):
    """Whether the + stands among texts: there - is not C++."""
    here = [r for r in source.regions if r.first <= i <= r.last]
    region = max(here, key=lambda r: r.first) if here else None
    return region and any(t.kind in ("string", "char") or "string" in t.text or "text" in t.text
                          for t in source.tokens[region.first:region.last])


def float_value(text):
    text = text.rstrip("fFlL").replace("'", "")
    return float.fromhex(text) if text[:2] in ("0x", "0X") else float(text)


def mutants_of(path, text):
    source = Source(text)
    tokens = source.tokens
    for i, token in enumerate(tokens):
        if token.in_angles or token.left_out or i == 0 or tokens[i - 1].text == "operator":
            continue
        if token.kind == "operator" and token.spaced:
            for kind, table in (("arithmetic", ARITHMETIC), ("condition", CONDITION)):
                if token.text in table and not (token.text in ("+", "+=") and joins_text(source, i)):
                    yield Mutant(path, source, kind, i, i, table[token.text])
        elif token.kind == "number" and not (tokens[i - 1].text == "=" and tokens[i - 2].text in (
                ")", "const", "noexcept", "override")):  # = 0: pure virtual
            yield Mutant(path, source, "constant", i, i, other_number(token.text))
    for first, last in source.conditions:
        yield Mutant(path, source, "condition", first, last, f"!({source.slice(first, last)})")
    for first, last in source.droppable:
        yield Mutant(path, source, "statement", first, last, "")


def read_mutants(path, text):
    try:
        return sorted(mutants_of(path, text), key=lambda m: m.start)
    except (IndexError, TypeError) as error:
        raise SystemExit(f"{path} cannot be read: teach cpp_source.py the statement ({error})") from error


def all_mutants(root):
    seen = Counter()
    for folder, parts in FOLDERS.items():
        for part in parts:
            for file in sorted(pathlib.Path(root, part).rglob("*")):
                if file.suffix in (".h", ".cpp"):
                    path = str(file.relative_to(root))
                    for mutant in read_mutants(path, file.read_text()):
                        place = mutant.place()
                        seen[place] += 1
                        key = f"{SEED}|{place}|{seen[place]}"
                        mutant.id = hashlib.sha256(key.encode()).hexdigest()[:10]
                        mutant.folder = folder
                        yield mutant


def sample(root):
    mutants = sorted(all_mutants(root), key=lambda m: m.id)
    drawn = []
    for folder in FOLDERS:
        for kind in KINDS:
            drawn += [m for m in mutants if m.folder == folder and m.kind == kind][:PER_KIND]
    for number, mutant in enumerate(drawn, 1):
        mutant.number = number
    return drawn


def with_mutant(text, mutant):
    """`text`, mutated; dropped statements keep their lines."""
    old = text[mutant.start:mutant.end]
    lines = "\n" * old.count("\n")
    return text[:mutant.start] + (mutant.replacement or ";") + lines + text[mutant.end:]


def with_switches(source, mutants):
    """The text of `source` that holds all `mutants` at once: the process's environment chooses one.

    Only insertions: each variant of a region stands before it, so that regions may lie in regions,
    and lines keep their numbers.
    """
    regions = {}
    for mutant in mutants:
        regions.setdefault((mutant.region.first, mutant.region.last), []).append(mutant)
    insertions = []  # (position, order, text)
    for (first, last), here in regions.items():
        before, after = switch_of(here[0].region, here)
        length = last - first
        insertions.append((source.tokens[first].start, 1, -length, before))
        insertions.append((source.tokens[last].end, 0, length, after))
    text, position = "", 0
    for at, _, _, inserted in sorted(insertions):
        text += source.text[position:at] + inserted
        position = at
    return text + source.text[position:]


def switch_of(region, mutants):
    chosen = [(f"condyle_mutation::is_chosen({m.number})", m.text_of_region()) for m in mutants]
    if region.form == "statement":
        return ("{ " + "".join(f"if ({c}) {{ {t}; }} else " for c, t in chosen) + "{ ", " } }")
    cast = {"condition": "static_cast<bool>", "step": "static_cast<void>"}.get(
        region.form, f"static_cast<{region.cast}>" if region.cast else "")
    if mutants[0].source.tokens[region.first].text == "{":
        cast = region.cast
        return ("".join(f"{c} ? {cast}{t} : " for c, t in chosen) + cast, "")
    return ("(" + "".join(f"{c} ? {cast}({t}) : " for c, t in chosen) + f"{cast}(", "))")


def main():
    root = sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parents[2]
    for mutant in sample(root):
        form = mutant.region.form if mutant.region else "apart"
        print(mutant.id, mutant.kind, form, mutant.describe(), sep="\t")


if __name__ == "__main__":
    main()
