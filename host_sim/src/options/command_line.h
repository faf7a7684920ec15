// SPDX-License-Identifier: Apache-2.0
// The options of condyle's commands. They hide CLI11, which only one file includes because it takes
// many seconds to compile.
#pragma once

#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

#include "condyle/estimator/parameter_range.h"
#include "options/command_text.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace condyle::host {

/// An option or argument; a handle, which may be copied.
class Option {
 public:
  Option() = default;
  explicit Option(CLI::Option& option) : option_(&option) {}

  Option required();
  /// Makes --help show the present value of the variable.
  Option show_default();
  Option show_default(const std::string& value);
  Option one_of(std::initializer_list<const char*> words);
  /// A whole number from `lowest` to `highest`.
  Option within(int lowest, int highest);
  /// A number in `range`, not NaN: CLI11's own check accepts NaN.
  Option number_in(Range range);
  /// The number of values that it takes.
  Option values(int count);
  /// It takes `count` values at each use, and may be used several times.
  Option values_each(int count);
  /// It takes one value at each use.
  Option one_value_each();
  Option separated_by(char separator);
  Option excludes(const std::string& name);
  Option excludes(Option other);
  /// It may be given only with `other`.
  Option needs(Option other);

  /// After parsing.
  bool is_given() const;

 private:
  CLI::Option* option_ = nullptr;
};

/// The options and arguments of a command; a handle, which may be copied.
class CommandLine {
 public:
  explicit CommandLine(CLI::App& app) : app_(&app) {}

  /// `group`: its heading in the list of commands.
  CommandLine add_command(const std::string& name, const std::string& meaning,
                          const std::string& group = "Commands") const;
  /// Another name of this command.
  void also_called(const std::string& name) const;
  /// A working command line, for the help.
  void add_example(const std::string& line, const std::string& meaning) const;
  /// The same command; its help shows options added here under `heading`.
  CommandLine group(const std::string& heading) const;
  /// `name`: "--out", "-o,--out" or "RECORDING"; a word for the value may follow, "--out=FILE".
  /// Parsing fills `value`, which must live until then: text, a number, or several of them.
  template <class Value>
  Option add_option(const std::string& name, Value& value, const std::string& meaning) const;
  Option add_flag(const std::string& name, bool& value, const std::string& meaning) const;
  /// Calls `take` if the option is given.
  Option on_option(const std::string& name, std::function<void(const std::string&)> take,
                   const std::string& meaning) const;
  Option on_flag(const std::string& name, std::function<void()> take,
                 const std::string& meaning) const;
  /// One of its commands must be given.
  void require_command() const;
  /// Passes unknown options to the parent command.
  void pass_on_unknown() const;

  /// After parsing: this command, or its command `name`.
  bool is_given() const;
  bool is_given(const std::string& name) const;

 private:
  template <class Make>
  Option add(const std::string& name, const char* value, const Make& make) const;

  CLI::App* app_;
  std::string group_;
};

/// A program and its arguments. Without arguments, or with --help, it prints the list of its
/// commands.
class Program {
 public:
  /// --version prints name and version.
  Program(const std::string& name, const std::string& version, const std::string& meaning);
  ~Program();

  CommandLine line() const { return CommandLine(*app_); }

  enum class Parsed {
    run,       ///< the arguments are good
    answered,  ///< `text` contains the requested help or version
    wrong,     ///< `text` contains the error and the remedy
  };
  Parsed parse(int argc, const char* const* argv, std::string& text);
  /// All commands and options.
  CommandText describe() const;

 private:
  Parsed answer(const std::vector<std::string>& words, std::string& text) const;

  std::string version_;
  std::unique_ptr<CLI::App> app_;
};

}  // namespace condyle::host
