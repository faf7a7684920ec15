# SPDX-License-Identifier: Apache-2.0
"""Texts that a page must show as text: markup, script, quotes, and characters that turn the direction of
writing, control a terminal, or fill the page."""
import json
import os

TEXTS = ["<img src=x onerror=hostile=1>", "\"><svg/onload=hostile=2>", "'onfocus='hostile=3",
         "</script><script>hostile=4</script>", "</dd><!--<script>", "</table><plaintext>",
         "&lt;i&gt;&#60;u&#62;&amp", "{}{0}%s%n\\u003c", "__proto__", "m\u202egnp.\u2066s",
         "e\x1b[2J\x07", "R<b>" * 50]
# What the texts would make if they were markup.
ELEMENTS = "document.querySelectorAll('img, plaintext, svg[onload], [onfocus], main u, main b').length"
UNCLEAN = ("/[\\u0000-\\u0008\\u000b-\\u001f\\u007f-\\u009f\\u200e\\u200f\\u2028-\\u202e\\u2066-\\u2069]/"
           ".test(document.documentElement.textContent)")


def look_for_markup(page, found, where):
    """No text became an element or was run, and none turns the direction of writing."""
    found.unless(page.value(ELEMENTS) == 0, f"{where}: a text became markup")
    found.unless(page.value("typeof hostile") == "undefined", f"{where}: a text was run")
    found.unless(not page.value(UNCLEAN), f"{where}: a control character is shown as itself")


def names_of_one_device():
    """All texts that TOML can hold, in one name."""
    return " ".join(text for text in TEXTS if text.isprintable() or "\u202e" in text)


def shown(text):
    """As condyle shows it: the bytes of control characters and of those that turn the direction as \\xNN."""
    def one(c):
        is_control = ord(c) < 0x20 or 0x7f <= ord(c) < 0xa0 or "\u2028" <= c <= "\u202e" or "\u2066" <= c <= "\u2069"
        return "".join(f"\\x{byte:02x}" for byte in c.encode()) if is_control else c
    return "".join(map(one, text))


def profile(path, tree, name):
    """Writes the fake facebow's profile with the name `name`; returns `path`."""
    with open(os.path.join(tree, "hal/profiles/condyle_facebow.toml"), encoding="utf-8") as file:
        text = file.read()
    # A string of JSON is one of TOML.
    with open(path, "w", encoding="utf-8") as file:
        file.write(text.replace('"condyle fake facebow"', json.dumps(name)))
    return path
