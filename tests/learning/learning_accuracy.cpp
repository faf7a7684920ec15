// SPDX-License-Identifier: Apache-2.0
// Prints what learning gains and where it fails: the tables of host_sim/docs/learning.md.
// usage: learning_accuracy [--runs N] [--kernels N] [--lag N] [--float] [NAME...]
// NAME: only the rows whose name begins so.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "learning/joined_course.h"
#include "statistics/monte_carlo.h"

using namespace condyle::testing_support;

namespace {

constexpr std::uint64_t kFirstSeed = 1001;

struct Options {
  std::uint64_t runs = 20;
  int kernels = 96, lag = 0;
  bool is_float = false;
  std::vector<std::string> names;

  bool wants(const std::string& row) const {
    return names.empty() || std::any_of(names.begin(), names.end(), [&](const std::string& name) {
             return row.compare(0, name.size(), name) == 0;
           });
  }
};

struct Row {
  std::string name;
  std::function<Course(std::uint64_t seed)> course;
  std::vector<CourseStretch> stretches = {{}};
  bool is_single = false;  // the same course for every seed
};

// Filter and learned, over stretches and runs.
struct Totals {
  std::vector<double> velocity_ratios, acceleration_ratios;
  double velocity_square = 0;
  double held[4] = {}, lowest[4] = {1, 1, 1, 1};  // velocity: filter, learned; acceleration
  double corrected = 0;

  void add(const CourseScore& filter, const CourseScore& learned) {
    if (filter.samples == 0) return;
    velocity_ratios.push_back(learned.velocity_error_m_s / filter.velocity_error_m_s);
    acceleration_ratios.push_back(learned.acceleration_error_m_s2 / filter.acceleration_error_m_s2);
    velocity_square += filter.velocity_error_m_s * filter.velocity_error_m_s;
    const double shares[4] = {filter.velocity_held, learned.velocity_held, filter.acceleration_held,
                              learned.acceleration_held};
    for (int i = 0; i < 4; ++i) {
      held[i] += shares[i];
      lowest[i] = std::min(lowest[i], shares[i]);
    }
    corrected += learned.corrected;
  }
};

double geometric_mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += std::log(value);
  return std::exp(sum / static_cast<double>(values.size()));
}

void print_row(const std::string& name, std::uint64_t runs, const Totals& totals) {
  const auto n = static_cast<double>(totals.velocity_ratios.size());
  std::printf("| %s | %d | %.2f |", name.c_str(), static_cast<int>(runs),
              1e3 * std::sqrt(totals.velocity_square / n));
  for (const auto* ratios : {&totals.velocity_ratios, &totals.acceleration_ratios}) {
    const double mean = geometric_mean(*ratios);
    if (std::isfinite(mean)) {
      std::printf(" %.3f (%.3f) |", mean, *std::max_element(ratios->begin(), ratios->end()));
    } else {
      std::printf(" |");
    }
  }
  for (int i = 0; i < 4; i += 2) {
    std::printf(" %.1f, %.1f (%.1f, %.1f) |", 100 * totals.held[i] / n,
                100 * totals.held[i + 1] / n, 100 * totals.lowest[i], 100 * totals.lowest[i + 1]);
  }
  std::printf(" %.0f |\n", 100 * totals.corrected / n);
  std::fflush(stdout);
}

using Scores = std::vector<CourseScore>;

Scores scores_of(const Course& course, const Options& options, int kernels, const Row& row) {
  return options.is_float ? score_course<float>(course, kernels, options.lag, row.stretches)
                          : score_course<double>(course, kernels, options.lag, row.stretches);
}

void run(const Row& row, const Options& options) {
  const std::uint64_t runs = row.is_single ? 1 : options.runs;
  Totals totals;
  condyle::host::run_monte_carlo(
      runs, kFirstSeed,
      [&](std::uint64_t seed) {
        const Course course = row.course(seed);
        return std::pair(scores_of(course, options, 0, row),
                         scores_of(course, options, options.kernels, row));
      },
      [&](const std::pair<Scores, Scores>& both) {
        for (std::size_t i = 0; i < both.first.size(); ++i) {
          totals.add(both.first[i], both.second[i]);
        }
      });
  print_row(row.name, runs, totals);
}

Row simulated(const std::string& name, const CourseSettings& settings, double from_s = 12) {
  return {name,
          [settings](std::uint64_t seed) { return simulate_course(settings, seed); },
          {{from_s, 1e9}}};
}

std::vector<Row> rows() {
  std::vector<Row> rows;
  for (const char* const name :
       {"motion_60hz_20um", "motion_60hz_100um", "motion_60hz_300um", "motion_200hz_100um",
        "motion_irregular_60hz_50um", "motion_irregular_200hz_50um"}) {
    rows.push_back({name, [name](std::uint64_t) { return read_course(name); }, {{}}, true});
  }
  const auto in_words = [](const std::string& name, double rate_Hz, double noise_m) {
    char text[100];
    std::snprintf(text, sizeof text, "%s, %g Hz, %g um", name.c_str(), rate_Hz, noise_m * 1e6);
    return std::string(text);
  };
  const auto add = [&](const std::string& name, CourseSettings settings, double rate_Hz,
                       double noise_m, double from_s = 12) {
    settings.rate_Hz = rate_Hz;
    settings.noise_m = noise_m;
    rows.push_back(simulated(in_words(name, rate_Hz, noise_m), settings, from_s));
  };
  add("chewing", {.scenario = "chewing"}, 60, 100e-6);
  add("chewing", {.scenario = "chewing"}, 60, 20e-6);
  add("chewing", {.scenario = "chewing"}, 200, 50e-6);
  add("chewing", {.scenario = "chewing"}, 100, 200e-6);
  add("chewing", {.scenario = "chewing"}, 500, 100e-6);
  add("regular chewing", {.scenario = "chewing", .is_regular = true}, 60, 100e-6);
  add("regular chewing", {.scenario = "chewing", .is_regular = true}, 200, 100e-6);
  for (const char* const scenario :
       {"prescribed", "side_to_side", "free_opening", "protrusion", "rest", "clench"}) {
    std::string name = scenario;
    std::replace(name.begin(), name.end(), '_', ' ');
    add(name, {.scenario = scenario}, 60, 50e-6);
    add(name, {.scenario = scenario}, 200, 100e-6);
  }
  const CourseSettings chewing = {.scenario = "chewing"};
  const auto changed = [&](auto change) {
    CourseSettings settings = chewing;
    change(settings);
    return settings;
  };
  add("glitches 1 %, lost 2 %", changed([](CourseSettings& s) {
        s.glitch_share = 0.01;
        s.lost_share = 0.02;
      }),
      60, 100e-6);
  add("jitter 1 ms", changed([](CourseSettings& s) { s.jitter_s = 1e-3; }), 60, 100e-6);
  add("rounded to 50 um", changed([](CourseSettings& s) { s.quantum_m = 50e-6; }), 200, 20e-6);
  add("dropout and freeze", changed([](CourseSettings& s) { s.has_faults = true; }), 60, 100e-6);
  add("smoothed, 0.4", changed([](CourseSettings& s) { s.smoothing = 0.4; }), 60, 100e-6);
  add("smoothed, 0.4", changed([](CourseSettings& s) { s.smoothing = 0.4; }), 200, 100e-6);
  for (const double tremor_m : {0.0, 50e-6}) {
    CourseSettings rest = {.scenario = "rest"};
    rest.tremor_m = tremor_m;
    add(tremor_m > 0 ? "rest, tremor 50 um" : "rest, tremor 0", rest, 60, 50e-6);
  }
  add("first 12 s of chewing", changed([](CourseSettings& s) { s.duration_s = 12; }), 60, 100e-6,
      0.5);
  add("chewing of 4 min", changed([](CourseSettings& s) { s.duration_s = 240; }), 60, 100e-6);
  constexpr const char* kChanges[] = {"stops", "doubles", "reverses"};
  for (int change = 0; change < 3; ++change) {
    for (const double rate_Hz : {60.0, 500.0}) {
      for (const double after_s : {0.1, 0.5, 4.0}) {
        char name[100];
        std::snprintf(name, sizeof name, "velocity %s, %g Hz: first %g s", kChanges[change],
                      rate_Hz, after_s);
        rows.push_back({name,
                        [change, rate_Hz](std::uint64_t seed) {
                          return changing_course(static_cast<SuddenChange>(change), rate_Hz, 100e-6,
                                                 seed);
                        },
                        {{kChange_s, kChange_s + after_s}}});
      }
    }
  }
  Row joined = {"eight motions: 2 s after each change",
                [](std::uint64_t seed) { return joined_course(60, 50e-6, seed); },
                {}};
  for (int part = 1; part < kParts; ++part) {
    joined.stretches.push_back({part * kPart_s, part * kPart_s + 2});
  }
  rows.push_back(joined);
  joined.name = "eight motions: all";
  joined.stretches = {{12, 1e9}};
  rows.push_back(joined);
  return rows;
}

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto number = [&] {
      if (++i == argc) {
        std::fprintf(stderr, "learning_accuracy: %s needs a number\n", word.c_str());
        std::exit(2);
      }
      return std::atoi(argv[i]);
    };
    if (word == "--runs") {
      options.runs = static_cast<std::uint64_t>(number());
    } else if (word == "--kernels") {
      options.kernels = number();
    } else if (word == "--lag") {
      options.lag = number();
    } else if (word == "--float") {
      options.is_float = true;
    } else {
      options.names.push_back(word);
    }
  }
  return options;
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = parse(argc, argv);
  std::puts(
      "| motion | runs | velocity error of the filter (mm/s) | velocity: ratio, mean (worst) | "
      "acceleration: ratio, mean (worst) | velocity intervals that hold (%): filter, learned "
      "(lowest) | acceleration intervals (%) | corrected (%) |\n|---|---|---|---|---|---|---|---|");
  for (const Row& row : rows()) {
    if (options.wants(row.name)) run(row, options);
  }
}
