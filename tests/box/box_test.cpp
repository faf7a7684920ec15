// SPDX-License-Identifier: Apache-2.0
// The service on a synthetic facebow, asked over HTTP.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <map>
#include <vector>

#include "box/running_box.h"
#include "box/stream_reader.h"
#include "condyle/hal/log/session_log_reader.h"
#include "hosted/files/input_error.h"
#include "support/command.h"
#include "support/read_log.h"
#include "support/table.h"

namespace condyle::box {
namespace {

using testing::HasSubstr;
using testing_support::EventStream;
using testing_support::get;
using testing_support::Listener;
using testing_support::post;
using testing_support::RunningBox;
using testing_support::StreamReader;
using testing_support::wait_for;
using Json = nlohmann::json;

TEST(Box, SaysHowItDoes) {
  RunningBox running;
  running.start();
  ASSERT_TRUE(running.is_estimating());
  const Json status = running.status();
  EXPECT_EQ(status["format"], "condyle-box-status-1");
  EXPECT_THAT(status["note"].get<std::string>(), HasSubstr("not a diagnosis"));
  EXPECT_EQ(status["device"]["name"], "condyle fake facebow");
  EXPECT_EQ(status["device"]["connected"], true);
  EXPECT_GT(status["device"]["reports_received"], 0);
  EXPECT_EQ(status["device"]["reports_lost"], 0);
  EXPECT_EQ(status["estimator"]["estimating"], true);
  EXPECT_GT(status["real_time"]["report_to_estimate"]["max_s"], 0.0);
  EXPECT_EQ(status["session"]["phase"], "idle");
  EXPECT_TRUE(wait_for([&] {
    const double rate_Hz = running.box->status().rate_Hz;
    return rate_Hz > 400 && rate_Hz < 600;
  }));
}

// So many reports of the session have been written.
bool has_recorded(const RunningBox& running, int reports) {
  return wait_for([&] { return running.status()["session"]["reports_written"] >= reports; });
}

// Every number that went out live is in the replay of the recording, bit for bit, and no other;
// what the log keeps of learning is what the replay learns.
TEST(Box, AReplayIsTheLiveSessionAgain) {
  RunningBox running;
  running.start();
  ASSERT_TRUE(running.is_estimating());
  Listener stream(running);
  std::map<std::int64_t, Json> live;  // of the second run
  StreamReader reader(stream, [&live](const EventStream::Event& event) {
    EXPECT_EQ(event.name, "");
    Json estimate = Json::parse(event.data);
    if (estimate["run"] == 2) live.emplace(estimate["number"], estimate);
    return estimate["run"] != 3;
  });
  ASSERT_EQ(post(running.port, "/v1/session/start", R"({"subject":"S-07"})").status, 200);
  ASSERT_TRUE(has_recorded(running, 350));
  ASSERT_EQ(post(running.port, "/v1/session/marker", R"({"text":"first, \"bite\""})").status, 200);
  ASSERT_TRUE(has_recorded(running, 500));
  const testing_support::HttpAnswer stopped = post(running.port, "/v1/session/stop", "{}");
  ASSERT_EQ(stopped.status, 200);
  const std::string log = Json::parse(stopped.body)["done"];
  EXPECT_THAT(log, testing::EndsWith("Z-S-07.mcap"));

  ASSERT_TRUE(reader.wait());
  const std::string csv = running.folder / "again.csv", values = running.folder / "values";
  const std::string learned = running.folder / "learned.json";
  const auto replayed = testing_support::run_condyle(
      {"replay", log, "--out", csv, "--values", values, "--learned-out", learned});
  ASSERT_EQ(replayed.exit_code, 0) << replayed.errors;
  EXPECT_THAT(replayed.output, HasSubstr("s: first, \"bite\"\n"));
  std::string kept;
  ASSERT_EQ(hal::read_learned_text(log, kept), hal::Status::ok);
  EXPECT_EQ(kept == testing_support::read_file(learned), true) << kept.size();
  EXPECT_THAT(testing_support::read_file(values + "/markers.csv"),
              HasSubstr(",\"first, \"\"bite\"\"\"\n"));
  const testing_support::Table table = testing_support::read_table(csv);
  ASSERT_GT(table.rows, 400U);
  ASSERT_EQ(table.rows, live.size());
  for (const char* axis : {"x", "y", "z"}) {
    for (const char* name : {"position_m", "velocity_m_s", "acceleration_m_s2", "position_sd_m",
                             "velocity_sd_m_s", "acceleration_sd_m_s2"}) {
      const std::vector<double> again = table.numbers(std::string(axis) + "_" + name);
      std::int64_t number = 0;
      for (const double value : again) {
        ASSERT_EQ(live.at(++number)[axis][name].get<double>(), value) << axis << name << number;
      }
    }
  }
}

// The pose too, and a point of the jaw.
TEST(Box, AReplayHasTheLivePoseAgain) {
  RunningBox running;
  running.configuration.pose.emplace();
  running.configuration.pose->add_point("test", {"incisor", {0, 0.08, -0.03}});
  running.start();
  ASSERT_TRUE(running.is_estimating());
  Listener stream(running);
  std::vector<Json> live;  // of the second run
  StreamReader reader(stream, [&live](const EventStream::Event& event) {
    const Json estimate = Json::parse(event.data);
    if (estimate["run"] == 2) live.push_back(estimate["pose"]);
    return estimate["run"] != 3;
  });
  ASSERT_EQ(post(running.port, "/v1/session/start", "{}").status, 200);
  ASSERT_TRUE(has_recorded(running, 300));
  const testing_support::HttpAnswer stopped = post(running.port, "/v1/session/stop", "{}");
  ASSERT_EQ(stopped.status, 200);
  ASSERT_TRUE(reader.wait());
  const std::string csv = running.folder / "pose.csv";
  const auto replayed =
      testing_support::run_condyle({"replay", std::string(Json::parse(stopped.body)["done"]),
                                    "--pose", csv, "--pose-point", "incisor", "0", "80", "-30"});
  ASSERT_EQ(replayed.exit_code, 0) << replayed.errors;
  const testing_support::Table table = testing_support::read_table(csv);
  ASSERT_EQ(table.rows, live.size());
  for (const std::string name : {"centre", "rotation_vector", "angular_velocity", "incisor"}) {
    const std::string unit = name == "angular_velocity"  ? "rad_s"
                             : name == "rotation_vector" ? "rad"
                                                         : "m";
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const std::string middle : {"_", "_sd_"}) {
        const auto again = table.numbers(name + "_" + "xyz"[axis] + middle + unit);
        for (std::size_t i = 0; i < again.size(); ++i) {
          const Json& value = live[i][name + middle + unit][axis];
          ASSERT_EQ(value.is_null(), std::isnan(again[i])) << name << i;
          if (value.is_null()) continue;
          ASSERT_EQ(value.get<double>(), again[i]) << name << i;
        }
      }
    }
    EXPECT_EQ(live.back()[name + "_provenance"], "measured");
  }
}

TEST(Box, SaysWhyASessionCannotBe) {
  RunningBox running;
  running.start();
  ASSERT_TRUE(running.is_estimating());
  EXPECT_EQ(post(running.port, "/v1/session/stop", "{}").status, 409);
  EXPECT_EQ(post(running.port, "/v1/session/marker", R"({"text":"x"})").status, 409);
  EXPECT_EQ(post(running.port, "/v1/session/start", R"({"subject":"J. Doe"})").status, 400);
  EXPECT_EQ(post(running.port, "/v1/session/start", "{}").status, 200);
  EXPECT_EQ(post(running.port, "/v1/session/start", "{}").status, 409);
  EXPECT_EQ(post(running.port, "/v1/session/marker", R"({"text":")" + std::string(600, 'x') + "\"}")
                .status,
            400);
  EXPECT_EQ(running.status()["session"]["phase"], "recording");
  EXPECT_EQ(post(running.port, "/v1/session/stop", "{}").status, 200);

  // In the same second.
  EXPECT_EQ(post(running.port, "/v1/session/start", "{}").status, 200);
  EXPECT_EQ(post(running.port, "/v1/session/stop", "{}").status, 200);

  RunningBox full;
  full.configuration.reserve_bytes = std::uint64_t{1} << 60U;
  full.start();
  ASSERT_TRUE(full.is_estimating());
  const auto answer = post(full.port, "/v1/session/start", "{}");
  EXPECT_EQ(answer.status, 507);
  EXPECT_THAT(answer.body, HasSubstr("the disk has less than"));
  EXPECT_THAT(full.status()["session"]["problem"].get<std::string>(), HasSubstr("the disk"));

  RunningBox without;
  without.configuration.folder.clear();
  without.start();
  ASSERT_TRUE(without.is_estimating());
  EXPECT_EQ(post(without.port, "/v1/session/start", "{}").status, 409);
}

// A real failure of the file system, though of one file: it may not grow beyond a limit.
TEST(Box, PausesWhereTheDiskIsFullAndGoesOn) {
  RunningBox running;
  running.start();
  ASSERT_TRUE(running.is_estimating());
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  ASSERT_EQ(post(running.port, "/v1/session/start", "{}").status, 200);
  ASSERT_TRUE(has_recorded(running, 1));
  running.pause_after(nanoseconds(1));  // less than a pause of the recording
  const rlimit small{running.status()["session"]["bytes_written"].get<rlim_t>(), before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  EXPECT_TRUE(wait_for([&] { return running.status()["session"]["phase"] == "paused"; }));
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_THAT(running.status()["session"]["problem"].get<std::string>(), HasSubstr("disk is full"));
  EXPECT_EQ(running.status()["session"]["pauses"], 1);
  running.go_on();
  EXPECT_TRUE(wait_for([&] { return running.status()["session"]["phase"] == "recording"; }));
  EXPECT_EQ(running.status()["session"]["part"], 2);
  EXPECT_GT(running.status()["session"]["paused_s"], 1.0);
  EXPECT_EQ(post(running.port, "/v1/session/marker", R"({"text":"x"})").status, 200);
  const int recorded = running.status()["session"]["reports_written"];
  EXPECT_TRUE(has_recorded(running, recorded + 1));
  EXPECT_EQ(post(running.port, "/v1/session/stop", "{}").status, 200);
  const Json session = running.status()["session"];
  EXPECT_GT(session["reports_in_pauses"], 0);
  EXPECT_EQ(session["reports_received"].get<int>(), session["reports_written"].get<int>() +
                                                        session["reports_lost"].get<int>() +
                                                        session["reports_in_pauses"].get<int>());
  int logs = 0;
  for (const auto& file : std::filesystem::directory_iterator(running.folder.path())) {
    ++logs;
    const auto replayed = testing_support::run_condyle({"replay", file.path().string()});
    EXPECT_EQ(replayed.exit_code, 0) << replayed.errors;
  }
  EXPECT_EQ(logs, 2);
}

TEST(Box, GoesOnInAnotherFileWhereTheLogIsDeleted) {
  RunningBox running;
  running.start();
  ASSERT_TRUE(running.is_estimating());
  ASSERT_EQ(post(running.port, "/v1/session/start", "{}").status, 200);
  ASSERT_TRUE(has_recorded(running, 1));
  const std::string deleted = running.status()["session"]["file"];
  std::filesystem::remove(deleted);
  ASSERT_TRUE(wait_for([&] { return running.status()["session"]["part"] == 2; }));
  ASSERT_TRUE(has_recorded(running, 300));
  EXPECT_EQ(post(running.port, "/v1/session/stop", "{}").status, 200);
  const Json session = running.status()["session"];
  std::string kept;
  ASSERT_EQ(hal::read_learned_text(session["file"], kept), hal::Status::ok);
  EXPECT_THAT(kept, HasSubstr("condyle-learned-1")) << "of the part's own run";
  EXPECT_EQ(session["pauses"], 0);
  EXPECT_GT(session["reports_lost"], 0);
  EXPECT_EQ(session["reports_received"].get<int>(),
            session["reports_written"].get<int>() + session["reports_lost"].get<int>());
}

TEST(Box, WaitsForAFacebowThatIsNotThere) {
  RunningBox running;
  running.configuration.facebow.kind = SourceSettings::Kind::usb;
  running.start();
  EXPECT_TRUE(wait_for([&] { return running.status()["device"]["problem"] != ""; }));
  const Json status = running.status();
  EXPECT_EQ(status["device"]["found"], false);
  EXPECT_THAT(status["device"]["problem"].get<std::string>(), HasSubstr("1209:0001"));
  EXPECT_EQ(post(running.port, "/v1/session/start", "{}").status, 503);
}

TEST(Box, RefusesACompanionThatMayBeTheFacebow) {
  RunningBox running;
  running.configuration.facebow.kind = SourceSettings::Kind::usb;
  running.configuration.companions = {running.configuration.facebow};
  EXPECT_THROW(running.start(), host::InputError);
  running.configuration.facebow.serial = "1";
  running.configuration.companions[0].serial = "2";
  EXPECT_NO_THROW(running.start());
}

TEST(Box, SendsDatagrams) {
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  socklen_t size = sizeof address;
  getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  RunningBox running;
  running.configuration.udp_port = ntohs(address.sin_port);
  running.start();
  std::int64_t last = 0;
  for (int i = 0; i < 50; ++i) {
    char line[8192];
    const ssize_t length = recv(socket, line, sizeof line, 0);
    ASSERT_GT(length, 0);
    const Json estimate = Json::parse(line, line + length);
    EXPECT_GT(estimate["number"], last);
    last = estimate["number"];
  }
  ::close(socket);
}

TEST(Box, TellsAListenerWhereItIs) {
  RunningBox running;
  running.listened = 0;
  running.start();
  ASSERT_TRUE(running.is_estimating());
  std::uint64_t last = 0;
  {
    Listener stream(running, "?after=0");
    EventStream::Event event;
    for (std::uint64_t i = 1; i <= 100; ++i) {
      ASSERT_TRUE(stream.next(event));
      ASSERT_EQ(event.id, i);
    }
    last = event.id;
  }
  Listener again(running, "?after=" + std::to_string(last));
  EventStream::Event event;
  ASSERT_TRUE(again.next(event));
  EXPECT_EQ(event.id, last + 1);
}

TEST(Box, SaysThatTheWallClockWasSet) {
  RunningBox running;
  running.start();
  ASSERT_TRUE(running.is_estimating());
  EXPECT_EQ(running.status()["wall_clock"]["steps"], 0);
  running.wall_offset_ns = -3 * kNanosecondsPerSecond;
  EXPECT_TRUE(wait_for([&] { return running.status()["wall_clock"]["steps"] == 1; }));
  EXPECT_NEAR(running.status()["wall_clock"]["last_step_s"].get<double>(), -3.0, 0.2);
}

// The number of a line from before a restart is none of this box.
TEST(Box, TellsAListenerOfAnEarlierBoxAllItHas) {
  RunningBox running;
  running.listened = 0;
  running.start();
  ASSERT_TRUE(running.is_estimating());
  Listener stream(running, "?after=18446744073709551615");
  EventStream::Event event;
  ASSERT_TRUE(stream.next(event));
  EXPECT_EQ(event.id, 1U);
}

// At the speed it was recorded with, from now on, which is a day later; twice the same estimates.
TEST(Box, PlaysASessionLog) {
  testing_support::TemporaryFolder folder;
  std::string log;
  {
    RunningBox running;
    running.start();
    ASSERT_TRUE(running.is_estimating());
    ASSERT_EQ(post(running.port, "/v1/session/start", "{}").status, 200);
    ASSERT_TRUE(has_recorded(running, 350));
    log = Json::parse(post(running.port, "/v1/session/stop", "{}").body)["done"];
    std::filesystem::copy_file(log, folder / "log.mcap");
  }
  const testing_support::ReadLog recorded = testing_support::read_log(folder / "log.mcap");
  ASSERT_EQ(recorded.opened, hal::Status::ok);
  const auto& reports = recorded.reports.at(0);
  RunningBox again(10, 86'400 * kNanosecondsPerSecond);
  again.configuration.facebow = {"facebow", SourceSettings::Kind::file, folder / "log.mcap", ""};
  const TimeNs begin_ns = again.clock.now_ns();
  again.start();
  EXPECT_TRUE(wait_for([&] { return again.status()["device"]["ended"] == true; }));
  EXPECT_GE(again.clock.now_ns() - begin_ns,
            reports.back().host_time_ns - recorded.header.start_monotonic_ns);
  const Json status = again.status();
  EXPECT_EQ(status["device"]["reports_received"], reports.size());
  EXPECT_EQ(status["estimator"]["estimating"], false);
  EXPECT_LT(status["real_time"]["report_to_estimate"]["p50_s"], 3600)
      << "the reports have the times of the recording";
}

}  // namespace
}  // namespace condyle::box
