# SPDX-License-Identifier: Apache-2.0
"""Tokens and statements of a C++ source, as far as mutation needs them; sources are clang-formatted."""
import re

TOKEN = re.compile(r"""
    (?P<skip>\s+|//[^\n]*|/\*.*?\*/)
  | (?P<string>R"(?P<mark>[^()\s\\]*)\(.*?\)(?P=mark)"|(?:u8|[uUL])?"(?:\\.|[^"\\\n])*")
  | (?P<char>'(?:\\.|[^'\\\n])+')
  | (?P<number>\.?\d(?:[eEpP][+-]|'(?=\w)|[\w.])*)
  | (?P<name>[A-Za-z_]\w*)
  | (?P<operator><=>|<<=|>>=|->\*|\.\.\.|::|->|\+\+|--|<<|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|.)
""", re.X | re.S)
PAIRS = {"(": ")", "[": "]", "{": "}"}
ASSIGNMENTS = {"=", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "<<=", ">>="}
NOT_EXPRESSIONS = {"return", "break", "continue", "throw", "goto", "delete", "static", "constexpr",
                   "const", "auto", "using", "typedef", "struct", "class", "enum", "union",
                   "template", "static_assert", "friend", "public", "private", "protected"}

NOT_MEMBERS = (set(NOT_EXPRESSIONS) | {"operator", "virtual"}) - {"const"}


class Token:
    def __init__(self, kind, text, start, before, after):
        self.kind, self.text, self.start, self.end = kind, text, start, start + len(text)
        self.spaced = before.isspace() and after.isspace()  # on both sides: a binary operator
        self.glued = not before.isspace()
        self.in_angles = False  # an argument list of a template
        self.left_out = False   # a static_assert or an attribute
        self.partner = None     # of a bracket


class Region:
    """What a switch between variants can surround: a statement, a condition, an initialiser."""

    def __init__(self, form, first, last, cast=""):
        self.form, self.first, self.last, self.cast = form, first, last, cast


class Source:
    def __init__(self, text):
        self.text = text
        self.tokens = []
        self.regions = []     # innermost last among those that hold a token
        self.conditions = []  # (first, last) of tokens: of if and while
        self.droppable = []   # (first, last) of tokens: expression statements
        self._tokenise()
        self._match_brackets()
        self._mark_left_out()
        self._find_statements()

    def line_of(self, position):
        return self.text.count("\n", 0, position) + 1

    def line_text(self, position):
        start = self.text.rfind("\n", 0, position) + 1
        return self.text[start:self.text.find("\n", position)]

    def slice(self, first, last):
        """The text of the tokens first to last in one line, without comments."""
        words = []
        for i in range(first, last + 1):
            token = self.tokens[i]
            if i > first and token.start > self.tokens[i - 1].end:
                words.append(" ")
            words.append(token.text)
        return "".join(words)

    def _tokenise(self):
        # Preprocessor lines become spaces: positions stay.
        text = re.sub(r"^[ \t]*#(?:[^\n\\]|\\.|\\\n)*", lambda m: re.sub(r"[^\n]", " ", m[0]),
                      self.text, flags=re.M)
        for match in TOKEN.finditer(text):
            if match.lastgroup != "skip" and match["skip"] is None:
                kind = next(k for k in ("string", "char", "number", "name", "operator") if match[k])
                after = text[match.end():match.end() + 1] or " "
                before = text[match.start() - 1:match.start()] or " "
                self.tokens.append(Token(kind, match[0], match.start(), before, after))

    def _match_brackets(self):
        stack = []
        for i, token in enumerate(self.tokens):
            if token.kind != "operator":
                continue
            if token.text in PAIRS:
                stack.append(i)
            elif token.text in PAIRS.values():
                j = stack.pop()
                token.partner, self.tokens[j].partner = j, i

    def _mark_left_out(self):
        tokens = self.tokens
        for i, token in enumerate(tokens):
            if token.text == "<" and not token.in_angles and i > 0 and (
                    token.glued or tokens[i - 1].text == "template") and not token.spaced or (
                    token.text == "<" and tokens[i - 1].text == "template"):
                for j in range(i, self._end_of_angles(i) + 1):
                    tokens[j].in_angles = True
            if token.text in ("static_assert", "requires"):
                j = i
                while tokens[j].text not in (";", "{"):
                    tokens[j].left_out = True
                    j += 1
            if token.text == "[" and i + 1 < len(tokens) and tokens[i + 1].text == "[":
                for j in range(i, token.partner + 1):
                    tokens[j].left_out = True

    def _end_of_angles(self, i):
        depth, j = 0, i
        while j < len(self.tokens):
            text = self.tokens[j].text
            if text in PAIRS:
                j = self.tokens[j].partner
            elif text == "<":
                depth += 1
            elif text == ">":
                depth -= 1
            if depth == 0 or text in (";", "}", ")"):
                return j
            j += 1
        return i

    # Blocks: braces that hold statements.
    def _is_block(self, i, parents):
        tokens = self.tokens
        previous = tokens[i - 1].text if i else ";"
        if previous in (")", "else", "do", "try"):
            return True
        head = []
        j = i - 1
        while j >= 0 and tokens[j].text not in (";", "{", "}"):
            if tokens[j].text in (")", "]"):
                j = tokens[j].partner
                head.append("()")
            elif tokens[j].text == "(" or tokens[j].text == "[":
                break
            elif not tokens[j].in_angles:
                head.append(tokens[j].text)
            j -= 1
        head.reverse()
        if {"class", "struct", "union", "enum", "namespace"} & set(head):
            return False
        if previous in ("const", "noexcept", "override", "mutable", "constexpr", "]"):
            return True
        if "->" in head and head.index("->") > 0 and head[head.index("->") - 1] == "()":
            return True
        if previous == "}":  # after initialisers of members, or after a block
            return bool(parents) or ":" in self._text_of_head(i)
        return previous in (";", "{", ":") and bool(parents) and parents[-1]

    def _text_of_head(self, i):
        j, texts = i - 1, []
        while j >= 0 and self.tokens[j].text != ";":
            if self.tokens[j].partner is not None and self.tokens[j].partner < j:
                j = self.tokens[j].partner
            elif self.tokens[j].text == "{":
                break
            texts.append(self.tokens[j].text)
            j -= 1
        return texts

    def _find_statements(self):
        self._visited = set()
        parents = []
        blocks = []
        for i, token in enumerate(self.tokens):
            if token.text == "{" and token.kind == "operator":
                is_block = self._is_block(i, parents)
                parents.append(is_block)
                if is_block:
                    blocks.append(i)
                elif {"class", "struct"} & set(self._text_of_head(i)):
                    self._members(i + 1, token.partner)
            elif token.text == "}" and token.kind == "operator":
                parents.pop()
        for i in blocks:
            if i not in self._visited:
                self._block(i)

    def _members(self, first, end):
        """The initialisers of a class's members."""
        tokens, i = self.tokens, first
        while i < end:
            text, partner = tokens[i].text, tokens[i].partner
            if partner is not None and partner > i:
                i = partner
                if text == "{" and tokens[i + 1].text not in (";", ","):  # of a function
                    first = i + 1
            elif text == ":" and tokens[i - 1].text in ("public", "private", "protected"):
                first = i + 1
            elif text == ";":
                if not NOT_MEMBERS & {t.text for t in tokens[first:i]}:
                    self._declaration(first, i)
                first = i + 1
            i += 1

    def _block(self, i):
        self._visited.add(i)
        end = self.tokens[i].partner
        j = i + 1
        while j < end:
            j = self._statement(j)
        return end + 1

    def _end(self, i, ends=(";",)):
        """The next of `ends` outside brackets."""
        while self.tokens[i].text not in ends:
            partner = self.tokens[i].partner
            i = partner if partner is not None and partner > i else i
            i += 1
        return i

    def _statement(self, i):
        tokens = self.tokens
        while tokens[i].text == tokens[i + 1].text == "[":  # an attribute
            i = tokens[i].partner + 1
        text = tokens[i].text
        if text == "{":
            return self._block(i)
        if text in ("if", "while", "switch", "for"):
            is_constant = tokens[i + 1].text == "constexpr"
            opening = i + 1 + is_constant
            closing = tokens[opening].partner
            if not is_constant:
                self._parentheses(text, opening + 1, closing)
            i = self._statement(closing + 1)
            if text == "if" and i < len(tokens) and tokens[i].text == "else":
                i = self._statement(i + 1)
            return i
        if text == "try":
            i = self._block(i + 1)
            while i < len(tokens) and tokens[i].text == "catch":
                i = self._block(tokens[i + 1].partner + 1)
            return i
        if text == "do":
            return self._end(self._statement(i + 1)) + 1
        if text in ("case", "default"):
            return self._end(i, (":",)) + 1
        end = self._end(i)
        if text in ("struct", "class", "enum", "using", "typedef", "static_assert"):
            return end + 1
        self._simple(i, end)
        return end + 1

    def _simple(self, first, end):
        text = self.tokens[first].text
        if text in ("return", "throw"):
            self.regions.append(Region("statement", first, end))
        elif self._is_expression(first, end):
            self.regions.append(Region("statement", first, end))
            self.droppable.append((first, end))
        elif text not in NOT_EXPRESSIONS or text in ("const", "auto"):
            self._declaration(first, end)

    def _is_expression(self, first, end):
        tokens = self.tokens
        i = first
        if tokens[i].text in NOT_EXPRESSIONS:
            return False
        if tokens[i].text in ("++", "--", "*"):
            return True
        after_name = False
        while i < end:
            token = tokens[i]
            if token.in_angles and after_name:
                pass
            elif token.kind == "name":
                if after_name:
                    return False
                after_name = True
            elif token.text in ("::", ".", "->"):
                after_name = False
            elif token.text in ("(", "["):
                i = token.partner
            elif token.text in ASSIGNMENTS or token.text in ("++", "--"):
                return True
            elif token.text == "," or token.spaced:
                return token.text != ","
            else:
                return False
            i += 1
        return tokens[end - 1].text == ")"

    def _declaration(self, first, end):
        """The initialisers of `T a = x, b = y;`."""
        tokens = self.tokens
        equal = self._end(first, ("=", ";"))
        if equal >= end:
            return
        kind = [t for t in tokens[first:equal - 1]]
        words = [t.text for t in kind if t.text != "const"]
        if "&" in words or "&&" in words or not words:
            return
        cast = ""
        if not {"auto", "[", "*"} & set(words) and tokens[equal - 1].kind == "name" and "," not in [
                t.text for t in kind if not t.in_angles]:
            cast = "".join(" " + w if w.isidentifier() else w for w in words).strip()
        i = first
        while i < end:
            equal = self._end(i, ("=", ";"))
            if equal >= end:
                return
            comma = equal
            while True:
                comma = self._end(comma + 1, (",", ";"))
                if not tokens[comma].in_angles:
                    break
            self.regions.append(Region("initialiser", equal + 1, comma - 1, cast))
            i = comma

    def _parentheses(self, keyword, first, closing):
        parts, i = [], first
        while i < closing:
            end = i
            while end < closing and self.tokens[end].text != ";":
                partner = self.tokens[end].partner
                end = (partner if partner is not None and partner > end else end) + 1
            parts.append((i, end))
            i = end + 1
        if keyword == "for":
            if len(parts) != 3:
                return
            self._simple(*parts[0]) if not self._is_expression(*parts[0]) else None
            self.regions.append(Region("condition", parts[1][0], parts[1][1] - 1))
            self.regions.append(Region("step", parts[2][0], parts[2][1] - 1))
            return
        first, end = parts[-1]
        texts = [t.text for t in self.tokens[first:end]]
        if keyword == "switch" or "=" in texts:
            return
        self.regions.append(Region("condition", first, end - 1))
        self.conditions.append((first, end - 1))
