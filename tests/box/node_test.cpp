// SPDX-License-Identifier: Apache-2.0
// A microcontroller as the box's estimator.
#include <gmock/gmock.h>

#include <map>
#include <memory>
#include <optional>

#include "box/running_box.h"
#include "box/socket_node.h"
#include "box/stream_reader.h"
#include "hosted/devices/synthetic_source.h"
#include "support/command.h"
#include "support/session.h"
#include "support/table.h"

namespace condyle::box {
namespace {

using testing::HasSubstr;
using testing_support::EventStream;
using testing_support::Listener;
using testing_support::post;
using testing_support::SocketNode;
using testing_support::StreamReader;
using testing_support::wait_for;
using Json = nlohmann::json;

class BoxNode : public testing::Test {
 protected:
  BoxNode() {
    running_.configuration.node = "unix:" + path_;
    running_.configuration.priority = 0;
  }
  Json node_status() const { return running_.status()["node"]; }
  // The next line of the stream that `is_wanted`.
  static std::optional<Json> next(Listener& stream,
                                  const std::function<bool(const Json&)>& is_wanted) {
    EventStream::Event event;
    while (stream.next(event)) {
      Json line = Json::parse(event.data, nullptr, false);
      if (is_wanted(line)) return line;
    }
    return {};
  }
  // By their numbers.
  using Lines = std::map<std::int64_t, Json>;
  // Takes those of the second run.
  static auto take_second_run(Lines& lines) {
    return [&lines](const EventStream::Event& event) {
      const Json line = Json::parse(event.data, nullptr, false);
      if (line["run"] == 2 && line.contains("number")) lines.emplace(line["number"], line);
      return line["run"] != 3;
    };
  }
  // Every number that went out is in the replay of the recording, bit for bit, and no other.
  void expect_replay(const Lines& live, const std::string& log, std::size_t least_rows) const {
    const std::string csv = running_.folder / "again.csv";
    const auto replayed = testing_support::run_condyle({"replay", log, "--lag", "3", "--out", csv});
    ASSERT_EQ(replayed.exit_code, 0) << replayed.errors;
    const testing_support::Table table = testing_support::read_table(csv);
    ASSERT_GT(table.rows, least_rows);
    ASSERT_EQ(table.rows, live.size());
    for (const char* name : {"position_m", "velocity_sd_m_s", "acceleration_m_s2"}) {
      std::int64_t number = 0;
      for (const double value : table.numbers(std::string("y_") + name)) {
        ASSERT_EQ(live.at(++number)["y"][name].get<double>(), value) << name << number;
      }
    }
  }
  // A recording of so many reports, 500 a second, is to be played.
  void play_recording(int reports) {
    const std::string path = running_.folder / "played.mcap";
    hal::ManualClock clock;
    hal::SessionHeader header = testing_support::make_header();
    header.start_monotonic_ns = clock.now_ns();
    header.sources[0].profile_toml =
        testing_support::read_file(running_.configuration.facebow.file);
    header.sources[0].report_descriptor.clear();
    hal::SessionLogWriter log;
    ASSERT_EQ(log.open(path, header), hal::SessionLogFailure::none);
    host::SyntheticSource source(500, clock);
    ASSERT_EQ(source.open(), hal::Status::ok);
    hal::RawReport report;
    for (int i = 0; i < reports; ++i) {
      ASSERT_EQ(source.read(hal::kNoDeadline, report), hal::Status::ok);
      ASSERT_TRUE(wait_for([&] { return log.write(0, report); }));  // once there is room
    }
    ASSERT_EQ(log.close(), hal::SessionLogFailure::none);
    running_.configuration.facebow = {"facebow", SourceSettings::Kind::file, path, ""};
    running_.configuration.lag = 5;
  }
  // Reports that have neither an estimate nor been counted otherwise.
  static std::int64_t open_reports(const Json& status) {
    return status["device"]["reports_received"].get<std::int64_t>() -
           status["estimator"]["estimates"].get<std::int64_t>() -
           status["node"]["reports_not_sent"].get<std::int64_t>() -
           status["node"]["reports_lost"].get<std::int64_t>() -
           status["node"]["reports_without_estimate"].get<std::int64_t>();
  }
  // When every report has an estimate or is counted.
  static Json status_when_whole(const testing_support::RunningBox& box) {
    Json status;
    EXPECT_TRUE(wait_for([&] {
      status = box.status();
      return open_reports(status) == 0;
    })) << status;
    return status;
  }
  // An absence is neither.
  static bool is_late(const Json& line, bool late) {
    return line["node"].value("late", !late) == late;
  }
  static bool is_absence(const Json& line) { return line["node"].contains("away"); }

  testing_support::TemporaryFolder sockets_;
  const std::string path_ = sockets_ / "node";
  testing_support::RunningBox running_{2};
};

TEST_F(BoxNode, ItsEstimatesAreThoseOfTheReplay) {
  const SocketNode node(path_, running_.clock);
  running_.configuration.lag = 3;
  running_.start();
  ASSERT_TRUE(running_.is_estimating());
  Listener stream(running_);
  Lines live;
  StreamReader reader(stream, take_second_run(live));
  ASSERT_EQ(post(running_.port, "/v1/session/start", "{}").status, 200);
  Json status;
  EXPECT_TRUE(wait_for([&] {
    status = running_.status();
    return status["session"]["reports_written"] > 1000 &&
           status["node"]["its_side"]["samples"] > 500;
  })) << status;
  const auto stopped = post(running_.port, "/v1/session/stop", "{}");
  ASSERT_EQ(stopped.status, 200);
  ASSERT_TRUE(reader.wait());
  expect_replay(live, Json::parse(stopped.body)["done"], 1000);
  EXPECT_EQ(live.at(1)["node"]["connection"], 1);
  EXPECT_GT(live.at(500)["node"]["delay_s"], 0.0);

  EXPECT_EQ(status["estimator"]["estimating"], true);
  EXPECT_GT(status["real_time"]["report_to_estimate"]["max_s"], 0.0);
  EXPECT_EQ(status["node"]["connected"], true);
  EXPECT_THAT(status["node"]["is"].get<std::string>(), HasSubstr("test, condyle"));
  EXPECT_EQ(status["node"]["reports_lost"], 0);
  EXPECT_EQ(status["node"]["losses"], 0);
  EXPECT_EQ(status["node"]["its_side"]["frames_lost"], 0);
  EXPECT_EQ(status["node"]["its_side"]["stack_size_bytes"], 4321);
}

// Reports of the run that ended are still on their way when the next one has begun.
TEST_F(BoxNode, OneThatIsBehindEstimatesTheWholeRun) {
  SocketNode node(path_, running_.clock);
  running_.configuration.lag = 3;
  running_.start();
  ASSERT_TRUE(running_.is_estimating());
  Listener stream(running_);
  ASSERT_EQ(post(running_.port, "/v1/session/start", "{}").status, 200);
  const auto first = next(stream, [](const Json& line) { return line["run"] == 2; });
  ASSERT_TRUE(first);
  Lines live;
  live.emplace((*first)["number"], *first);
  StreamReader reader(stream, take_second_run(live));
  // It lags by 0.6 s, of the two seconds after which reports are not sent any more.
  running_.pause();
  node.is_mute = true;
  running_.waits_for_node = false;
  running_.pause_after(600'000'000);
  EXPECT_TRUE(wait_for([&] { return open_reports(running_.status()) > 200; }));
  const auto stopped = post(running_.port, "/v1/session/stop", "{}");
  ASSERT_EQ(stopped.status, 200);
  EXPECT_GT(open_reports(running_.status()), 200);
  node.is_mute = false;
  running_.waits_for_node = true;
  running_.go_on();
  ASSERT_TRUE(reader.wait());
  expect_replay(live, Json::parse(stopped.body)["done"], 200);
  EXPECT_EQ(node_status()["reports_lost"], 0);
}

TEST_F(BoxNode, OneThatGoesAwayIsSaidAndComesBack) {
  running_.start();
  Listener stream(running_);
  ASSERT_TRUE(next(stream, is_absence)) << "nobody is there yet";
  EXPECT_EQ(running_.status()["estimator"]["estimating"], false);
  EXPECT_TRUE(wait_for([&] {
    return node_status()["problem"].get<std::string>().starts_with("[estimator] node unix:");
  })) << node_status();

  auto node = std::make_unique<SocketNode>(path_, running_.clock);
  const auto is_estimate = [](const Json& line) { return line.contains("number"); };
  const auto first = next(stream, is_estimate);
  ASSERT_TRUE(first);
  EXPECT_EQ((*first)["node"]["connection"], 1);
  ASSERT_TRUE(running_.is_estimating());

  node.reset();
  ASSERT_TRUE(next(stream, is_absence));
  EXPECT_EQ(node_status()["connected"], false);
  EXPECT_EQ(node_status()["losses"], 1);
  EXPECT_THAT(node_status()["problem"].get<std::string>(), HasSubstr(path_));
  EXPECT_EQ(running_.status()["estimator"]["estimating"], false);
  EXPECT_EQ(running_.status()["estimator"]["noise_sd_m"], nullptr);
  EXPECT_EQ(running_.status()["estimator"]["assumed_mass_kg"], nullptr);  // the node has its own
  EXPECT_EQ(running_.status()["device"]["connected"], true);
  const std::uint64_t estimates = running_.box->status().counts.estimates;
  ASSERT_TRUE(next(stream, [](const Json& line) {
    EXPECT_TRUE(is_absence(line)) << line;
    return is_absence(line);
  })) << "a second later";
  EXPECT_EQ(running_.box->status().counts.estimates, estimates);
  EXPECT_TRUE(wait_for([&] { return node_status()["reports_not_sent"] > 100; }));
  ASSERT_EQ(post(running_.port, "/v1/session/start", "{}").status, 200);
  ASSERT_TRUE(next(stream, [](const Json& line) { return is_absence(line) && line["run"] == 2; }));

  node = std::make_unique<SocketNode>(path_, running_.clock);
  const auto again = next(stream, is_estimate);
  ASSERT_TRUE(again);
  EXPECT_EQ((*again)["node"]["connection"], 2);
  EXPECT_EQ((*again)["run"], 2);
  EXPECT_EQ((*again)["z"]["position_provenance"], "assumed")
      << "its estimator starts anew" << *again;
  EXPECT_TRUE(wait_for([&] { return node_status()["connections"] == 2; }));
}

TEST_F(BoxNode, EstimatesThatAreLateAreSaidToBe) {
  SocketNode node(path_, running_.clock);
  running_.configuration.node_late_ns = 200'000'000;
  running_.start();
  ASSERT_TRUE(running_.is_estimating());
  Listener stream(running_);
  running_.waits_for_node = false;
  node.delay_ns = 400'000'000;
  const auto late = next(stream, [](const Json& line) { return is_late(line, true); });
  ASSERT_TRUE(late);
  EXPECT_GT((*late)["node"]["delay_s"], 0.2);
  EXPECT_GT(node_status()["estimates_late"], 0);
  // What it is too slow for is not sent, rather than ever later.
  EXPECT_TRUE(wait_for([&] { return node_status()["reports_not_sent"] > 0; }));
  node.delay_ns = 0;
  running_.waits_for_node = true;
  ASSERT_TRUE(next(stream, [](const Json& line) { return is_late(line, false); }));
  EXPECT_EQ(node_status()["connections"], 1);
}

TEST_F(BoxNode, OneThatIsSilentIsSaidToBe) {
  SocketNode node(path_, running_.clock);
  running_.start();
  ASSERT_TRUE(running_.is_estimating());
  Listener stream(running_);
  // More than a second, after which that is said, and less than two, after which reports are lost.
  running_.pause();
  node.is_mute = true;
  running_.waits_for_node = false;
  running_.pause_after(1'500'000'000);
  ASSERT_TRUE(next(stream, is_absence));
  EXPECT_EQ(node_status()["silent"], true);
  EXPECT_EQ(node_status()["silences"], 1);
  EXPECT_EQ(node_status()["connected"], true);
  EXPECT_EQ(running_.status()["estimator"]["estimating"], false);
  node.is_mute = false;
  running_.waits_for_node = true;
  running_.go_on();
  ASSERT_TRUE(next(stream, [](const Json& line) { return is_late(line, false); }));
  EXPECT_TRUE(wait_for([&] { return running_.status()["estimator"]["estimating"] == true; }));
  EXPECT_EQ(node_status()["silences"], 1);
}

TEST_F(BoxNode, OneThatIsCutOffIsConnectedAgain) {
  SocketNode node(path_, running_.clock);
  running_.start();
  ASSERT_TRUE(running_.is_estimating());
  for (int losses = 1; losses <= 3; ++losses) {
    node.cut();
    ASSERT_TRUE(wait_for([&] { return node_status()["losses"] == losses; }));
    ASSERT_TRUE(wait_for([&] { return running_.status()["estimator"]["estimating"] == true; }));
    EXPECT_EQ(node_status()["connections"], losses + 1);
  }
}

// A recording is played, and the line is cut again and again.
TEST_F(BoxNode, EveryReportHasAnEstimateOrIsCounted) {
  SocketNode node(path_, running_.clock);
  ASSERT_NO_FATAL_FAILURE(play_recording(7500));
  running_.start();
  for (int losses = 1; losses <= 3; ++losses) {
    // Less than a third of the recording.
    running_.pause_after(4'500'000'000);
    ASSERT_TRUE(wait_for([&] { return running_.status()["estimator"]["estimating"] == true; }));
    running_.waits_for_node = false;
    node.is_mute = true;  // so that there is no answer to some
    ASSERT_TRUE(wait_for([&] { return open_reports(running_.status()) > 20; }));
    node.cut();
    node.is_mute = false;
    ASSERT_TRUE(wait_for([&] { return node_status()["losses"] == losses; }));
    running_.waits_for_node = true;
  }
  running_.go_on();
  ASSERT_TRUE(wait_for([&] { return running_.status()["device"]["ended"] == true; }));
  const Json status = status_when_whole(running_);
  EXPECT_EQ(status["node"]["losses"], 3);
  EXPECT_GT(status["node"]["reports_lost"], 0);
}

// It is greeted for longer than the recording takes.
TEST_F(BoxNode, OneThatComesAfterTheEndOfARecordingGetsWhatIsLeft) {
  SocketNode node(path_, running_.clock);
  ASSERT_NO_FATAL_FAILURE(play_recording(150));
  node.is_mute = true;
  running_.pause_after(1'000'000'000);
  running_.start();
  ASSERT_TRUE(wait_for([&] { return running_.status()["device"]["ended"] == true; }));
  node.is_mute = false;
  running_.go_on();
  const Json status = status_when_whole(running_);
  EXPECT_EQ(status["node"]["losses"], 0);
  EXPECT_EQ(status["node"]["reports_lost"], 0);
}

}  // namespace
}  // namespace condyle::box
