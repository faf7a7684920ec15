// SPDX-License-Identifier: Apache-2.0
#include "options/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <regex>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "hosted/files/clean_text.h"
#include "hosted/files/nearest_word.h"
#include "hosted/files/number_text.h"

namespace condyle::host {
namespace {

template <class Value>
inline constexpr bool kIsNumber = !std::is_constructible_v<Value, const char*>;
template <>
inline constexpr bool kIsNumber<std::vector<std::string>> = false;

template <class Value>
inline constexpr bool kIsUnsigned = std::is_unsigned_v<Value>;
template <>
inline constexpr bool kIsUnsigned<std::optional<std::uint64_t>> = true;

// CLI11 reads -1 as the largest unsigned number.
std::string judge_unsigned(const std::string& text) {
  const bool good = text.find_first_not_of("0123456789") == std::string::npos;
  return good ? "" : "must be a whole number of 0 or more, not " + quote(text);
}

}  // namespace

Option Option::required() {
  option_->required();
  return *this;
}

Option Option::show_default() {
  option_->capture_default_str();
  return *this;
}

Option Option::show_default(const std::string& value) {
  option_->default_str(value);
  return *this;
}

Option Option::one_of(std::initializer_list<const char*> words) {
  const std::vector<std::string> all(words.begin(), words.end());
  option_->check(CLI::IsMember(all).description(""));
  option_->type_name(CLI::detail::join(all, "|"));
  return *this;
}

Option Option::within(int lowest, int highest) {
  option_->check(CLI::Range(lowest, highest).description(""));
  return *this;
}

Option Option::number_in(Range range) {
  const auto judge = [range](const std::string& text) {
    double value = 0;
    const bool good = parse_number(text, value) == NumberStatus::ok && range.contains(value);
    return good ? ""
                : fmt::format("{} is not a number from {:.15g} to {:.15g}", quote(text),
                              range.lowest, range.highest);
  };
  option_->check(CLI::Validator(judge, ""));
  return *this;
}

Option Option::values(int count) {
  option_->expected(count);
  return *this;
}

Option Option::values_each(int count) {
  option_->type_size(count);
  option_->expected(1, CLI::detail::expected_max_vector_size);
  option_->allow_extra_args(false);
  return *this;
}

Option Option::one_value_each() {
  option_->allow_extra_args(false);
  return *this;
}

Option Option::separated_by(char separator) {
  option_->delimiter(separator);
  return *this;
}

Option Option::excludes(const std::string& name) {
  option_->excludes(name);
  return *this;
}

Option Option::excludes(Option other) {
  option_->excludes(other.option_);
  return *this;
}

Option Option::needs(Option other) {
  option_->needs(other.option_);
  return *this;
}

bool Option::is_given() const {
  return option_->count() > 0;
}

CommandLine CommandLine::add_command(const std::string& name, const std::string& meaning,
                                     const std::string& group) const {
  CLI::App* const command = app_->add_subcommand(name, meaning);
  command->group(group);
  command->set_help_flag("-h,--help", "Show this help");
  return CommandLine(*command);
}

void CommandLine::also_called(const std::string& name) const {
  app_->alias(name);
}

void CommandLine::add_example(const std::string& line, const std::string& meaning) const {
  app_->footer(app_->get_footer() + line + "\n" + meaning + "\n");
}

CommandLine CommandLine::group(const std::string& heading) const {
  CommandLine same = *this;
  same.group_ = heading;
  return same;
}

template <class Value>
Option CommandLine::add_option(const std::string& name, Value& value,
                               const std::string& meaning) const {
  return add(name, kIsNumber<Value> ? "NUMBER" : "TEXT", [&](const std::string& names) {
    CLI::Option* const option = app_->add_option(names, value, meaning);
    if (kIsUnsigned<Value>) option->check(CLI::Validator(judge_unsigned, ""));
    return option;
  });
}

// `make` adds an option of some names to the command.
template <class Make>
Option CommandLine::add(const std::string& name, const char* value, const Make& make) const {
  const std::size_t names = name.find('=');
  CLI::Option* const option = make(name.substr(0, names));
  option->type_name(names == std::string::npos ? value : name.substr(names + 1));
  option->group(option->get_positional() ? "Arguments" : group_.empty() ? "Options" : group_);
  return Option(*option);
}

#define CONDYLE_OPTION_OF(...)                                                                  \
  template Option CommandLine::add_option(const std::string&, __VA_ARGS__&, const std::string&) \
      const
CONDYLE_OPTION_OF(std::string);
CONDYLE_OPTION_OF(double);
CONDYLE_OPTION_OF(int);
CONDYLE_OPTION_OF(unsigned);
CONDYLE_OPTION_OF(std::uint16_t);
CONDYLE_OPTION_OF(std::uint64_t);
CONDYLE_OPTION_OF(std::optional<double>);
CONDYLE_OPTION_OF(std::optional<std::uint64_t>);
CONDYLE_OPTION_OF(std::vector<std::string>);
CONDYLE_OPTION_OF(std::vector<double>);
#undef CONDYLE_OPTION_OF

Option CommandLine::add_flag(const std::string& name, bool& value,
                             const std::string& meaning) const {
  return add(name, "",
             [&](const std::string& names) { return app_->add_flag(names, value, meaning); });
}

Option CommandLine::on_option(const std::string& name, std::function<void(const std::string&)> take,
                              const std::string& meaning) const {
  return add(name, "TEXT", [&](const std::string& names) {
    return app_->add_option_function<std::string>(names, std::move(take), meaning);
  });
}

Option CommandLine::on_flag(const std::string& name, std::function<void()> take,
                            const std::string& meaning) const {
  return add(name, "", [&](const std::string& names) {
    return app_->add_flag_callback(names, std::move(take), meaning);
  });
}

void CommandLine::require_command() const {
  app_->require_subcommand(1);
}

void CommandLine::pass_on_unknown() const {
  app_->fallthrough();
}

bool CommandLine::is_given() const {
  return app_->parsed();
}

bool CommandLine::is_given(const std::string& name) const {
  return app_->got_subcommand(name);
}

namespace {

OptionText describe(const CLI::Option& option) {
  OptionText text;
  text.is_argument = option.get_positional();
  text.name = text.is_argument ? option.get_name(true) : "--" + option.get_lnames().at(0);
  if (!option.get_snames().empty()) text.short_name = "-" + option.get_snames()[0];
  text.is_list = text.is_argument && option.get_expected_max() > 1;
  text.value = option.get_type_name();
  const int values = option.get_expected_max();
  if (!text.is_argument && values == option.get_expected_min() && values > 1) {
    const std::string one = text.value;
    for (int i = 1; i < values; ++i) text.value += " " + one;
  }
  text.meaning = option.get_description();
  const std::string default_value = option.get_default_str();
  if (!default_value.empty()) text.meaning += " [" + default_value + "]";
  text.group = option.get_group();
  if (text.value.find('|') != std::string::npos) text.choices = CLI::detail::split(text.value, '|');
  text.is_required = option.get_required();
  return text;
}

CommandText describe(const CLI::App& app, const std::string& name) {
  CommandText text{name, app.get_description(), app.get_group(), {}, {}, {}};
  const std::vector<std::string> lines = CLI::detail::split(app.get_footer(), '\n');
  for (std::size_t i = 0; i + 1 < lines.size(); i += 2) {
    text.examples.push_back({lines[i], lines[i + 1]});
  }
  std::vector<const CLI::Option*> last;  // help and version
  for (const CLI::Option* option : app.get_options()) {
    if (option == app.get_help_ptr() || option == app.get_version_ptr()) {
      last.push_back(option);
    } else {
      text.options.push_back(describe(*option));
    }
  }
  std::stable_sort(
      text.options.begin(), text.options.end(),
      [](const OptionText& a, const OptionText& b) { return a.is_argument && !b.is_argument; });
  for (const CLI::Option* option : last) {
    text.options.push_back(describe(*option));
    text.options.back().group = "Help";
    text.options.back().value.clear();
  }
  for (const CLI::App* part : app.get_subcommands([](const CLI::App*) { return true; })) {
    text.commands.push_back(describe(*part, name + " " + part->get_name()));
    text.commands.back().other_names = part->get_aliases();
  }
  return text;
}

// The parser's words for a wrong, missing or surplus value, in ours.
std::string plain_error(const std::string& error) {
  static const std::regex choice(R"((\S+): (.*) not in \{(.*)\})"),
      missing(R"((\S+): (\d+) required \S+ missing)"),
      outside(R"((\S+): Value (.*) not in range (\S+) to (\S+))"),
      unreadable(R"(Could not convert: (\S+) = (.*))"),
      surplus(R"(The following arguments? (was|were) not expected: (.*))");
  std::smatch found;
  if (std::regex_match(error, found, choice)) {
    const std::string choices = std::regex_replace(found[3].str(), std::regex(","), ", ");
    return found[1].str() + ": must be one of " + choices + ", not '" + found[2].str() + "'";
  }
  if (std::regex_match(error, found, missing)) {
    return found[1].str() + ": needs " + (found[2] == "1" ? "a value" : found[2].str() + " values");
  }
  if (std::regex_match(error, found, outside)) {
    return found[1].str() + ": must be a whole number from " + found[3].str() + " to " +
           found[4].str() + ", not '" + found[2].str() + "'";
  }
  if (std::regex_match(error, found, unreadable)) {
    return found[1].str() + ": takes numbers, not '" + found[2].str() + "'";
  }
  if (std::regex_match(error, found, surplus)) {
    return (found[1] == "was" ? "one argument too many: " : "too many arguments: ") +
           found[2].str();
  }
  return error;
}

// The command that `words` name, and the number of words in its name.
const CommandText& find(const CommandText& program, const std::vector<std::string>& words,
                        std::size_t& count) {
  const CommandText* here = &program;
  for (count = 0; count < words.size(); ++count) {
    const CommandText* part = nullptr;
    for (const CommandText& other : here->commands) {
      const auto& others = other.other_names;
      if (other.last_name() == words[count] ||
          std::find(others.begin(), others.end(), words[count]) != others.end()) {
        part = &other;
      }
    }
    if (part == nullptr) break;
    here = part;
  }
  return *here;
}

std::string suggestion(const std::string& word, const std::vector<std::string>& words) {
  const std::string nearest = nearest_word(word, words);
  return nearest.empty() ? "" : "; did you mean " + nearest + "?";
}

std::string unknown_command(const CommandText& command, const std::string& word) {
  std::vector<std::string> names;
  for (const CommandText& part : command.commands) names.push_back(part.last_name());
  return clean_line(quote(word)) + " is not a command of " + command.name +
         suggestion(word, names) + "\nRun " + command.name + " --help for the list.";
}

std::string unknown_option(const CommandText& command, const std::string& word) {
  std::vector<std::string> names;
  for (const OptionText& option : command.options) {
    if (!option.is_argument) names.push_back(option.name);
  }
  return command.name + " has no option " + clean_line(quote(word)) + suggestion(word, names) +
         "\nRun " + command.name + " --help for its options.";
}

}  // namespace

Program::Program(const std::string& name, const std::string& version, const std::string& meaning)
    : version_(name + " " + version), app_(std::make_unique<CLI::App>(meaning, name)) {
  app_->set_help_flag("-h,--help", "Show this list of commands");
  app_->set_version_flag("-v,--version", version_, "Show the version");
  app_->allow_windows_style_options(false);  // a word that begins with '/' is a path
}

Program::~Program() = default;

CommandText Program::describe() const {
  return host::describe(*app_, app_->get_name());
}

Program::Parsed Program::answer(const std::vector<std::string>& words, std::string& text) const {
  const CommandText program = describe();
  std::size_t known = 0;
  const CommandText& command = find(program, words, known);
  if (known < words.size()) {
    text = unknown_command(command, words[known]);
    return Parsed::wrong;
  }
  text = help_text(command);
  return Parsed::answered;
}

Program::Parsed Program::parse(int argc, const char* const* argv, std::string& text) {
  std::vector<std::string> words(argv + 1, argv + argc);
  if (words.empty()) return answer({}, text);
  if (words[0] == "help") return answer({words.begin() + 1, words.end()}, text);
  const CommandText program = describe();
  std::size_t known = 0;
  const CommandText& command = find(program, words, known);
  const bool has_parts = !command.commands.empty();
  if (has_parts && known < words.size() && !words[known].starts_with('-')) {
    text = unknown_command(command, words[known]);
    return Parsed::wrong;
  }
  try {
    app_->parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    return answer({words.begin(), words.begin() + static_cast<std::ptrdiff_t>(known)}, text);
  } catch (const CLI::CallForVersion&) {
    text = version_ + "\n";
    return Parsed::answered;
  } catch (const CLI::ParseError& error) {
    for (const std::string& word : app_->remaining(true)) {
      if (word.size() < 2 || word[0] != '-') continue;
      text = unknown_option(command, word.substr(0, word.find('=')));
      return Parsed::wrong;
    }
    if (has_parts && known == words.size()) {
      text = command.name + " requires one of its commands:\n" + help_text(command);
      return Parsed::wrong;
    }
    text = command.name + ": " + clean_line(plain_error(error.what())) + "\nRun " + command.name +
           " --help for more.";
    return Parsed::wrong;
  }
  return Parsed::run;
}

}  // namespace condyle::host
