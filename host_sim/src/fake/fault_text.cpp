// SPDX-License-Identifier: Apache-2.0
// Fault scripts from TOML files and from the command line.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fake/fault_script.h"
#include "hosted/files/input_error.h"
#include "hosted/files/number_text.h"
#include "hosted/files/toml_reader.h"

namespace condyle::host::fake {
namespace {

constexpr Range kReports = {0, 9e15};
constexpr Range kEvery = {1, 9e15};
constexpr Range kTimes_s = {0, 1e9};
constexpr Range kProbability = {0, 1};
constexpr const char* kForm =
    "write KIND@REPORT, KIND@TIMEs, KIND/EVERY or KIND~PROBABILITY, followed by =AMOUNT if the "
    "kind has one";

FaultKind kind_at(std::size_t index) {
  return static_cast<FaultKind>(index);
}

std::uint64_t whole(double value, const std::string& place, std::string_view key) {
  if (value != std::floor(value)) {
    throw InputError(place, fmt::format("{} = {} is not a whole number", key, value),
                     "give a whole number from 0");
  }
  return static_cast<std::uint64_t>(value);
}

void refuse_fraction(const FaultType& type, double amount, const std::string& place) {
  if (type.is_whole && amount != std::floor(amount)) {
    throw InputError(place, fmt::format("{} = {} is not a whole number", type.amount_key, amount),
                     fmt::format("give whole {}", type.unit));
  }
}

void read_section(TomlReader& file, FaultKind kind, std::vector<FaultRule>& rules) {
  const FaultType& type = fault_type(kind);
  FaultRule rule{.kind = kind, .amount = type.amount};
  const std::string_view name = type.name;
  if (!type.amount_key.empty() &&
      file.number(name, type.amount_key, rule.amount, type.unit, type.range)) {
    refuse_fraction(type, rule.amount, file.place(name, type.amount_key));
  }
  std::vector<double> reports, times_s;
  double every = 0, probability = 0;
  const auto add = [&](auto FaultRule::*condition, auto value) {
    FaultRule added = rule;
    added.*condition = value;
    rules.push_back(added);
  };
  file.list(name, "reports", reports, "reports", kReports);
  for (const double report : reports) {
    add(&FaultRule::at_report, whole(report, file.place(name, "reports"), "reports"));
  }
  file.list(name, "times_s", times_s, "s", kTimes_s);
  for (const double time_s : times_s) add(&FaultRule::at_time_ns, nanoseconds(time_s));
  if (file.number(name, "every_reports", every, "reports", kEvery)) {
    add(&FaultRule::every_reports,
        whole(every, file.place(name, "every_reports"), "every_reports"));
  }
  if (file.number(name, "probability", probability, "share of the reports", kProbability)) {
    add(&FaultRule::probability, probability);
  }
}

void refuse_idle_section(const TomlReader& file, FaultKind kind,
                         const std::vector<FaultRule>& rules) {
  const std::string_view name = fault_type(kind).name;
  const bool happens = std::any_of(rules.begin(), rules.end(),
                                   [kind](const FaultRule& rule) { return rule.kind == kind; });
  if (file.has("", name) && !happens) {
    throw InputError(file.place("", name), fmt::format("[{}] never happens", name),
                     "give reports, times_s, every_reports or probability");
  }
}

double number_of(const std::string& text, const std::string& number, Range range) {
  double value = 0;
  if (parse_number(number, value) != NumberStatus::ok || !range.contains(value)) {
    throw InputError(
        "fault " + quote(text),
        fmt::format("{} is not a number from {} to {}", quote(number), range.lowest, range.highest),
        kForm);
  }
  return value;
}

FaultKind kind_of(const std::string& text, const std::string& name) {
  std::string names;
  for (std::size_t i = 0; i < kFaultKinds; ++i) {
    if (fault_type(kind_at(i)).name == name) return kind_at(i);
    names += fmt::format("{}{}", i == 0 ? "" : ", ", fault_type(kind_at(i)).name);
  }
  throw InputError("fault " + quote(text), quote(name) + " is not a kind of fault",
                   "kinds are " + names);
}

}  // namespace

std::vector<FaultRule> load_faults(const std::string& path, std::uint64_t& seed) {
  TomlReader file(path);
  double number = 0;
  if (file.number("", "seed", number, "whole number", kReports)) {
    seed = whole(number, file.place("", "seed"), "seed");
  }
  std::vector<FaultRule> rules;
  for (std::size_t i = 0; i < kFaultKinds; ++i) read_section(file, kind_at(i), rules);
  file.finish();
  for (std::size_t i = 0; i < kFaultKinds; ++i) refuse_idle_section(file, kind_at(i), rules);
  return rules;
}

FaultRule parse_fault(const std::string& text) {
  const std::string place = "fault " + quote(text);
  const std::size_t mark = text.find_first_of("@/~");
  if (mark == std::string::npos) throw InputError(place, "lacks the time of the fault", kForm);
  const std::size_t equals = text.find('=', mark);
  FaultRule rule;
  rule.kind = kind_of(text, text.substr(0, mark));
  const FaultType& type = fault_type(rule.kind);
  rule.amount = type.amount;
  if (equals != std::string::npos) {
    if (type.amount_key.empty()) {
      throw InputError(place, fmt::format("{} has no amount", type.name), "leave it out");
    }
    rule.amount = number_of(text, text.substr(equals + 1), type.range);
    refuse_fraction(type, rule.amount, place);
  }
  std::string when = text.substr(mark + 1, equals - mark - 1);
  if (text[mark] == '~') {
    rule.probability = number_of(text, when, kProbability);
  } else if (text[mark] == '/') {
    rule.every_reports = whole(number_of(text, when, kEvery), place, "number of reports");
  } else if (!when.empty() && when.back() == 's') {
    when.pop_back();
    rule.at_time_ns = nanoseconds(number_of(text, when, kTimes_s));
  } else {
    rule.at_report = whole(number_of(text, when, kReports), place, "report");
  }
  return rule;
}

}  // namespace condyle::host::fake
