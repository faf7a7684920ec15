// SPDX-License-Identifier: Apache-2.0
// What estimates and messages look like outside, and how much of them is kept.
#include <gmock/gmock.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "box/box_log.h"
#include "box/outlets/estimate_history.h"
#include "box/outlets/estimate_text.h"
#include "box/outlets/publisher.h"
#include "support/wait_for.h"

namespace condyle::box {
namespace {

using testing::HasSubstr;

TEST(EstimateHistory, TellsAReaderWhatItMissed) {
  EstimateHistory history(3);
  EXPECT_EQ(history.after(0).number, 0U);
  for (int i = 1; i <= 5; ++i) history.add("line " + std::to_string(i));
  EXPECT_EQ(history.newest(), 5U);
  const EstimateHistory::Line late = history.after(0);
  EXPECT_EQ(late.number, 3U);
  EXPECT_EQ(late.missed, 2U);
  EXPECT_EQ(*late.text, "line 3");
  EXPECT_EQ(history.after(4).missed, 0U);
  EXPECT_EQ(*history.after(4).text, "line 5");
  EXPECT_EQ(history.after(5).number, 0U);
  EXPECT_EQ(history.after(500).number, 0U);
}

// Listeners are woken by the ticks, also where estimates come as fast as they are published.
TEST(Publisher, TicksWhileThereAreMoreEstimates) {
  EstimateHistory history(10);
  hal::ManualClock clock;
  auto ring = std::make_unique<EstimateRing>();
  while (ring->push({})) {
  }
  Publisher publisher(history, "", 0, clock);
  std::vector<std::uint64_t> published;  // at each tick
  std::atomic<bool> is_done = false;
  publisher.start(*ring, [&] {
    if (is_done) return;
    published.push_back(publisher.counts().published);
    is_done = published.back() >= 4096;
  });
  EXPECT_TRUE(testing_support::wait_for([&] { return is_done.load(); }));
  publisher.stop();
  EXPECT_GE(published.size(), 10U);
  EXPECT_LE(published.front(), 500U);
}

TEST(EstimateLine, KeepsEveryBitAndSaysWhatIsNotKnown) {
  BoxEstimate box;
  box.run = 2;
  box.number = 9;
  box.has_impedance = true;
  box.estimate.axis_count = 1;
  box.estimate.time_valid = true;
  box.estimate.time_ns = 9'007'199'254'740'993;  // no double
  box.estimate.axes[0].velocity_m_s = {0.1 + 0.2, 1e-3 / 3, Provenance::measured};
  box.estimate.events.add(Event::time_gap);
  box.estimate.impedance.friction_Ns_m.quantity = {0.05, 0.5, Provenance::assumed};
  box.estimate.impedance.friction_Ns_m.limit = ImpedanceLimit::missing;
  const std::string line = estimate_line(box);
  EXPECT_EQ(line.find('\n'), std::string::npos);
  const nlohmann::json json = nlohmann::json::parse(line);
  EXPECT_EQ(json["time_ns"], 9'007'199'254'740'993);
  EXPECT_EQ(json["axis"]["velocity_m_s"].get<double>(), 0.1 + 0.2);
  EXPECT_EQ(json["axis"]["velocity_sd_m_s"].get<double>(), 1e-3 / 3);
  EXPECT_EQ(json["axis"]["velocity_provenance"], "measured");
  EXPECT_TRUE(json["axis"]["position_m"].is_null());
  EXPECT_EQ(json["axis"]["position_provenance"], "");
  EXPECT_EQ(json["impedance"]["friction_provenance"], "assumed");
  EXPECT_EQ(json["impedance"]["friction_limit"], "missing");
  EXPECT_EQ(json["events"], nlohmann::json::array({"time_gap"}));

  box.has_impedance = false;
  box.estimate.time_valid = false;
  const nlohmann::json without = nlohmann::json::parse(estimate_line(box));
  EXPECT_FALSE(without.contains("impedance"));
  EXPECT_TRUE(without["time_s"].is_null());
}

TEST(EstimateLine, HasThePoseAndItsPoints) {
  BoxEstimate box;
  EXPECT_FALSE(nlohmann::json::parse(estimate_line(box)).contains("pose"));
  box.has_pose = true;
  const nlohmann::json none = nlohmann::json::parse(estimate_line(box))["pose"];
  EXPECT_TRUE(none["centre_m"][0].is_null());
  EXPECT_EQ(none["centre_provenance"], "");
  EXPECT_TRUE(none["time_ns"].is_null());

  box.pose.centre_m = {{1, 2, 3}, 0.04 * Eigen::Matrix3d::Identity(), Provenance::measured};
  box.pose.rotation_vector_rad = {{0.1 + 0.2, 0, 0}, Eigen::Matrix3d::Zero(), Provenance::measured};
  box.pose.rotation.setIdentity();
  box.pose.rotation_covariance_rad2 = 0.01 * Eigen::Matrix3d::Identity();
  host::PoseChoice choice;
  choice.add_point("here", {"incisor", {0, 1, 0}});
  const nlohmann::json json = nlohmann::json::parse(estimate_line(box, choice))["pose"];
  EXPECT_EQ(json["centre_m"], nlohmann::json::array({1.0, 2.0, 3.0}));
  EXPECT_EQ(json["centre_sd_m"][2].get<double>(), 0.2);
  EXPECT_EQ(json["rotation_vector_rad"][0].get<double>(), 0.1 + 0.2);
  EXPECT_EQ(json["twist_rad"].get<double>(), 0.1 + 0.2);
  EXPECT_EQ(json["incisor_m"], nlohmann::json::array({1.0, 3.0, 3.0}));
  EXPECT_DOUBLE_EQ(json["incisor_sd_m"][0].get<double>(), std::sqrt(0.05));
  EXPECT_EQ(json["incisor_covariances_m2"], nlohmann::json::array({0.0, 0.0, 0.0}));
  EXPECT_TRUE(json["incisor_velocity_m_s"][0].is_null());
  EXPECT_EQ(json["angular_velocity_provenance"], "");
}

TEST(EstimateLine, HasTheCycleThatEndsWithIt) {
  EXPECT_FALSE(nlohmann::json::parse(estimate_line({})).contains("cycle"));
  host::FoundCycle found;
  found.cycle.begin_ns = 1'000'000'000;
  found.cycle.turn_ns = 1'400'000'000;
  found.cycle.end_ns = 1'750'000'000;
  found.cycle.duration_s = {0.1 + 0.2, 0.01, Provenance::measured};
  found.number = 3;
  found.sequence = 2;
  const nlohmann::json json = nlohmann::json::parse(estimate_line({}, {}, found))["cycle"];
  EXPECT_EQ(json["cycle"], 3);
  EXPECT_EQ(json["sequence"], 2);
  EXPECT_DOUBLE_EQ(json["turn_s"].get<double>(), 1.4);
  EXPECT_EQ(json["duration_s"].get<double>(), 0.1 + 0.2);
  EXPECT_EQ(json["duration_sd_s"].get<double>(), 0.01);
  EXPECT_TRUE(json["height_m"].is_null());
  EXPECT_EQ(json["height_provenance"], "");
  EXPECT_EQ(json["rejected"], "");
  found.number = 0;
  found.cycle.verdict = CycleVerdict::too_short;
  const nlohmann::json rejected = nlohmann::json::parse(estimate_line({}, {}, found))["cycle"];
  EXPECT_TRUE(rejected["cycle"].is_null());
  EXPECT_EQ(rejected["rejected"], "it lasts 0.75 s");
}

// From each run the cycles of its own estimates.
TEST(Publisher, FindsTheCyclesOfARun) {
  hal::ManualClock clock;
  EstimateHistory history(1000);
  Publisher publisher(history, "", 0, clock, {}, host::CycleChoice{Axis::z, false});
  const auto ring = std::make_unique<EstimateRing>();
  for (std::uint64_t run = 1; run <= 2; ++run) {
    for (int i = 0; i < 400; ++i) {
      BoxEstimate box;
      box.run = run;
      box.number = static_cast<std::uint64_t>(i + 1);
      RecommendedEstimate<double>& estimate = box.estimate;
      estimate.is_ready = estimate.time_valid = true;
      estimate.time_ns = 10'000'000 * TimeNs{i};
      estimate.axis_count = 1;
      const double phase = 2 * M_PI * 0.01 * i;  // opens towards positive positions
      AxisEstimate<double>& axis = estimate.axes[0];
      axis.position_m = {0.01 * (1 - std::cos(phase)), 1e-5, Provenance::measured};
      axis.velocity_m_s = {0.01 * 2 * M_PI * std::sin(phase), 1e-3, Provenance::measured};
      axis.innovation_m = 0;
      ASSERT_TRUE(ring->push(box));
    }
  }
  publisher.start(*ring, [] {});
  publisher.stop();
  std::vector<nlohmann::json> cycles;
  for (std::uint64_t place = 0;;) {
    const EstimateHistory::Line line = history.after(place);
    if (line.number == 0) break;
    place = line.number;
    const nlohmann::json json = nlohmann::json::parse(*line.text);
    if (json.contains("cycle")) cycles.push_back(json);
  }
  ASSERT_EQ(cycles.size(), 4U);  // the first one of a run may have begun before it
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(cycles[i]["run"], i / 2 + 1);
    EXPECT_EQ(cycles[i]["cycle"]["cycle"], i % 2 + 1);
    EXPECT_NEAR(cycles[i]["cycle"]["turn_s"].get<double>(), static_cast<double>(i % 2) + 1.5, 0.01);
    EXPECT_NEAR(cycles[i]["cycle"]["duration_s"].get<double>(), 1, 0.05);
  }
}

TEST(BoxLog, SaysTheSameThingSeldom) {
  hal::ManualClock clock;
  char text[4096] = {};
  std::FILE* const file = fmemopen(text, sizeof text, "w");
  ASSERT_NE(file, nullptr);
  BoxLog log(clock, file);
  for (int i = 0; i < 1000; ++i) {
    clock.sleep_until(clock.now_ns() + 1'000'000);
    log.say(BoxLog::Level::warning, "device", "away " + std::to_string(i));
  }
  log.say(BoxLog::Level::info, "session", "two\nlines");
  clock.sleep_until(70 * kNanosecondsPerSecond);
  log.say(BoxLog::Level::warning, "device", "away again");
  std::fclose(file);
  const std::string said = text;
  EXPECT_THAT(said, HasSubstr("<4>device: away 4\n"));
  EXPECT_THAT(said, testing::Not(HasSubstr("away 5")));
  EXPECT_THAT(said, HasSubstr("<6>session: two lines\n"));
  EXPECT_THAT(said, HasSubstr("<4>device: away again (995 similar lines were suppressed)\n"));
}

}  // namespace
}  // namespace condyle::box
