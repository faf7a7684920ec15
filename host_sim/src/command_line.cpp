// SPDX-License-Identifier: Apache-2.0
#include "command_line.h"

#include <CLI/CLI.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "number_text.h"

namespace condyle::host {

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
  option_->check(CLI::IsMember(std::vector<std::string>(words.begin(), words.end())));
  return *this;
}

Option Option::within(int lowest, int highest) {
  option_->check(CLI::Range(lowest, highest));
  return *this;
}

Option Option::number_in(Range range) {
  const auto judge = [range](const std::string& text) {
    double value = 0;
    const bool good = parse_number(text, value) == NumberStatus::ok && range.contains(value);
    std::string from, to;
    append_number(from, range.lowest);
    append_number(to, range.highest);
    return good ? "" : quote(text) + " is no number from " + from + " to " + to;
  };
  option_->check(CLI::Validator(judge, "NUMBER"));
  return *this;
}

Option Option::values(int count) {
  option_->expected(count);
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

CommandLine CommandLine::add_command(const std::string& name, const std::string& meaning) const {
  return CommandLine(*app_->add_subcommand(name, meaning));
}

template <class Value>
Option CommandLine::add_option(const std::string& name, Value& value,
                               const std::string& meaning) const {
  return Option(*app_->add_option(name, value, meaning));
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
  return Option(*app_->add_flag(name, value, meaning));
}

Option CommandLine::on_option(const std::string& name, std::function<void(const std::string&)> take,
                              const std::string& meaning) const {
  return Option(*app_->add_option_function<std::string>(name, std::move(take), meaning));
}

Option CommandLine::on_flag(const std::string& name, std::function<void()> take,
                            const std::string& meaning) const {
  return Option(*app_->add_flag_callback(name, std::move(take), meaning));
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

Program::Program(const std::string& meaning) : app_(std::make_unique<CLI::App>(meaning)) {}

Program::~Program() = default;

void Program::set_version(const std::string& version) {
  app_->set_version_flag("--version", version);
}

Program::Parsed Program::parse(int argc, char** argv) {
  try {
    app_->parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app_->exit(error) == 0 ? Parsed::answered : Parsed::wrong;
  }
  return Parsed::run;
}

}  // namespace condyle::host
