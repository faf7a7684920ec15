// SPDX-License-Identifier: Apache-2.0
// Readings and estimates of a report, from several threads. Runs under the thread sanitizer too.
#include "report/report_section.h"

#include <gmock/gmock.h>

#include <thread>

#include "hosted/files/input_error.h"
#include "readings/readings_files.h"
#include "simulation/kinematic/jaw_text.h"
#include "simulation/kinematic/kinematic_simulation.h"
#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

class ReportOfSession : public testing::Test {
 protected:
  void SetUp() override {
    JawScenario scenario;
    scenario.name = "session";
    scenario.facebow.rate_Hz = 60;
    scenario.landmarks = {.condyle_sd_mm = 1, .incisor_sd_mm = 0.5, .plane_sd_mm = 1};
    scenario.tasks = {default_task(JawTaskKind::rest), default_task(JawTaskKind::chewing)};
    scenario.tasks[1].duration_s = 10;
    const KinematicSimulation simulation(scenario, 1);
    recording_ = folder_.write("session.csv", jaw_recording_csv(simulation.samples()));
    choice_.analysis.landmarks =
        folder_.write("landmarks.toml", jaw_landmarks_toml(simulation, scenario.landmarks));
  }

  const testing_support::TemporaryFolder folder_;
  std::string recording_;
  ReportChoice choice_;
};

TEST_F(ReportOfSession, HasTheReadingsOfAnalyse) {
  const std::thread::id caller = std::this_thread::get_id();
  const ReportSection section = report_section(
      recording_, choice_, [caller](double) { EXPECT_EQ(std::this_thread::get_id(), caller); },
      [caller] {
        EXPECT_EQ(std::this_thread::get_id(), caller);
        return false;
      });
  ASSERT_TRUE(section.analysis);
  EXPECT_GT(section.analysis->cycles.size(), 3U);
  EXPECT_EQ(readings_csv({*section.analysis}),
            readings_csv({analyse(recording_, choice_.analysis)}));
  EXPECT_FALSE(section.series.runs().empty());
  EXPECT_THAT(section.summary, testing::HasSubstr("mean NIS"));
}

TEST_F(ReportOfSession, EndsWithTheProblemOfEither) {
  const auto report = [this] {
    report_section(
        recording_, choice_, [](double) {}, [] { return false; });
  };
  choice_.analysis.tasks = {{TaskKind::opening, 900, 901, false}};
  EXPECT_THROW(report(), InputError);  // of the readings
  choice_.analysis.tasks.clear();
  choice_.drive_file = folder_ / "absent.csv";
  EXPECT_THROW(report(), InputError);  // of the estimates
}

TEST_F(ReportOfSession, StopsWhenAsked) {
  const ReportSection section = report_section(
      recording_, choice_, [](double) {}, [] { return true; });
  EXPECT_FALSE(section.analysis);
}

}  // namespace
}  // namespace condyle::host
