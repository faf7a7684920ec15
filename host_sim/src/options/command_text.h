// SPDX-License-Identifier: Apache-2.0
// A program's commands and options as help, manual pages and shell completion. The same description
// also defines the parser of the command line.
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
  std::vector<std::string> choices;  ///< allowed values; empty: any
  bool is_argument = false;
  bool is_required = false;
  bool is_list = false;  ///< an argument that takes any number of values
};

/// A working command line, and its effect.
struct ExampleText {
  std::string line, meaning;
};

/// A command with its options; the program itself is a command with subcommands.
struct CommandText {
  std::string name;  ///< "condyle replay"
  std::string meaning;
  std::string group;  ///< heading in the list
  std::vector<ExampleText> examples;
  std::vector<OptionText> options;
  std::vector<CommandText> commands;
  std::vector<std::string> other_names;  ///< other spellings of its last word

  /// Last word of `name`.
  std::string last_name() const { return name.substr(name.rfind(' ') + 1); }
};

/// Maximum width of help, in columns.
inline constexpr std::size_t kHelpColumns = 100;

/// The output of --help; for a program the list of its commands.
std::string help_text(const CommandText& command);
/// A manual page of section 1, in man(7) macros.
std::string man_page(const CommandText& command, const std::string& version);
/// Completion for bash of commands, options and their choices, otherwise of files.
std::string bash_completion(const CommandText& program);

}  // namespace condyle::host
