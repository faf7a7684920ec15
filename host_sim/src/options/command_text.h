// SPDX-License-Identifier: Apache-2.0
// What a program's commands and options are, as text for people and shells: help, man pages,
// completion. All of it comes from the one description that the command line is parsed by.
#pragma once

#include <string>
#include <vector>

namespace condyle::host {

/// An option, or an argument without a name.
struct OptionText {
  std::string short_name;            ///< "-o"; empty: none
  std::string name;                  ///< "--out"; of an argument "RECORDING"
  std::string value;                 ///< word for its value; empty: a flag
  std::string meaning;               ///< with default
  std::string group;                 ///< heading in the help
  std::vector<std::string> choices;  ///< values that it may have; empty: any
  bool is_argument = false;
  bool is_required = false;
};

/// A command line that works, and what it does.
struct ExampleText {
  std::string line, meaning;
};

/// A command with its options; the program itself is one that has commands.
struct CommandText {
  std::string name;  ///< "condyle replay"
  std::string meaning;
  std::string group;  ///< heading in the map
  std::vector<ExampleText> examples;
  std::vector<OptionText> options;
  std::vector<CommandText> commands;

  /// Last word of `name`.
  std::string last_name() const { return name.substr(name.rfind(' ') + 1); }
};

/// Columns that help takes at most.
inline constexpr std::size_t kHelpColumns = 100;

/// What --help prints: of a program the map of its commands.
std::string help_text(const CommandText& command);
/// A manual page of section 1, in man(7) macros.
std::string man_page(const CommandText& command, const std::string& version);
/// Completion for bash, of commands, options and their choices; else of files.
std::string bash_completion(const CommandText& program);

/// The one of `words` that `word` may have been meant for: at most a third of it is mistyped.
/// Empty: none is near.
std::string nearest_word(const std::string& word, const std::vector<std::string>& words);

}  // namespace condyle::host
