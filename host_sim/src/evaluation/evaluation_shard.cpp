// SPDX-License-Identifier: Apache-2.0
#include "evaluation/evaluation_shard.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>

#include "hosted/config/parameter_file.h"
#include "hosted/files/input_error.h"

namespace condyle::host {
namespace {

constexpr const char* kFormat = "condyle-evaluation-shard-1";
constexpr const char* kEvaluateAgain = "evaluate this shard again";

// Events have no numbers of their own to set: adds `event` `times` times, by doubling.
void count(Event event, std::uint64_t times, EventCounts& counts) {
  EventSet set;
  set.add(event);
  EventCounts power;
  power.add(set);
  for (; times > 0; times /= 2) {
    if (times % 2 == 1) counts.add(power);
    power.add(EventCounts(power));
  }
}

// Every number of a run but those over time and the events.
template <class Visit>
void visit_numbers(EvaluationRun& run, Visit&& visit) {
  for (RunErrors& errors : run.errors) errors.visit_numbers(visit);
  for (std::uint64_t& number : run.not_computed) visit(number);
  visit(run.innovation_axes);
  for (RunInnovations& innovations : run.innovations) {
    innovations.nis.visit_numbers(visit);
    visit(innovations.correlation);
  }
  run.nees.visit_numbers(visit);
  for (ResponsePair* pair : {&run.friction, &run.mass}) {
    visit(pair->truth);
    visit(pair->estimate);
  }
  visit(run.samples);
}

// What the evaluation of an identified value uses.
template <class Visit>
void visit_numbers(IdentifiedRun& run, Visit&& visit) {
  for (IdentifiedValue<double>* value : {&run.last.friction_Ns_m, &run.last.mass_kg}) {
    visit(value->fitted);
    visit(value->fitted_sd);
    int limit = static_cast<int>(value->limit);
    visit(limit);
    value->limit = static_cast<ImpedanceLimit>(limit);
  }
  visit(run.friction_Ns_m);
  visit(run.mass_kg);
}

// Reads the numbers of a line one after another.
class NumberReader {
 public:
  explicit NumberReader(std::string_view line) : rest_(line) {}

  template <class Number>
  void operator()(Number& number) {
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), number);
    is_good_ =
        is_good_ && error == std::errc() && (end == rest_.data() + rest_.size() || *end == ' ');
    if (!is_good_) return;
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    if (!rest_.empty()) rest_.remove_prefix(1);
  }
  /// Every number was read, and nothing else.
  bool is_at_end() const { return is_good_ && rest_.empty(); }
  bool is_good() const { return is_good_; }

 private:
  std::string_view rest_;
  bool is_good_ = true;
};

bool is_limit(const IdentifiedValue<double>& value) {
  const int limit = static_cast<int>(value.limit);
  return limit >= 0 && limit < static_cast<int>(kImpedanceLimits);
}

// False if the line is damaged.
bool read_run(std::string_view line, EvaluationRun& run) {
  NumberReader read(line);
  visit_numbers(run, read);
  int verdict = -1, has_identified = 0;
  read(verdict);
  read(has_identified);
  if (!read.is_good() || run.innovation_axes < 0 || run.innovation_axes > 3 || verdict < -1 ||
      verdict > 2) {
    return false;
  }
  if (verdict >= 0) run.verdict = static_cast<Verdict>(verdict);
  if (has_identified != 0) {
    visit_numbers(run.identified.emplace(), read);
    if (!is_limit(run.identified->last.friction_Ns_m) || !is_limit(run.identified->last.mass_kg)) {
      return false;
    }
  }
  for (std::size_t i = 0; i < kEventCount; ++i) {
    std::uint64_t times = 0;
    read(times);
    count(static_cast<Event>(i), times, run.events);
  }
  return read.is_at_end();
}

// A file of a shard, opened, with its first line read.
class ShardFile {
 public:
  explicit ShardFile(const std::string& path) : path_(path), file_(path) {
    std::string line;
    if (!file_) throw InputError(path, "cannot be read", "check the name");
    std::getline(file_, line);
    nlohmann::json header = nlohmann::json::parse(line, nullptr, false);
    try {
      if (header.at("format") != kFormat) throw_other();
      if (header.at("condyle") != CONDYLE_VERSION) {
        throw InputError(path, "was written by another version of condyle", kEvaluateAgain);
      }
      shard_ = {header.at("shard"), header.at("of")};
      header.erase("shard");
      setup_ = std::move(header);
      if (shard_.number < 1 || shard_.number > shard_.count) throw_other();
    } catch (const nlohmann::json::exception&) {
      throw_other();
    }
  }

  const EvaluationShard& shard() const { return shard_; }
  /// What all shards share.
  const nlohmann::json& setup() const { return setup_; }
  const std::string& path() const { return path_; }

  void add_runs(std::uint64_t runs, Evaluation& evaluation) {
    std::string line;
    for (std::uint64_t i = shard_.begin(runs); i < shard_.end(runs); ++i) {
      EvaluationRun run;
      if (!std::getline(file_, line) || !read_run(line, run)) {
        throw InputError(fmt::format("{}:{}", path_, i - shard_.begin(runs) + 2),
                         "the run is missing or damaged", kEvaluateAgain);
      }
      add_run(run, evaluation);
    }
    if (std::getline(file_, line)) {
      throw InputError(path_, "has more runs than its shard", kEvaluateAgain);
    }
  }

 private:
  [[noreturn]] void throw_other() const {
    throw InputError(path_, "is not a shard of an evaluation",
                     "give files that condyle evaluate --shard wrote");
  }

  std::string path_;
  std::ifstream file_;
  EvaluationShard shard_;
  nlohmann::json setup_;
};

// The settings as text: of equal settings it is equal.
std::string settings_text(const EstimatorSettings& settings) {
  if (const auto* published = std::get_if<PublishedParameters>(&settings)) {
    return "published\n" + parameters_toml(LoadedParameters{*published, true});
  }
  const auto& recommended = std::get<RecommendedSettings>(settings);
  return fmt::format("recommended, lag {}\n{}", recommended.lag,
                     parameters_toml(recommended.parameters));
}

// The bound as JSON, which has no NaN.
nlohmann::json bound_json(const Evaluation& evaluation) {
  nlohmann::json bound = nlohmann::json::array();
  for (const double value : evaluation.bound) bound.push_back(fmt::format("{}", value));
  return bound;
}

}  // namespace

std::string shard_header(const EvaluationSetup& setup, const EvaluationShard& shard) {
  const nlohmann::ordered_json header = {
      {"format", kFormat},
      {"condyle", CONDYLE_VERSION},
      {"note", "simulated subjects; research use only; not a diagnosis"},
      {"shard", shard.number},
      {"of", shard.count},
      {"scenario", setup.scenario},
      {"scenario_text", setup.scenario_text},
      {"estimator", setup.estimator},
      {"settings", settings_text(setup.settings)},
      {"runs", setup.plan.runs},
      {"first_seed", setup.plan.first_seed},
      {"friction_factors", setup.plan.friction_factors},
      {"mass_factors", setup.plan.mass_factors},
      {"bound", bound_json(empty_evaluation(setup.settings))}};
  return header.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) + "\n";
}

std::string run_line(EvaluationRun run) {
  std::string line;
  const auto append = [&line](auto number) { line += fmt::format("{} ", number); };
  visit_numbers(run, append);
  append(run.verdict ? static_cast<int>(*run.verdict) : -1);
  append(run.identified ? 1 : 0);
  if (run.identified) visit_numbers(*run.identified, append);
  for (std::size_t i = 0; i < kEventCount; ++i) append(run.events[static_cast<Event>(i)]);
  line.back() = '\n';
  return line;
}

MergedEvaluation merge_shards(const std::vector<std::string>& paths) {
  std::vector<std::string> of_number;
  nlohmann::json setup;
  for (const std::string& path : paths) {
    const ShardFile file(path);
    if (of_number.empty()) {
      setup = file.setup();
      if (file.shard().count != paths.size()) {
        throw InputError(path,
                         fmt::format("is one of {} shards; {} files are given", file.shard().count,
                                     paths.size()),
                         "give each shard once");
      }
      of_number.resize(paths.size());
    }
    if (file.setup() != setup) {
      throw InputError(path, "belongs to another evaluation than " + paths[0],
                       "give shards of the same scenario, estimator, runs, seed and count");
    }
    std::string& place = of_number[static_cast<std::size_t>(file.shard().number - 1)];
    if (!place.empty()) {
      throw InputError(path, fmt::format("is shard {}, as is {}", file.shard().number, place),
                       "give each shard once");
    }
    place = path;
  }
  MergedEvaluation merged;
  try {
    merged.scenario = setup.at("scenario");
    merged.estimator = setup.at("estimator");
    merged.plan.runs = setup.at("runs");
    merged.plan.first_seed = setup.at("first_seed");
    merged.plan.friction_factors = setup.at("friction_factors").get<std::vector<double>>();
    merged.plan.mass_factors = setup.at("mass_factors").get<std::vector<double>>();
    const auto bound = setup.at("bound").get<std::vector<std::string>>();
    for (std::size_t i = 0; i < std::min(bound.size(), kEvaluatedQuantities); ++i) {
      NumberReader read(bound[i]);
      read(merged.evaluation.bound[i]);
    }
  } catch (const nlohmann::json::exception&) {
    throw InputError(paths[0], "is not a shard of an evaluation", kEvaluateAgain);
  }
  for (const std::string& path : of_number) {
    ShardFile(path).add_runs(merged.plan.runs, merged.evaluation);
  }
  refuse_nothing_compared(merged.scenario, merged.evaluation);
  return merged;
}

}  // namespace condyle::host
