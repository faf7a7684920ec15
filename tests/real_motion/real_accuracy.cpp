// SPDX-License-Identifier: Apache-2.0
// Prints the accuracy on simulated and on real recordings as tables for the README files.
// usage: real_accuracy [--axes]
// --axes: CSV with a line per treatment, axis and estimator instead.
#include <algorithm>
#include <cstdio>
#include <cstring>

#include "consistency/motion_vectors.h"
#include "real_motion/score.h"

using namespace condyle::testing_support;

namespace {

constexpr const char* kHead =
    "| instrument, laboratory | axes | velocity error over the oracle's, mean (worst): recommended "
    "| published | 95 % intervals that hold (%), of velocity, of the next sample: recommended | "
    "published | valid samples refused (%) | runaways: recommended | published |\n"
    "|---|---|---|---|---|---|---|---|---|";

std::vector<AxisScores> score_simulation() {
  std::vector<AxisScores> scores;
  for (const MotionFile& file : kMotionFiles) {
    const MotionVector motion = read_motion(file.name);
    MotionRecording recording{file.name, "", {}, {motion.position_m}};
    for (const condyle::TimeNs time_ns : motion.time_ns) {
      recording.time_s.push_back(condyle::seconds(time_ns));
    }
    recording.instrument = recording.step_s() > 0.01
                               ? "simulated chewing, 60 Hz, noise 20 to 300 um"
                               : "simulated chewing, 200 Hz, 50 and 100 um";
    scores.push_back(score_axis(recording, motion.velocity_m_s, file.noise_sd_m));
  }
  return scores;
}

void print_row(const std::string& name, const std::vector<AxisScores>& scores) {
  const Summary recommended = summarise(scores, &AxisScores::recommended);
  const Summary published = summarise(scores, &AxisScores::published);
  std::printf("| %s | %zu |", name.c_str(), recommended.axes);
  for (const Summary* const one : {&recommended, &published}) {
    std::printf(" %.2f (%.2f) |", one->error_ratio, one->worst_error_ratio);
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

void print_axes(const std::vector<AxisScores>& scores, Treatment treatment) {
  for (const AxisScores& axis : scores) {
    for (const auto& [estimator, one] :
         {std::pair("oracle", &axis.oracle), std::pair("recommended", &axis.recommended),
          std::pair("published", &axis.published)}) {
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
  print_by_instrument(score_simulation());
  const auto as_recorded = score_all(recordings, Treatment::none);
  print_by_instrument(as_recorded);
  print_row("all real recordings", as_recorded);
  for (const Treatment treatment : kTreatments) {
    if (treatment == Treatment::none) continue;
    print_row(std::string("all, ") + name_of(treatment), score_all(recordings, treatment));
  }
}
