// SPDX-License-Identifier: Apache-2.0
// Prints the accuracy on simulated and on real recordings: the first table of estimator/README.md.
// usage: real_accuracy [--axes]
// --axes: CSV with a line per treatment, axis and estimator instead.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <set>

#include "consistency/motion_vectors.h"
#include "real_motion/score.h"

using namespace condyle::testing_support;

namespace {

constexpr const char* kHead =
    "| instrument, laboratory | axes | velocity error, mean (worst): recommended | without "
    "learning | published | 95 % intervals that hold (%): recommended | published | valid samples "
    "refused (%) | runaways: recommended | published |\n"
    "|---|---|---|---|---|---|---|---|---|---|";

std::vector<AxisScores> score_simulation(double rate_Hz) {
  std::vector<AxisScores> scores;
  for (const MotionFile& file : kMotionFiles) {
    const MotionVector motion = read_motion(file.name);
    MotionRecording recording;
    recording.name = file.name;
    recording.position_m = {motion.position_m};
    for (const condyle::TimeNs time_ns : motion.time_ns) {
      recording.time_s.push_back(condyle::seconds(time_ns));
    }
    if (std::abs(recording.step_s() * rate_Hz - 1) > 0.01) continue;
    scores.push_back(score_axis(recording, motion.velocity_m_s, file.noise_sd_m));
  }
  return scores;
}

// With faults the oracle bridges half a second by prediction: no yardstick.
void print_row(const std::string& name, const std::vector<AxisScores>& scores,
               bool has_oracle = true) {
  const Summary recommended = summarise(scores, &AxisScores::recommended);
  const Summary filter = summarise(scores, &AxisScores::filter);
  const Summary published = summarise(scores, &AxisScores::published);
  std::printf("| %s | %zu |", name.c_str(), recommended.axes);
  for (const Summary* const one : {&recommended, &filter, &published}) {
    if (has_oracle) std::printf(" %.2f (%.2f) |", one->error_ratio, one->worst_error_ratio);
    if (!has_oracle) std::printf(" |");
  }
  for (const Summary* const one : {&recommended, &published}) {
    std::printf(" %.0f, %.0f |", 100 * one->velocity_coverage, 100 * one->next_coverage);
  }
  std::printf(" %.2f | %zu | %zu |\n", recommended.refused_percent, recommended.runaways,
              published.runaways);
}

void print_by_instrument(const std::vector<AxisScores>& scores) {
  for (auto from = scores.begin(); from != scores.end();) {
    const auto end = std::find_if(from, scores.end(), [&](const AxisScores& one) {
      return one.instrument != from->instrument;
    });
    print_row(from->instrument, {from, end});
    from = end;
  }
}

void print_sources(const std::vector<MotionRecording>& recordings) {
  std::set<std::string> sources;
  for (const MotionRecording& recording : recordings) sources.insert(recording.source);
  std::printf("\nThe %zu recordings, converted to CSV and cut to 90 s:", recordings.size());
  for (const std::string& source : sources) {
    std::printf("%s%s", source == *sources.begin() ? " " : ",\n", source.c_str());
  }
  std::puts(".");
}

void print_axes(const std::vector<AxisScores>& scores, Treatment treatment) {
  for (const AxisScores& axis : scores) {
    for (const auto& [estimator, one] :
         {std::pair("oracle", &axis.oracle), std::pair("recommended", &axis.recommended),
          std::pair("filter", &axis.filter), std::pair("published", &axis.published)}) {
      std::printf("%s,%s,%c,%s,%.9g,%.9g,%.9g,%zu,%zu,%zu,%zu\n", name_of(treatment),
                  axis.recording.c_str(), axis.axis, estimator, one->velocity_error_m_s,
                  one->velocity_coverage, one->next_coverage, one->valid, one->valid_refused,
                  one->runaways, one->deviation_falls);
    }
  }
}

int print_all_axes(const std::vector<MotionRecording>& recordings) {
  std::puts(
      "treatment,recording,axis,estimator,velocity_error_m_s,velocity_coverage,next_coverage,"
      "valid,valid_refused,runaways,deviation_falls");
  for (const Treatment treatment : kTreatments)
    print_axes(score_all(recordings, treatment), treatment);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const auto recordings = read_real_recordings();
  if (recordings.empty()) {
    std::fputs("real_accuracy: set CONDYLE_REFERENCE_DATA to the folder of reference data\n",
               stderr);
    return 2;
  }
  if (argc == 2 && std::strcmp(argv[1], "--axes") == 0) return print_all_axes(recordings);
  if (argc != 1) {
    std::fputs("usage: real_accuracy [--axes]\n", stderr);
    return 2;
  }
  std::puts(kHead);
  print_row("simulated chewing, 60 Hz, noise 20 to 300 um", score_simulation(60));
  print_row("simulated chewing, 200 Hz, noise 50 and 100 um", score_simulation(200));
  const auto as_recorded = score_all(recordings, Treatment::none);
  print_by_instrument(as_recorded);
  print_row("all real recordings", as_recorded);
  for (const Treatment treatment : kTreatments) {
    if (treatment == Treatment::none) continue;
    print_row(std::string("all, ") + name_of(treatment), score_all(recordings, treatment),
              treatment != Treatment::faults);
  }
  print_sources(recordings);
}
