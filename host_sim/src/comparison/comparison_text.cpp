// SPDX-License-Identifier: Apache-2.0
#include "comparison/comparison_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "comparison/figure_label.h"
#include "hosted/files/clean_text.h"
#include "hosted/files/number_text.h"

namespace condyle::host {
namespace {

std::string shown(double value, double per_SI, const char* format = "{:.4g}") {
  return std::isfinite(value) ? fmt::format(fmt::runtime(format), per_SI * value) : "-";
}

constexpr std::size_t kLongestLabel = 36;

std::string label_of(const NamedEstimator& estimator) {
  return figure_label(estimator.name, kLongestLabel);
}

// Width of the names, at least that of the heading.
std::size_t name_width(const std::vector<NamedEstimator>& estimators) {
  std::size_t width = 9;
  for (const NamedEstimator& estimator : estimators) {
    width = std::max(width, label_of(estimator).size());
  }
  return width;
}

std::string score_text(const RunReport& run, bool is_first) {
  if (is_first) return "first";
  const BlockMean& difference = run.score_difference;
  if (!std::isfinite(difference.mean)) return "-";
  if (difference.blocks == 0) {
    return fmt::format("{:+.3g}, interval not known: too short", difference.mean);
  }
  return fmt::format("{:+.3g} ({:+.3g} to {:+.3g}): {}", difference.mean, difference.interval.low,
                     difference.interval.high,
                     !difference.differs_from_zero() ? "no detectable difference"
                     : difference.mean > 0           ? "predicts better"
                                                     : "predicts worse");
}

std::string prediction_text(const std::vector<NamedEstimator>& estimators,
                            const RecordingReport& recording, std::size_t width) {
  std::string text = fmt::format(
      "  {:<{}}  error rms, median (mm)  mean NIS (95 % if right)  correlation  log score to the "
      "first (95 %)\n",
      "predicted", width);
  for (std::size_t i = 0; i < estimators.size(); ++i) {
    const RunReport& run = recording.runs[i];
    const std::string error = shown(run.error_rms_m, 1e3) + ", " + shown(run.error_median_m, 1e3);
    const std::string nis = run.nis_samples == 0
                                ? "-"
                                : fmt::format("{:.3f} ({:.3f} to {:.3f})", run.mean_nis,
                                              run.nis_bounds.low, run.nis_bounds.high);
    text += fmt::format("  {:<{}}  {:<22}  {:<24}  {:<11}  {}\n", label_of(estimators[i]), width,
                        error, nis, shown(run.correlation, 1, "{:.2f}"), score_text(run, i == 0));
  }
  return text;
}

std::string motion_text(const std::vector<NamedEstimator>& estimators,
                        const RecordingReport& recording, std::size_t width) {
  std::string text = fmt::format(
      "  {:<{}}  range (mm)  velocity rms, peaks + and - (mm/s)  to the first  noise sd (mm)  jerk "
      "(m^2/s^5)  missing, rejected\n",
      "motion", width);
  for (std::size_t i = 0; i < estimators.size(); ++i) {
    const RunReport& run = recording.runs[i];
    const std::string velocity = shown(run.velocity_rms_m_s, 1e3) + ", " +
                                 shown(run.velocity_peak_up_m_s, 1e3) + ", " +
                                 shown(run.velocity_peak_down_m_s, 1e3);
    text += fmt::format("  {:<{}}  {:<10}  {:<35}  {:<12}  {:<13}  {:<14}  {}, {}\n",
                        label_of(estimators[i]), width, shown(run.range_m, 1e3), velocity,
                        i == 0 ? "first" : shown(run.velocity_difference_m_s, 1e3),
                        shown(run.noise_sd_m, 1e3, "{:.3g}"),
                        shown(run.jerk_density_m2_s5, 1, "{:.3g}"), run.missing, run.rejected);
  }
  return text;
}

std::string quantity_text(const Quantity<double>& quantity, const char* unit) {
  if (quantity.provenance != Provenance::measured) {
    return fmt::format("{:.4g} {}, {}, no finding", quantity.value, unit,
                       provenance_name(quantity.provenance));
  }
  return fmt::format("{:.4g} (sd {:.2g}) {}, measured", quantity.value, quantity.standard_deviation,
                     unit);
}

std::string friction_text(const std::vector<NamedEstimator>& estimators,
                          const RecordingReport& recording) {
  std::string text;
  for (std::size_t i = 0; i < estimators.size(); ++i) {
    const RunReport& run = recording.runs[i];
    if (run.friction_Ns_m.provenance == Provenance::not_computed) continue;
    text += fmt::format("  {}: friction {}; mass {}\n", label_of(estimators[i]),
                        quantity_text(run.friction_Ns_m, "Ns/m"), quantity_text(run.mass_kg, "kg"));
  }
  return text;
}

const char* noise_provenance(const RunReport& run) {
  return std::isfinite(run.noise_sd_m) ? "estimated" : "";
}

// "not_judged" is not "none".
std::string warning_names(const RunReport& run) {
  if (!run.is_whiteness_judged) return "not_judged";
  if (run.is_filtered) return run.is_correlated ? "filtered|correlated" : "filtered";
  return run.is_correlated ? "correlated" : "none";
}

void append_quantity(std::string& text, const Quantity<double>& quantity) {
  text += ',';
  append_number(text, quantity.value);
  text += ',';
  // The filter's interval for an assumed value depends only on its tuning.
  if (quantity.provenance == Provenance::measured) append_number(text, quantity.standard_deviation);
  text += fmt::format(",{}", provenance_name(quantity.provenance));
}

}  // namespace

std::string warning_text(const RunReport& run) {
  if (run.is_filtered) {
    return "the noise is not white: the positions were smoothed or otherwise filtered before they "
           "were recorded";
  }
  if (run.is_correlated) {
    return "neighbouring innovations are correlated: the positions were smoothed, or the motion "
           "does not fit the model";
  }
  return {};
}

std::string comparison_text(const std::vector<NamedEstimator>& estimators,
                            const std::vector<RecordingReport>& recordings) {
  const std::size_t width = name_width(estimators);
  std::string text;
  std::size_t tests = 0, findings = 0;
  bool has_assumed = false;
  for (const RecordingReport& recording : recordings) {
    text += fmt::format("{}, {}: {} samples, {:.4g} s, {} gaps; {} predicted by all\n",
                        clean_line(recording.source), recording.format, recording.samples,
                        recording.duration_s, recording.gaps, recording.compared);
    for (const std::string& note : recording.notes) text += fmt::format("  note: {}\n", note);
    text += prediction_text(estimators, recording, width) +
            motion_text(estimators, recording, width) + friction_text(estimators, recording);
    for (std::size_t i = 0; i < estimators.size(); ++i) {
      const RunReport& run = recording.runs[i];
      if (const std::string warning = warning_text(run); !warning.empty()) {
        text += fmt::format(
            "  note: {}: {}; intervals are not to be relied on, and better predictions of such "
            "positions do not imply better tracking of the jaw\n",
            label_of(estimators[i]), warning);
      }
      has_assumed = has_assumed || run.friction_Ns_m.provenance == Provenance::assumed;
      tests += run.score_difference.blocks > 0 && i > 0 ? 1U : 0U;
      findings += run.score_difference.differs_from_zero() && i > 0 ? 1U : 0U;
    }
    text += '\n';
  }
  if (tests > 0) {
    text += fmt::format(
        "{} of {} comparisons of predictions differ; if estimators predict equally well, one in 20 "
        "differs by chance ({:.2g} of these).\n",
        findings, tests, 0.05 * static_cast<double>(tests));
  }
  if (has_assumed) {
    text +=
        "Prior and tuning determine assumed friction and mass; these values and their differences "
        "do not describe the subject.\n";
  }
  return text;
}

std::string comparison_csv(const std::vector<NamedEstimator>& estimators,
                           const std::vector<RecordingReport>& recordings) {
  std::string text =
      "recording,estimator,samples,duration_s,step_s,gaps,missing,rejected,measured_share,"
      "predicted_by_all,prediction_error_rms_mm,prediction_error_median_mm,log_score,"
      "log_score_difference,log_score_difference_se,log_score_difference_low,"
      "log_score_difference_high,blocks,mean_nis,nis_samples,nis_low,nis_high,"
      "innovation_correlation,warning,range_mm,velocity_rms_mm_s,velocity_peak_positive_mm_s,"
      "velocity_peak_negative_mm_s,velocity_difference_rms_mm_s,noise_sd_mm,jerk_density_m2_s5,"
      "noise_provenance,friction_Ns_m,friction_sd_Ns_m,friction_provenance,mass_kg,mass_sd_kg,"
      "mass_provenance\n";
  const auto numbers = [&text](std::initializer_list<double> values) {
    for (const double value : values) {
      text += ',';
      append_number(text, value);
    }
  };
  for (const RecordingReport& recording : recordings) {
    for (std::size_t i = 0; i < estimators.size(); ++i) {
      const RunReport& run = recording.runs[i];
      const BlockMean& difference = run.score_difference;
      text += fmt::format("{},{},{}", csv_field(recording.source), csv_field(estimators[i].name),
                          recording.samples);
      numbers({recording.duration_s, recording.step_s});
      text += fmt::format(",{},{},{}", recording.gaps, run.missing, run.rejected);
      numbers({run.measured_share});
      text += fmt::format(",{}", recording.compared);
      numbers({1e3 * run.error_rms_m, 1e3 * run.error_median_m, run.score, difference.mean,
               difference.standard_error, difference.interval.low, difference.interval.high});
      text += fmt::format(",{}", difference.blocks);
      numbers({run.mean_nis});
      text += fmt::format(",{}", run.nis_samples);
      numbers({run.nis_bounds.low, run.nis_bounds.high, run.correlation});
      text += "," + warning_names(run);
      numbers({1e3 * run.range_m, 1e3 * run.velocity_rms_m_s, 1e3 * run.velocity_peak_up_m_s,
               1e3 * run.velocity_peak_down_m_s, 1e3 * run.velocity_difference_m_s,
               1e3 * run.noise_sd_m, run.jerk_density_m2_s5});
      text += fmt::format(",{}", noise_provenance(run));
      append_quantity(text, run.friction_Ns_m);
      append_quantity(text, run.mass_kg);
      text += '\n';
    }
  }
  return text;
}

}  // namespace condyle::host
