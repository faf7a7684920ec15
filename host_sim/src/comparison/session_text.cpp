// SPDX-License-Identifier: Apache-2.0
#include "comparison/session_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "comparison/comparison_text.h"
#include "hosted/files/clean_text.h"
#include "hosted/files/number_text.h"

namespace condyle::host {
namespace {

// Below this share of measured samples, missing samples may cause a difference.
constexpr double kFewMeasured = 0.95;

std::string sessions_text(const std::vector<Session>& sessions) {
  std::string text;
  for (const Session& session : sessions) {
    text += fmt::format("session      {}: {} recording{}\n", clean_line(session.name),
                        session.recordings.size(), session.recordings.size() == 1 ? "" : "s");
    for (const RecordingReport& recording : session.recordings) {
      text += fmt::format("             {}, {:.4g} s\n", clean_line(recording.source),
                          recording.duration_s);
    }
  }
  return text;
}

std::string repeats_text(const QuantityComparison& quantity) {
  const Repeatability& repeats = quantity.repeats;
  if (repeats.degrees_of_freedom == 0) {
    return "  smallest change: NOT KNOWN, no session has repeats\n";
  }
  if (!repeats.is_known()) {
    return "  smallest change: NOT KNOWN, the repeats do not differ at all\n";
  }
  return fmt::format(
      "  within a session: sd {:.3g} (95 %: {:.3g} to {:.3g}; {} degree{} of freedom)\n"
      "  one recording to another: smallest change {:.3g}\n",
      repeats.within_sd, repeats.interval.low, repeats.interval.high, repeats.degrees_of_freedom,
      repeats.degrees_of_freedom == 1 ? "" : "s", quantity.smallest_single);
}

std::string change_text(const SessionChange& change) {
  if (std::isnan(change.smallest)) return "; whether it exceeds chance is not known";
  return fmt::format("; smallest change {:.3g}: {}", change.smallest,
                     !change.exceeds() ? "not detectable"
                     : change.exceeds_adjusted()
                         ? "CHANGED, also among so many comparisons"
                         : "exceeded, but as chance does among so many comparisons");
}

std::string quantity_text(const QuantityComparison& quantity,
                          const std::vector<Session>& sessions) {
  std::string text = fmt::format("{} ({})\n", quantity.name, quantity.unit);
  if (!quantity.withheld.empty()) return text + "  not compared: " + quantity.withheld + "\n";
  for (std::size_t i = 0; i < sessions.size(); ++i) {
    text += fmt::format("{}{} {:.4g}", i == 0 ? "  means: " : ", ", sessions[i].name,
                        quantity.means[i]);
  }
  text += "\n" + repeats_text(quantity);
  for (const SessionChange& change : quantity.changes) {
    text += fmt::format("  {} to {}: {:+.3g}{}\n", sessions[change.from].name,
                        sessions[change.to].name, change.change, change_text(change));
  }
  return text;
}

std::string doubts_text(const std::vector<Session>& sessions) {
  std::string text;
  for (const Session& session : sessions) {
    for (const RecordingReport& recording : session.recordings) {
      for (const std::string& note : recording.notes) {
        text += fmt::format("note         {}: {}\n", clean_line(recording.source), note);
      }
      const double measured_share = recording.runs[0].measured_share;
      if (measured_share < kFewMeasured) {
        text += fmt::format("note         {}: {:.0f} % of its samples measure the motion\n",
                            clean_line(recording.source), 100 * measured_share);
      }
      const std::string warning = warning_text(recording.runs[0]);
      if (warning.empty()) continue;
      text += fmt::format("note         {}: {}\n", clean_line(recording.source), warning);
    }
  }
  return text;
}

}  // namespace

std::string session_text(const std::string& estimator, const std::vector<Session>& sessions,
                         const SessionComparison& comparison) {
  std::string text =
      fmt::format("estimator    {}\n", estimator) + sessions_text(sessions) + doubts_text(sessions);
  for (const QuantityComparison& quantity : comparison.quantities) {
    text += quantity_text(quantity, sessions);
  }
  const std::size_t tests = comparison.tests();
  if (tests > 0) {
    std::size_t exceeding = 0, adjusted = 0;
    for (const QuantityComparison& quantity : comparison.quantities) {
      for (const SessionChange& change : quantity.changes) {
        exceeding += change.exceeds() ? 1U : 0U;
        adjusted += change.exceeds_adjusted() ? 1U : 0U;
      }
    }
    text += fmt::format(
        "{} of {} comparisons exceed the smallest detectable change; without any change, one in 20 "
        "does ({:.2g} of these).\n"
        "{} do so after Holm's adjustment, which allows one false finding in 20 such tables.\n",
        exceeding, tests, 0.05 * static_cast<double>(tests), adjusted);
  }
  return text +
         "The scatter is that of repeats within a session; with three or four of them, condyle "
         "cannot check whether successive ones\nare alike. An instrument mounted anew, another "
         "day, another task or pace are\npart of a change. This describes change; it is not a "
         "diagnosis; research use only.\n";
}

std::string session_csv(const std::vector<Session>& sessions, const SessionComparison& comparison) {
  std::string text =
      "quantity,unit,from,to,recordings_from,recordings_to,mean_from,mean_to,change,"
      "within_session_sd,within_session_sd_low,within_session_sd_high,degrees_of_freedom,"
      "smallest_change_single,smallest_change,probability,adjusted_probability,exceeds,"
      "exceeds_adjusted\n";
  const auto numbers = [&text](std::initializer_list<double> values) {
    for (const double value : values) {
      text += ',';
      append_number(text, value);
    }
  };
  for (const QuantityComparison& quantity : comparison.quantities) {
    const Repeatability& repeats = quantity.repeats;
    const bool is_known = repeats.is_known();
    for (const SessionChange& change : quantity.changes) {
      const std::size_t n_1 = quantity.values[change.from].size();
      const std::size_t n_2 = quantity.values[change.to].size();
      text += fmt::format("{},{},{},{},{},{}", quantity.column, quantity.unit,
                          csv_field(sessions[change.from].name),
                          csv_field(sessions[change.to].name), n_1, n_2);
      numbers({quantity.means[change.from], quantity.means[change.to], change.change,
               repeats.within_sd, is_known ? repeats.interval.low : EstimateRow::kNone,
               is_known ? repeats.interval.high : EstimateRow::kNone});
      text += fmt::format(",{}", repeats.degrees_of_freedom);
      numbers({quantity.smallest_single, change.smallest, change.probability,
               change.adjusted_probability});
      text += is_known ? fmt::format(",{:d},{:d}\n", change.exceeds(), change.exceeds_adjusted())
                       : ",,\n";
    }
  }
  return text;
}

}  // namespace condyle::host
