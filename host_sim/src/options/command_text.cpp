// SPDX-License-Identifier: Apache-2.0
#include "options/command_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace condyle::host {
namespace {

constexpr std::size_t kMeaningColumn = 30;

// `text` wrapped from column `begin` on; the first line is not indented.
std::string wrapped(const std::string& text, std::size_t begin) {
  std::string lines;
  std::size_t column = begin;
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::string_view word = rest.substr(0, rest.find(' '));
    rest.remove_prefix(std::min(rest.size(), word.size() + 1));
    if (column > begin && column + 1 + word.size() > kHelpColumns) {
      lines += "\n" + std::string(begin, ' ');
      column = begin;
    }
    if (column > begin) lines += ' ', ++column;
    lines += word;
    column += word.size();
  }
  return lines + "\n";
}

// An entry of a list: a name, and its meaning in a second column.
std::string entry(const std::string& what, const std::string& meaning) {
  std::string line = "  " + what;
  if (line.size() + 2 > kMeaningColumn) {
    line += "\n" + std::string(kMeaningColumn, ' ');
  } else {
    line.resize(kMeaningColumn, ' ');
  }
  return line + wrapped(meaning, kMeaningColumn);
}

std::string names_of(const OptionText& option) {
  std::string names =
      option.short_name.empty() ? option.name : option.short_name + ", " + option.name;
  if (!option.is_argument && !option.value.empty()) names += " " + option.value;
  return names;
}

// Groups in the order of their first appearance.
template <class Item>
std::vector<std::string> groups_of(const std::vector<Item>& items) {
  std::vector<std::string> groups;
  for (const Item& item : items) {
    if (std::find(groups.begin(), groups.end(), item.group) == groups.end()) {
      groups.push_back(item.group);
    }
  }
  return groups;
}

std::string usage(const CommandText& command) {
  std::string words = command.name;
  if (!command.commands.empty()) words += " COMMAND";
  for (const OptionText& option : command.options) {
    if (!option.is_argument) continue;
    const std::string name = option.name + (option.is_list ? "..." : "");
    words += option.is_required ? " " + name : " [" + name + "]";
  }
  for (const OptionText& option : command.options) {
    if (!option.is_argument && option.is_required) {
      words += fmt::format(" {} {}", option.name, option.value);
    }
  }
  return words + " [OPTION...]";
}

// Escapes a backslash, and a leading dot or quote, which man would take for macros.
std::string for_man(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '\\') {
      safe += "\\e";
    } else if (c == '-') {
      safe += "\\-";
    } else {
      safe += c;
    }
  }
  return !safe.empty() && (safe[0] == '.' || safe[0] == '\'') ? "\\&" + safe : safe;
}

// The words that may follow a command, or an option with choices.
void add_words(const CommandText& command, std::string& cases) {
  std::string parts, options;
  for (const CommandText& part : command.commands) parts += part.last_name() + " ";
  for (const OptionText& option : command.options) {
    if (option.is_argument) continue;
    options += option.name + " ";
    if (option.choices.empty()) continue;
    cases += fmt::format("    '{} {}') words='{}' ;;\n", command.name, option.name,
                         fmt::join(option.choices, " "));
  }
  cases += fmt::format("    '{} ') parts='{}' options='{}' ;;\n", command.name, parts, options);
  for (const CommandText& part : command.commands) add_words(part, cases);
}

void add_names(const CommandText& command, std::string& cases) {
  for (const CommandText& part : command.commands) {
    cases += fmt::format("      '{0}') command='{0}' ;;\n", part.name);
    add_names(part, cases);
  }
}

}  // namespace

std::string help_text(const CommandText& command) {
  std::string text = "Usage: " + wrapped(usage(command), 7) + "\n" + wrapped(command.meaning, 0);
  for (const std::string& group : groups_of(command.commands)) {
    text += fmt::format("\n{}:\n", group);
    for (const CommandText& part : command.commands) {
      if (part.group == group) text += entry(part.last_name(), part.meaning);
    }
  }
  for (const std::string& group : groups_of(command.options)) {
    text += fmt::format("\n{}:\n", group);
    for (const OptionText& option : command.options) {
      if (option.group == group) text += entry(names_of(option), option.meaning);
    }
  }
  if (!command.examples.empty()) text += "\nExamples:\n";
  for (const ExampleText& example : command.examples) {
    text += fmt::format("  {}\n      {}", example.line, wrapped(example.meaning, 6));
  }
  return text;
}

std::string man_page(const CommandText& command, const std::string& version) {
  std::string title = command.name;
  std::replace(title.begin(), title.end(), ' ', '-');
  std::string capitals = title;
  std::transform(capitals.begin(), capitals.end(), capitals.begin(), [](char c) {
    return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  });
  std::string page =
      fmt::format(".TH {} 1 \"\" \"{}\" \"User commands\"\n", for_man(capitals), version);
  page += fmt::format(".SH NAME\n{} \\- {}\n", for_man(title), for_man(command.meaning));
  page += fmt::format(".SH SYNOPSIS\n{}\n", for_man(usage(command)));
  for (const std::string& group : groups_of(command.commands)) {
    page += fmt::format(".SH {}\n", for_man(group));
    for (const CommandText& part : command.commands) {
      if (part.group != group) continue;
      page += fmt::format(".TP\n.B {}\n{}\n", for_man(part.last_name()), for_man(part.meaning));
    }
  }
  for (const std::string& group : groups_of(command.options)) {
    page += fmt::format(".SH {}\n", for_man(group));
    for (const OptionText& option : command.options) {
      if (option.group != group) continue;
      page += fmt::format(".TP\n.B {}\n{}\n", for_man(names_of(option)), for_man(option.meaning));
    }
  }
  if (!command.examples.empty()) page += ".SH Examples\n";
  for (const ExampleText& example : command.examples) {
    page += fmt::format(".TP\n.B {}\n{}\n", for_man(example.line), for_man(example.meaning));
  }
  page +=
      ".SH Exit status\n0 done; 2 unusable input; 3 negative result; 70 a defect of condyle; 130 "
      "interrupted.\n";
  page += ".SH Note\nResearch use only. Not a diagnosis.\n";
  return page;
}

std::string bash_completion(const CommandText& program) {
  std::string names, cases;
  add_names(program, names);
  add_words(program, cases);
  return fmt::format(
      "# bash completion of {0}\n"
      "_{0}() {{\n"
      "  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}}\n"
      "  local command={0} words='' parts='' options='' i\n"
      "  for ((i = 1; i < COMP_CWORD; ++i)); do\n"
      "    case \"$command ${{COMP_WORDS[i]}}\" in\n"
      "{1}"
      "    esac\n"
      "  done\n"
      "  [[ $before == --* ]] || before=''\n"
      "  case \"$command $before\" in\n"
      "{2}"
      "  esac\n"
      "  if [[ -z $words && $word == -* ]]; then words=$options; fi\n"
      "  if [[ -z $words ]]; then words=$parts; fi\n"
      "  if [[ -n $words ]]; then\n"
      "    mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\")\n"
      "  else\n"
      "    mapfile -t COMPREPLY < <(compgen -f -- \"$word\")\n"
      "  fi\n"
      "}}\n"
      "complete -o filenames -F _{0} {0}\n",
      program.name, names, cases);
}

}  // namespace condyle::host
