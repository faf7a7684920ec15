// SPDX-License-Identifier: Apache-2.0
#include "tuning/tuning_report.h"
#include "hosted/files/clean_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace condyle::host {
namespace {

constexpr std::size_t kMostNamed = 8;

std::string line(const std::string& label, const std::string& words) {
  return fmt::format("{:<16}{}\n", label, clean_line(words));
}

struct Unit {
  const char* name;
  const char* text;
  double scale;
};
constexpr Unit kUnits[] = {
    {"noise (sd)", "mm", 1e3}, {"jerk density", "m^2/s^5", 1}, {"correlation", "ms", 1e3}};

constexpr const char* kOfModel = "of white noise and white jerk";

// `rests_on`: the condition of the interval, which is that of the best-fitting model, not of the
// instrument.
std::string parameter_text(const FittedParameter& parameter, const Unit& unit,
                           const char* rests_on = kOfModel) {
  if (parameter.at_bound) {
    return fmt::format("{:.4g} {}: at its bound, so it is NOT known", unit.scale * parameter.value,
                       unit.text);
  }
  if (!parameter.is_bounded || !std::isfinite(parameter.log_sd)) {
    return fmt::format("NOT known: the likelihood hardly depends on it (best {:.4g} {})",
                       unit.scale * parameter.value, unit.text);
  }
  const double factor = std::exp(1.96 * parameter.log_sd);
  return fmt::format("{:.4g} {} ({:.4g} to {:.4g}: 95 % of fits, {})", unit.scale * parameter.value,
                     unit.text, unit.scale * parameter.value / factor,
                     unit.scale * parameter.value * factor, rests_on);
}

// `text` without characters that a TOML comment must not contain, because file names may contain
// any.
std::string in_comment(const std::string& text) {
  std::string clean;
  for (const char c : text) clean += c >= 0x20 && c < 0x7f ? c : '?';
  return clean;
}

const char* doubt_of(const LikelihoodTuning& tuning) {
  return tuning.correlated ? "if the noise were white, which it is not" : kOfModel;
}

std::string unique_text(const FittedModel& model, std::size_t starts) {
  const SearchOptimum& best = model.search.optima.front();
  std::string text =
      fmt::format("{} of {} starts, with variances wrong by factors up to {:g}, reached it",
                  best.reached_by, starts, kStartFactor);
  if (model.search.optima.size() > 1) {
    text += fmt::format("; the next best is {:.3g} worse in log likelihood",
                        best.value - model.search.optima[1].value);
  }
  return text + (model.is_unique ? "" : ": NOT unique, other values fit as well");
}

std::string check_text(const CrossValidation& check) {
  return line("held out",
              fmt::format("{} positions: mean NIS {:.3f}, {} the 95 % bounds {:.3f} to {:.3f}",
                          check.count, check.mean_nis, check.nis_inside ? "inside" : "OUTSIDE",
                          check.nis_bounds.low, check.nis_bounds.high));
}

// Of several recordings, those that the values fit worst, and whether this exceeds chance.
std::string extremes_text(const std::vector<TuningRecording>& recordings,
                          const CrossValidation& check) {
  if (recordings.size() < 2) return "";
  struct OfRecording {
    double sum = 0;
    std::uint64_t held_out = 0, all = 0;
    double mean() const { return sum / static_cast<double>(held_out); }
  };
  std::vector<OfRecording> of(recordings.size());
  for (const StretchInnovations& stretch : check.stretches) {
    OfRecording& one = of[stretch.recording];
    one.all += stretch.count;
    if (!stretch.is_held_out) continue;
    one.sum += stretch.mean_nis * static_cast<double>(stretch.count);
    one.held_out += stretch.count;
  }
  const double confidence = 1 - 0.05 / static_cast<double>(recordings.size());
  std::size_t lowest = 0, highest = 0, outside = 0;
  for (std::size_t i = 0; i < of.size(); ++i) {
    if (of[i].held_out == 0) continue;
    if (of[lowest].held_out == 0 || of[i].mean() < of[lowest].mean()) lowest = i;
    if (of[highest].held_out == 0 || of[i].mean() > of[highest].mean()) highest = i;
    const std::uint64_t as_good_as = of[i].held_out * (of[i].all - of[i].held_out) / of[i].all;
    if (as_good_as == 0) continue;
    outside += mean_chi_square_bounds(1, as_good_as, confidence).contains(of[i].mean()) ? 0U : 1U;
  }
  if (of[lowest].held_out == 0) return "";
  std::string text =
      line("", fmt::format("lowest {:.2f} ({}), highest {:.2f} ({})", of[lowest].mean(),
                           recordings[lowest].name, of[highest].mean(), recordings[highest].name));
  if (outside > 0) {
    text += line("", fmt::format("OUTSIDE its own bounds in {} of {} recordings: one noise and one "
                                 "jerk density do not fit them all; tune each instrument alone",
                                 outside, recordings.size()));
  }
  return text;
}

// Whether the fixed values predict better than the estimator that adapts.
std::string adaptive_text(const CrossValidation& check) {
  if (!std::isfinite(check.advantage_se)) return "";
  const double sd = 1.96 * check.advantage_se;
  const char* verdict = check.advantage - sd > 0   ? "better than"
                        : check.advantage + sd < 0 ? "WORSE than"
                                                   : "as well as";
  return line("adaptation", fmt::format("these fixed values predict the held-out part {} the "
                                        "estimator that adapts: {:+.3f} +- {:.3f} per sample",
                                        verdict, check.advantage, sd)) +
         line("", "(mean difference of log likelihoods; 95 %)");
}

std::string correlated_text(const LikelihoodPlan& plan, const LikelihoodTuning& tuning) {
  const FittedModel& model = *tuning.correlated;
  if (!tuning.correlated_serves) {
    return line("NOT WHITE",
                "the noise is not white, and no Gauss-Markov noise explains it "
                "better: the intervals of any") +
           line("", "filter here are not reliable; record without smoothing");
  }
  std::string text = line(
      "NOT WHITE",
      "the manufacturer's filter smoothed it; correlated noise (Gauss-Markov) explains it better:");
  for (std::size_t i = 0; i < model.parameters.size(); ++i) {
    text +=
        line(fmt::format("  {}", kUnits[i].name), parameter_text(model.parameters[i], kUnits[i]));
  }
  text += line("  optimum", unique_text(model, plan.starts));
  text += check_text(model.held_out) + line("", whiteness_text(model.held_out));
  const EquivalentWhiteNoise& stand_in = *tuning.stand_in;
  text += line("stand-in",
               "condyle's filters assume white noise. The output contains the white values that "
               "fit best here:");
  const std::string best = std::isfinite(stand_in.best_velocity_error_m_s)
                               ? fmt::format(" (the correlated model's own filter: {:.2g})",
                                             1e3 * stand_in.best_velocity_error_m_s)
                               : "";
  text +=
      line("", fmt::format("{:.4g} mm, {:.4g} m^2/s^5: velocity within {:.2g} mm/s rms{},",
                           1e3 * tuning.written.position_sd_m, tuning.written.jerk_density_m2_s5,
                           1e3 * stand_in.velocity_error_m_s, best));
  text += line("", fmt::format("intervals not too narrow; NIS is then below 1 ({:.2f})",
                               tuning.written_check.mean_nis));
  return text;
}

}  // namespace

std::string tuning_text(const std::vector<TuningRecording>& recordings, const LikelihoodPlan& plan,
                        const LikelihoodTuning& tuning) {
  std::string text;
  std::size_t samples = 0, usable = 0;
  std::uint64_t seen = 0, rejected = 0;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const TuningRecording& recording = recordings[i];
    if (i < kMostNamed) text += line("recording", recording.name + ", " + recording.format);
    for (const std::string& note : recording.notes) {
      if (i < kMostNamed) text += line("note", note);
    }
    samples += recording.samples.size();
    usable += recording.usable;
    seen += recording.seen;
    rejected += recording.rejected;
  }
  if (recordings.size() > kMostNamed) {
    text += line("", fmt::format("and {} more", recordings.size() - kMostNamed));
  }
  text += line(
      "positions",
      fmt::format("{} used of {} samples, {} outliers left out; a third of the stretches held out",
                  usable, seen, rejected));
  if (samples < seen) {
    text += line("", fmt::format("{} samples were kept, evenly spread (--most-samples)", samples));
  }
  text += line("start",
               fmt::format("{:.4g} mm, {:.4g} m^2/s^5{}", 1e3 * tuning.start.position_sd_m,
                           tuning.start.jerk_density_m2_s5,
                           plan.start ? ", as given" : ": noise at rest, and third differences"));
  const FittedModel& white = tuning.white;
  for (std::size_t i = 0; i < white.parameters.size(); ++i) {
    text += line(kUnits[i].name, parameter_text(white.parameters[i], kUnits[i], doubt_of(tuning)));
  }
  text += line("optimum", unique_text(white, plan.starts));
  text += check_text(white.held_out) + extremes_text(recordings, white.held_out);
  if (white.held_out.whiteness_p >= kWhite) text += line("", whiteness_text(white.held_out));
  for (const std::string& reason : tuning.reasons) text += line("  against it", reason);
  if (tuning.correlated) text += correlated_text(plan, tuning);
  if (!tuning.correlated_serves) text += adaptive_text(tuning.written_check);
  return text;
}

std::string learning_text(const LearningCounts& counts) {
  constexpr std::uint64_t kFewest = 100;
  if (counts.samples == 0) return {};
  std::string words = fmt::format(
      "with these values, velocity is corrected in {:.0f} % of the samples",
      100 * static_cast<double>(counts.corrected) / static_cast<double>(counts.samples));
  if (counts.compared >= kFewest) {
    words += fmt::format("; error of the next position there, divided by the filter's: {:.2f}",
                         counts.error_ratio());
  }
  return line("learning", words);
}

std::string tuning_comment(const std::vector<TuningRecording>& recordings,
                           const LikelihoodPlan& plan, const LikelihoodTuning& tuning) {
  std::string text = fmt::format(
      "# Tuned by condyle {} to the innovation likelihood of {} recording{}, seed {}. Research use "
      "only.\n",
      CONDYLE_VERSION, recordings.size(), recordings.size() == 1 ? "" : "s", plan.seed);
  const std::vector<FittedParameter>& found = tuning.white.parameters;
  if (tuning.correlated_serves) {
    text += "# The noise is not white; these are the white values that fit best.\n";
  } else {
    for (std::size_t i = 0; i < found.size(); ++i) {
      text += fmt::format("# {}: {}\n", kUnits[i].name,
                          parameter_text(found[i], kUnits[i], doubt_of(tuning)));
    }
  }
  const CrossValidation& check = tuning.written_check;
  text += fmt::format("# Held out: mean NIS {:.3f} (95 % bounds {:.3f} to {:.3f})\n",
                      check.mean_nis, check.nis_bounds.low, check.nis_bounds.high);
  for (const std::string& reason : tuning.reasons) text += "# " + in_comment(reason) + "\n";
  return text;
}

}  // namespace condyle::host
