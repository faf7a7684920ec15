# SPDX-License-Identifier: Apache-2.0
"""What the programs that drive pages find."""
import os
import subprocess

AXE = ("axe-core@4.14.1", "1477dafa598d8d065f273d6af302aa203c02e83131707b7fa648cd41bd3d6b734f8c22a0dab8"
       "6ee6a6f64b8afbe804b214d36db85a2826965edfb3a0b9d546b5")
TREE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


class Findings(list):
    def unless(self, holds, words):
        if not holds:
            self.append(words)


def axe_source(folder):
    """The script of axe-core, fetched into `folder`; None if it cannot be had."""
    os.makedirs(folder, exist_ok=True)
    fetch = [os.path.join(TREE, "toolchain/fetch_npm_package"), folder, *AXE, "axe.min.js"]
    status = subprocess.run(fetch, check=False).returncode
    if status == 3:
        raise RuntimeError("axe-core is not the expected one")
    if status != 0:
        return None
    with open(os.path.join(folder, "axe.min.js"), encoding="utf-8") as file:
        return file.read()


def axe(page, source, found, where):
    page.value(source + "; true")
    result = page.value(
        "axe.run(document, {resultTypes: ['violations']}).then((r) => r.violations.map("
        "(v) => v.id + ': ' + v.help + ': ' + v.nodes.slice(0, 3).map((n) => n.html).join(' | ')))")
    found.extend(f"{where}: axe: {words}" for words in result)
