// SPDX-License-Identifier: Apache-2.0
#include "evaluation/evaluation_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "output/event_text.h"

namespace condyle::host {
namespace {

constexpr double kConfidence = 0.99;

constexpr const char* kNotes =
    "\nErrors: of the followed axis at the instant that is estimated. Intervals and bounds at 99 "
    "%, "
    "of the runs' last\nfour fifths; events of all samples. NES: normalised error squared, 1 if "
    "the "
    "standard deviation is right. NIS: of\nthe samples not rejected. Force: the ASSUMED mass times "
    "acceleration, compared with the true net force, effective\nmass times acceleration; its "
    "interval does not include the difference of the masses.\n";

constexpr const char* kPublishedNotes =
    "Acceleration: stage 1's net force over the assumed mass. To bound: error rms over the "
    "Cramer-Rao bound of stage 1's\nown model, a random walk of force; below 1 if the motion is "
    "smoother than that. With the drive unknown there is\nno information on friction and mass, so "
    "their bound is their prior.\n";

constexpr const char* kIdentifiedNotes =
    "Friction and mass: identified from the measured drive; shown if they are measured, given what "
    "the parameters state about\nthe drive. Errors and standard deviations at the end of each run, "
    "of what was fitted, shown or not.\n";

constexpr const char* kRecommendedNotes =
    "Friction and mass are not estimated: position alone does not determine them.\n";

bool has_bound(const Evaluation& evaluation) {
  return std::any_of(evaluation.bound.begin(), evaluation.bound.end(),
                     [](double bound) { return std::isfinite(bound); });
}

template <class Visitor>
void for_computed(const Evaluation& evaluation, const Visitor& visit) {
  for (std::size_t i = 0; i < kEvaluatedQuantities; ++i) {
    if (!evaluation.is_computed(static_cast<EvaluatedIndex>(i))) continue;
    visit(kEvaluated[i], evaluation.errors[i].report(kConfidence), i);
  }
}

std::string error_table(const Evaluation& evaluation) {
  std::string text = fmt::format("{:<12}{:>6} {:>22} {:>22} {:>22} {:>10}", "quantity", "unit",
                                 "error rms", "bias", "coverage of 95 %", "NES");
  text += has_bound(evaluation) ? fmt::format(" {:>8}\n", "to bound") : "\n";
  for_computed(evaluation, [&](const EvaluatedQuantity& quantity, const ErrorReport& r,
                               std::size_t i) {
    text += fmt::format("{:<12}{:>6} {:>22} {:>22} {:>22} {:>10.3g}", quantity.name, quantity.unit,
                        fmt::format("{:.3g} +- {:.1g}", r.rms, r.rms_standard_error),
                        fmt::format("{:.3g} +- {:.1g}", r.bias, r.bias_standard_error),
                        fmt::format("{:.3f} ({:.2f}-{:.2f}){}", r.coverage, r.coverage_interval.low,
                                    r.coverage_interval.high, r.coverage_is_nominal ? "" : " off"),
                        r.mean_normalised_square);
    const double bound = evaluation.bound[i];
    if (std::isfinite(bound)) text += fmt::format(" {:>8.3g}", r.rms / bound);
    text += '\n';
  });
  for (std::size_t i = 0; i < kEvaluatedQuantities; ++i) {
    if (evaluation.is_computed(static_cast<EvaluatedIndex>(i))) continue;
    text += fmt::format("{:<12}{:>6} not estimated\n", kEvaluated[i].name, kEvaluated[i].unit);
  }
  return text;
}

// Samples without a value that other samples have.
std::string missing_text(const Evaluation& evaluation) {
  std::string text;
  std::uint64_t unusable = 0;
  for_computed(evaluation,
               [&](const EvaluatedQuantity& quantity, const ErrorReport& r, std::size_t i) {
                 const std::uint64_t missing = evaluation.not_computed[i];
                 unusable += r.unusable;
                 if (missing == 0) return;
                 text += fmt::format("{:<12}{} not computed at {} of {} samples\n", "no value",
                                     quantity.name, missing, missing + r.samples);
               });
  if (unusable > 0) text += fmt::format("{:<12}{} values were not finite\n", "unusable", unusable);
  return text;
}

std::string consistency_text(const std::string& name, const ConsistencyReport& r) {
  if (r.terms == 0) return {};
  return fmt::format("{:<12}{:.4g}, consistent within {:.4g} to {:.4g}: {}\n", name, r.mean,
                     r.bounds.low, r.bounds.high, r.inside ? "inside" : "OUTSIDE");
}

// NIS and whiteness, of each axis if there are three.
std::string innovations_text(const Evaluation& evaluation) {
  std::string text, correlations;
  for (int axis = 0; axis < evaluation.innovation_axes; ++axis) {
    const auto& [nis, correlation] = evaluation.innovations[static_cast<std::size_t>(axis)];
    const std::string name =
        evaluation.innovation_axes == 3 ? fmt::format(" {}", "xyz"[axis]) : std::string();
    text += consistency_text("NIS" + name, nis.report(kConfidence));
    if (correlation.count() == 0) continue;
    correlations += fmt::format("{}{} {:.3f} +- {:.1g}", correlations.empty() ? "" : ",", name,
                                correlation.mean(), correlation.standard_error());
  }
  if (correlations.empty()) return text;
  return text + fmt::format(
                    "{:<11}{} correlation of neighbouring innovations (0 if the model "
                    "holds)\n",
                    "whiteness", correlations);
}

std::string identified_text(const char* name, const char* unit, const IdentifiedStatistics& of,
                            std::uint64_t runs) {
  std::string limits;
  for (std::size_t i = 1; i < of.limits.size(); ++i) {
    if (of.limits[i] == 0) continue;
    limits += fmt::format("{}{} {}", limits.empty() ? "" : ", ",
                          limit_name(static_cast<ImpedanceLimit>(i)), of.limits[i]);
  }
  return fmt::format(
      "{:<12}shown in {} of {} runs, the 95 % interval contains the truth in {}{}; bias {:.3g}, "
      "error rms {:.3g}, stated sd {:.3g} {}\n",
      name, of.shown, runs, of.covered, limits.empty() ? "" : "; withheld: " + limits,
      of.error.mean(), std::sqrt(of.square.mean()), of.fitted_sd.mean(), unit);
}

std::string slope_text(const char* name, const SlopeReport& r) {
  if (!std::isfinite(r.slope)) {
    return fmt::format("{:<12}no response slope: the truth did not vary\n", name);
  }
  return fmt::format("{:<12}d(estimate)/d(truth) = {:.4f} ({:.4f} to {:.4f})\n", name, r.slope,
                     r.slope_interval.low, r.slope_interval.high);
}

}  // namespace

std::string evaluation_text(const Evaluation& evaluation) {
  std::string text = error_table(evaluation) + missing_text(evaluation);
  text += consistency_text("NEES", evaluation.nees.report(kConfidence));
  text += innovations_text(evaluation);
  const bool has_friction = evaluation.is_computed(kFrictionError);
  if (has_friction) text += slope_text("friction", evaluation.friction_slope.report(kConfidence));
  if (evaluation.is_computed(kMassError)) {
    text += slope_text("mass", evaluation.mass_slope.report(kConfidence));
  }
  if (evaluation.identified > 0) {
    text +=
        identified_text("friction", "Ns/m", evaluation.identified_friction, evaluation.identified) +
        identified_text("mass", "kg", evaluation.identified_mass, evaluation.identified);
  }
  const auto& verdicts = evaluation.verdicts;
  if (verdicts[0] + verdicts[1] + verdicts[2] > 0) {
    text += fmt::format("{:<12}{} matched, {} not matched, {} diverged\n", "verdicts", verdicts[1],
                        verdicts[0], verdicts[2]);
  }
  text += fmt::format("{:<12}{} in {} samples\n", "events", event_text(evaluation.events),
                      evaluation.samples);
  text += kNotes;
  text += evaluation.identified > 0 ? kIdentifiedNotes
          : has_friction            ? kPublishedNotes
                                    : kRecommendedNotes;
  return text;
}

std::string evaluation_csv(const Evaluation& evaluation) {
  std::string text =
      "quantity,unit,error_rms,bias,coverage,mean_normalised_square,ratio_to_bound\n";
  for (std::size_t i = 0; i < kEvaluatedQuantities; ++i) {
    text += fmt::format("{},{}", kEvaluated[i].name, kEvaluated[i].unit);
    const ErrorReport r = evaluation.errors[i].report(kConfidence);
    const bool is_computed = evaluation.is_computed(static_cast<EvaluatedIndex>(i));
    for (const double value :
         {r.rms, r.bias, r.coverage, r.mean_normalised_square, r.rms / evaluation.bound[i]}) {
      text += is_computed && std::isfinite(value) ? fmt::format(",{}", value) : ",";
    }
    text += '\n';
  }
  return text;
}

}  // namespace condyle::host
