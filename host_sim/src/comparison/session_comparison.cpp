// SPDX-License-Identifier: Apache-2.0
#include "comparison/session_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "comparison/repeat_order.h"
#include "hosted/files/input_error.h"

namespace condyle::host {
namespace {

constexpr double kDetectionShare = 0.95;
// With rates that differ by more, the estimators see different motions.
constexpr double kRateTolerance = 0.05;

// Larger differences in duration, or in the noise of sessions, change the quantities that depend on
// them.
constexpr double kLongerDuration = 1.2, kMoreNoise = 1.5;
// Probability below which successive repeats count as alike.
constexpr double kAlikeByChance = 0.01;

// A quantity and its place in a report.
struct ComparedQuantity {
  const char *name, *column, *unit;
  double (*value)(const RunReport&);
  const char* missing;                              // the reason if there is no value
  unsigned depends_on = kNothing;                   // in addition to the subject
  double (*stated_sd)(const RunReport&) = nullptr;  // not visible in repeats
};

const char* axes_text(SampleKind kind) {
  return kind == SampleKind::one_axis ? "positions along one axis" : "positions along three axes";
}

double measured_value(const Quantity<double>& quantity) {
  return quantity.provenance == Provenance::measured ? quantity.value : EstimateRow::kNone;
}

constexpr const char* kNoMotion = "no sample measures it";
constexpr const char* kNoNoise =
    "it is not learned, it is at its lowest or highest value most of the time, or the positions "
    "were smoothed";
constexpr const char* kNotMeasured = "it is not measured";

const ComparedQuantity kQuantities[] = {
    {"range of motion", "range", "mm", [](const RunReport& r) { return 1e3 * r.range_m; },
     kNoMotion, kDuration | kNoise},
    {"velocity, rms", "velocity_rms", "mm/s",
     [](const RunReport& r) { return 1e3 * r.velocity_rms_m_s; }, kNoMotion, kNoise},
    {"peak velocity, positive", "velocity_peak_positive", "mm/s",
     [](const RunReport& r) { return 1e3 * r.velocity_peak_up_m_s; }, kNoMotion, kNoise},
    {"peak velocity, negative", "velocity_peak_negative", "mm/s",
     [](const RunReport& r) { return 1e3 * r.velocity_peak_down_m_s; }, kNoMotion, kNoise},
    {"jerk density", "jerk_density", "m^2/s^5",
     [](const RunReport& r) { return r.jerk_density_m2_s5; }, kNoNoise, kDuration | kNoise},
    {"noise of the instrument", "noise_sd", "mm",
     [](const RunReport& r) { return 1e3 * r.noise_sd_m; }, kNoNoise},
    {"friction", "friction", "Ns/m",
     [](const RunReport& r) { return measured_value(r.friction_Ns_m); }, kNotMeasured, kNothing,
     [](const RunReport& r) { return r.friction_Ns_m.standard_deviation; }},
    {"mass", "mass", "kg", [](const RunReport& r) { return measured_value(r.mass_kg); },
     kNotMeasured, kNothing, [](const RunReport& r) { return r.mass_kg.standard_deviation; }},
};

bool is_copy(const RunReport& a, const RunReport& b) {
  // Noise makes the prediction errors of any two recordings different, so equal ones reveal a copy.
  return std::isfinite(a.score) && a.score == b.score && a.error_rms_m == b.error_rms_m &&
         a.range_m == b.range_m;
}

void refuse_incomparable(const std::vector<Session>& sessions) {
  std::vector<const RecordingReport*> all;
  for (const Session& session : sessions) {
    for (const RecordingReport& recording : session.recordings) all.push_back(&recording);
  }
  const RecordingReport& first = *all[0];
  for (std::size_t i = 0; i < all.size(); ++i) {
    const RecordingReport& recording = *all[i];
    const double ratio = recording.step_s / first.step_s;
    const bool has_rates = recording.step_s > 0 && first.step_s > 0;
    if (has_rates && (ratio > 1 + kRateTolerance || ratio < 1 / (1 + kRateTolerance))) {
      throw InputError(recording.source,
                       fmt::format("has {:.4g} samples a second, {} has {:.4g}; another rate shows "
                                   "other velocities of the same motion",
                                   1 / recording.step_s, first.source, 1 / first.step_s),
                       "compare recordings of one rate");
    }
    if ((recording.kind == SampleKind::one_axis) != (first.kind == SampleKind::one_axis)) {
      throw InputError(recording.source,
                       fmt::format("holds {}, {} holds {}", axes_text(recording.kind), first.source,
                                   axes_text(first.kind)),
                       "compare recordings of one kind");
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (!is_copy(recording.runs[0], all[k]->runs[0])) continue;
      throw InputError(recording.source,
                       "is a copy of " + all[k]->source + ", which is not a repeat",
                       "give each recording once");
    }
  }
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// Mean square of the standard deviations that a session's recordings state; the error is common to
// all, so more recordings do not reduce it.
double stated_variance(const ComparedQuantity& quantity, const Session& session) {
  if (quantity.stated_sd == nullptr) return 0;
  double sum = 0;
  for (const RecordingReport& recording : session.recordings) {
    const double sd = quantity.stated_sd(recording.runs[0]);
    sum += sd * sd;
  }
  return sum / static_cast<double>(session.recordings.size());
}

QuantityComparison compare_quantity(const ComparedQuantity& quantity,
                                    const std::vector<Session>& sessions) {
  QuantityComparison result{quantity.name, quantity.column, quantity.unit, {}, {}, {}, {}, 0, {}};
  std::size_t missing = 0, recordings = 0;
  for (const Session& session : sessions) {
    std::vector<double> values;
    for (const RecordingReport& recording : session.recordings) {
      values.push_back(quantity.value(recording.runs[0]));
      missing += std::isfinite(values.back()) ? 0U : 1U;
      ++recordings;
    }
    result.values.push_back(std::move(values));
  }
  if (missing > 0) {
    result.withheld =
        fmt::format("in {} of {} recordings {}", missing, recordings, quantity.missing);
    return result;
  }
  result.withheld = differing_conditions(sessions, quantity.depends_on);
  if (!result.withheld.empty()) return result;
  std::vector<double> variances;  // stated
  for (const Session& session : sessions) variances.push_back(stated_variance(quantity, session));
  compare_values(variances, result);
  return result;
}

// Of a difference of means.
struct Spread {
  double sd, degrees_of_freedom;
};

Spread spread_of(const Repeatability& repeats, std::size_t n_1, std::size_t n_2,
                 double stated_variance) {
  const double of_repeats = repeats.within_sd * repeats.within_sd *
                            (1 / static_cast<double>(n_1) + 1 / static_cast<double>(n_2));
  const double variance = of_repeats + stated_variance;
  const double share = variance / of_repeats;
  return {std::sqrt(variance), share * share * static_cast<double>(repeats.degrees_of_freedom)};
}

}  // namespace

double Repeatability::smallest_change(std::size_t n_1, std::size_t n_2,
                                      double stated_variance) const {
  if (!is_known()) return EstimateRow::kNone;
  const Spread spread = spread_of(*this, n_1, n_2, stated_variance);
  return student_t_quantile((1 + kDetectionShare) / 2, spread.degrees_of_freedom) * spread.sd;
}

double Repeatability::probability(double change, std::size_t n_1, std::size_t n_2,
                                  double stated_variance) const {
  if (!is_known()) return EstimateRow::kNone;
  const Spread spread = spread_of(*this, n_1, n_2, stated_variance);
  return 2 * student_t_distribution(-std::abs(change) / spread.sd, spread.degrees_of_freedom);
}

Repeatability repeatability(const std::vector<std::vector<double>>& sessions) {
  Repeatability result;
  double squares = 0;
  for (const auto& values : sessions) {
    if (values.empty()) continue;
    const double mean = mean_of(values);
    for (const double value : values) squares += (value - mean) * (value - mean);
    result.degrees_of_freedom += values.size() - 1;
  }
  const auto dof = static_cast<double>(result.degrees_of_freedom);
  result.within_sd = std::sqrt(squares / dof);  // 0 / 0: NaN
  if (result.is_known()) {
    const double tail = (1 - kDetectionShare) / 2;
    result.interval = {std::sqrt(squares / chi_square_quantile(1 - tail, dof)),
                       std::sqrt(squares / chi_square_quantile(tail, dof))};
  }
  return result;
}

std::vector<double> holm_adjusted(const std::vector<double>& probabilities) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < probabilities.size(); ++i) {
    if (!std::isnan(probabilities[i])) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return probabilities[a] < probabilities[b];
  });
  std::vector<double> adjusted = probabilities;
  double largest = 0;
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    const auto remaining = static_cast<double>(order.size() - rank);
    largest = std::max(largest, std::min(1.0, remaining * probabilities[order[rank]]));
    adjusted[order[rank]] = largest;
  }
  return adjusted;
}

std::size_t SessionComparison::tests() const {
  std::size_t count = 0;
  for (const QuantityComparison& quantity : quantities) {
    if (quantity.repeats.is_known()) count += quantity.changes.size();
  }
  return count;
}

std::string differing_conditions(const std::vector<Session>& sessions, unsigned depends_on) {
  double shortest_s = std::numeric_limits<double>::infinity(), longest_s = 0;
  double least_m = shortest_s, most_m = 0;  // mean noise of a session
  for (const Session& session : sessions) {
    double noise_m = 0;
    for (const RecordingReport& recording : session.recordings) {
      shortest_s = std::min(shortest_s, recording.duration_s);
      longest_s = std::max(longest_s, recording.duration_s);
      noise_m += recording.runs[0].noise_sd_m / static_cast<double>(session.recordings.size());
    }
    if (!std::isfinite(noise_m)) continue;
    least_m = std::min(least_m, noise_m);
    most_m = std::max(most_m, noise_m);
  }
  if ((depends_on & kDuration) != 0 && longest_s > kLongerDuration * shortest_s) {
    return fmt::format(
        "the recordings last {:.3g} to {:.3g} s, and a longer recording gives a larger value; "
        "compare recordings of one duration",
        shortest_s, longest_s);
  }
  if ((depends_on & kNoise) != 0 && most_m > kMoreNoise * least_m) {
    return fmt::format(
        "the noise of the instrument is {:.2g} mm in one session and {:.2g} mm in another, and the "
        "noise changes this quantity; compare recordings of one instrument and set-up",
        1e3 * least_m, 1e3 * most_m);
  }
  return "";
}

void compare_values(const std::vector<double>& stated_variances, QuantityComparison& quantity) {
  const auto& values = quantity.values;
  const double by_chance = probability_of_order(values);
  if (by_chance < kAlikeByChance) {
    quantity.withheld = fmt::format(
        "successive repeats are more alike than by chance (probability {:.2g}), so their scatter "
        "does not predict that between sessions; spread the repeats, or mix their order",
        by_chance);
    return;
  }
  for (const auto& of_session : values) quantity.means.push_back(mean_of(of_session));
  quantity.repeats = repeatability(values);
  const double largest = *std::max_element(stated_variances.begin(), stated_variances.end());
  quantity.smallest_single = quantity.repeats.smallest_change(1, 1, 2 * largest);
  for (std::size_t to = 1; to < values.size(); ++to) {
    for (std::size_t from = 0; from < to; ++from) {
      const std::size_t n_1 = values[from].size(), n_2 = values[to].size();
      const double change = quantity.means[to] - quantity.means[from];
      const double stated = stated_variances[from] + stated_variances[to];
      quantity.changes.push_back({from, to, change,
                                  quantity.repeats.smallest_change(n_1, n_2, stated),
                                  kNormalQuantile95 * std::sqrt(stated),
                                  quantity.repeats.probability(change, n_1, n_2, stated), 0});
    }
  }
}

void adjust_probabilities(SessionComparison& comparison) {
  std::vector<double> probabilities;
  for (const QuantityComparison& quantity : comparison.quantities) {
    for (const SessionChange& change : quantity.changes) {
      probabilities.push_back(change.probability);
    }
  }
  const std::vector<double> adjusted = holm_adjusted(probabilities);
  std::size_t next = 0;
  for (QuantityComparison& quantity : comparison.quantities) {
    for (SessionChange& change : quantity.changes) change.adjusted_probability = adjusted[next++];
  }
}

SessionComparison compare_sessions(const std::vector<Session>& sessions) {
  refuse_incomparable(sessions);
  SessionComparison result;
  for (const ComparedQuantity& quantity : kQuantities) {
    result.quantities.push_back(compare_quantity(quantity, sessions));
  }
  adjust_probabilities(result);
  return result;
}

}  // namespace condyle::host
