// SPDX-License-Identifier: Apache-2.0
#include "tuning/published_tuning_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "hosted/files/number_text.h"

namespace condyle::host {
namespace {

constexpr std::size_t kBestRows = 4, kSpreadRows = 8;  // of the table

std::string entry(const std::string& label, const std::string& words) {
  return fmt::format("{:<14}{}\n", label, words);
}

double free_variance(const FreeVariance& free, PublishedParameters parameters) {
  return free.of(parameters);
}

std::string criterion_text(const PublishedTuningResult& result) {
  return fmt::format(
      "over the last quarter the mass stays within {:g} % of the assumed {:g} kg and friction "
      "varies\n              by at most {:g} % of its mean",
      100 * kMatchingTolerance, result.base.assumed_mass_kg, 100 * result.plan.steady_share);
}

std::string starts_text(const PublishedTuningResult& result) {
  if (result.satisfied == 0) {
    return entry("NOT SATISFIED",
                 fmt::format("by none of {} starts with seed {}", result.starts, result.plan.seed));
  }
  return entry("starts", fmt::format("{} with seed {}: {} satisfy the criterion, {} of them as "
                                     "drawn",
                                     result.starts, result.plan.seed, result.satisfied,
                                     result.satisfied_at_once)) +
         entry("tunings", fmt::format("{} distinct ones, a factor of {:g} apart in some variance",
                                      result.tunings.size(), kDistinctFactor));
}

// Indices of the tunings in the table.
std::vector<std::size_t> rows_shown(const PublishedTuningResult& result) {
  std::vector<std::size_t> rows = tunings_spread_evenly(result, kSpreadRows);
  const std::size_t spread = rows.size();
  for (std::size_t row = 0; row < result.tunings.size() && rows.size() < spread + kBestRows;
       ++row) {
    if (std::find(rows.begin(), rows.end(), row) == rows.end()) rows.push_back(row);
  }
  std::sort(rows.begin(), rows.end());
  return rows;
}

std::string table_text(const PublishedTuningResult& result) {
  const std::vector<PublishedTuning>& tunings = result.tunings;
  std::string text = "  tuning  objective";
  for (const FreeVariance& free : kFreeVariances) text += fmt::format("{:>10}", free.symbol);
  text += "   mass (kg)  friction (Ns/m)\n";
  const std::vector<std::size_t> rows = rows_shown(result);
  for (const std::size_t row : rows) {
    const PublishedTuning& tuning = tunings[row];
    text += fmt::format("{:>8}{:>11.2g}", row + 1, tuning.objective);
    for (const FreeVariance& free : kFreeVariances) {
      text += fmt::format("{:>10.2g}", free_variance(free, tuning.parameters));
    }
    text += fmt::format("{:>12.4f}{:>17.3g}\n", tuning.mass_kg, tuning.friction_Ns_m);
  }
  if (rows.size() < tunings.size()) {
    text += fmt::format("  The best of {}, and others spread over the frictions found.\n",
                        tunings.size());
  }
  for (const FreeVariance& free : kFreeVariances) {
    text += fmt::format("  {:<5} {}\n", free.symbol, free.words);
  }
  return text;
}

std::string recordings_text(const PublishedTuningResult& result) {
  std::string text;
  for (std::size_t i = 0; i < result.recordings.size(); ++i) {
    std::string words = result.recordings[i];
    if (!result.tunings.empty() && result.recordings.size() > 1) {
      const auto friction = [i](const PublishedTuning& tuning) {
        return tuning.recordings[i].friction_Ns_m;
      };
      const auto [lowest, highest] = std::minmax_element(
          result.tunings.begin(), result.tunings.end(),
          [&](const auto& a, const auto& b) { return friction(a) < friction(b); });
      words +=
          fmt::format(": friction {:.3g} to {:.3g} Ns/m", friction(*lowest), friction(*highest));
    }
    text += entry(fmt::format("recording {}", i + 1), words);
  }
  return text;
}

std::string closest_text(const PublishedTuning& closest, const PublishedTuningResult& result) {
  std::string text;
  for (std::size_t i = 0; i < closest.recordings.size(); ++i) {
    const TunedRecording& tuned = closest.recordings[i];
    text += entry(
        i == 0 ? "closest" : "",
        fmt::format("recording {}: {}; mass {:.4g} kg, {:.2g} % error (rms), friction {:.3g} Ns/m, "
                    "which varies by {:.2g} % of it",
                    i + 1, verdict_name(tuned.verdict), tuned.mass_kg, 100 * tuned.mass_deviation,
                    tuned.friction_Ns_m, 100 * tuned.friction_range));
  }
  return text + entry("remedy", fmt::format("record longer, so that the mass settles before the "
                                            "last quarter; widen the bounds; more than {} starts",
                                            result.starts));
}

std::string spread_text(const PublishedTuningResult& result) {
  std::string text = entry(
      "friction", fmt::format("{:.3g} to {:.3g} Ns/m, a factor of {:.3g}, by the choice of tuning "
                              "alone",
                              result.lowest_friction_Ns_m, result.highest_friction_Ns_m,
                              result.friction_ratio()));
  if (result.at_initial_friction > 0) {
    text += entry(
        "", fmt::format("in {} of {} tunings it stays at the initial {:g} Ns/m, within {:g} %",
                        result.at_initial_friction, result.tunings.size(),
                        result.base.friction.initial_Ns_m, 100 * result.plan.steady_share));
  }
  const double m0 = result.base.assumed_mass_kg;
  if (std::abs(result.base.mass.initial_kg - m0) <= kMatchingTolerance * m0) {
    text += entry("note", fmt::format("the initial mass, {:g} kg, is already within {:g} %: even a "
                                      "filter that learns nothing satisfies the criterion",
                                      result.base.mass.initial_kg, 100 * kMatchingTolerance));
  }
  return text;
}

}  // namespace

std::vector<std::size_t> tunings_spread_evenly(const PublishedTuningResult& result,
                                               std::size_t most) {
  std::vector<std::size_t> sorted(result.tunings.size());
  std::iota(sorted.begin(), sorted.end(), std::size_t{0});
  const auto friction = [&](std::size_t i) { return result.tunings[i].friction_Ns_m; };
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](std::size_t a, std::size_t b) { return friction(a) < friction(b); });
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < most && !sorted.empty(); ++i) {
    const double wanted =
        result.lowest_friction_Ns_m *
        std::pow(result.friction_ratio(), static_cast<double>(i) / static_cast<double>(most - 1));
    const auto distance = [&](std::size_t j) { return std::abs(std::log(friction(j) / wanted)); };
    const std::size_t nearest =
        *std::min_element(sorted.begin(), sorted.end(),
                          [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); });
    if (chosen.empty() || chosen.back() != nearest) chosen.push_back(nearest);
  }
  return chosen;
}

std::string published_tuning_text(const PublishedTuningResult& result) {
  std::string text =
      entry("criterion", criterion_text(result)) + starts_text(result) + recordings_text(result);
  if (result.tunings.empty()) {
    if (result.closest) text += closest_text(*result.closest, result);
  } else {
    text += spread_text(result) + "\n" + table_text(result) + "\n" +
            "The criterion does not distinguish these tunings. Friction and mass stay ASSUMED: the "
            "tuning determines them,\nthey are not measurements of the subject. ";
  }
  return text + "Research use only.\n";
}

std::string published_tunings_csv(const PublishedTuningResult& result) {
  std::string text = "tuning,objective";
  for (const FreeVariance& free : kFreeVariances) text += fmt::format(",{}", free.column);
  text += ",friction_Ns_m,friction_provenance,mass_kg,mass_provenance";
  for (std::size_t i = 1; i <= result.recordings.size(); ++i) {
    text += fmt::format(",recording_{0}_friction_Ns_m,recording_{0}_mass_kg", i);
  }
  text += '\n';
  const auto add = [&text](double value) {
    text += ',';
    append_number(text, value);
  };
  for (std::size_t row = 0; row < result.tunings.size(); ++row) {
    const PublishedTuning& tuning = result.tunings[row];
    text += fmt::format("{}", row + 1);
    add(tuning.objective);
    for (const FreeVariance& free : kFreeVariances) add(free_variance(free, tuning.parameters));
    add(tuning.friction_Ns_m);
    text += ",assumed";
    add(tuning.mass_kg);
    text += ",assumed";
    for (const TunedRecording& tuned : tuning.recordings) {
      add(tuned.friction_Ns_m);
      add(tuned.mass_kg);
    }
    text += '\n';
  }
  return text;
}

}  // namespace condyle::host
