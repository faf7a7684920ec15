// SPDX-License-Identifier: Apache-2.0
// The PC's side of the line, where frames get lost: every report has its answer or is counted.
#include "hosted/node/node_client.h"

#include <gmock/gmock.h>

#include <atomic>
#include <bit>
#include <functional>
#include <limits>
#include <memory>
#include <thread>
#include <vector>

#include "condyle/firmware/estimator_node.h"
#include "hosted/files/input_error.h"
#include "support/virtual_line.h"

namespace condyle::host {
namespace {

using testing::HasSubstr;
using Type = hal::MessageType;
using testing_support::VirtualLine;

// A line that loses whole frames on their way out. Each write is one.
class LossyLine final : public hal::ByteStream {
 public:
  // `loses(type, n)`: is the frame of this type lost, the n-th from 0?
  using Loses = std::function<bool(hal::MessageType type, int number)>;

  explicit LossyLine(VirtualLine::End& line) : line_(line) {}
  void lose(Loses loses) { loses_ = std::move(loses); }

  hal::Status read(TimeNs deadline_ns, std::span<std::uint8_t> bytes, std::size_t& count) override {
    return line_.read(deadline_ns, bytes, count);
  }
  hal::Status write(std::span<const std::uint8_t> bytes) override {
    // The first byte after 0 and the code is the type, which is never 0.
    const auto type = static_cast<hal::MessageType>(bytes[2]);
    if (loses_ && loses_(type, numbers_[bytes[2]]++)) return hal::Status::ok;
    return line_.write(bytes);
  }

 private:
  VirtualLine::End& line_;
  Loses loses_;
  std::array<int, 256> numbers_{};
};

class QuietTarget final : public firmware::NodeTarget {
 public:
  hal::GreetingMessage greeting() override { return {}; }
  std::optional<hal::FaultMessage> fault() override { return std::nullopt; }
  void add_to(hal::HealthMessage&) override {}
  void feed_watchdog() override {}
};

// The report's number is a position along one axis.
hal::ReportLayout layout() {
  hal::ReportLayout layout;
  layout.kind = SampleKind::one_axis;
  const hal::ReportField field{.width_bits = 64, .type = hal::FieldType::floating_point};
  (void)layout.coordinates.push_back({field, 0});
  layout.minimum_size_bytes = 8;
  return layout;
}

class NodeClientTest : public testing::Test {
 protected:
  explicit NodeClientTest(TimeNs patience_ns = NodeClient::kUsualPatience_ns)
      : client_(out_, clock_, "the line", patience_ns) {}
  ~NodeClientTest() override {
    line_.cut();
    if (thread_.joinable()) thread_.join();
  }

  void connect() {
    line_.attach_far();
    thread_ = std::thread([this] {
      std::make_unique<firmware::EstimatorNode<float>>(back_, line_.far, target_)->serve();
      line_.detach_far();
    });
    client_.connect([this] { return stops_; });
  }

  // Loses what `to_node` and `from_node` say, from the start of the run.
  void begin(int lag, LossyLine::Loses to_node, LossyLine::Loses from_node) {
    back_.lose(std::move(from_node));
    connect();
    hal::StartMessage start;
    start.lag = static_cast<std::uint8_t>(lag);
    client_.begin(layout(), start);
    out_.lose(std::move(to_node));
  }

  // Sends so many reports and takes all answers; the number of estimates.
  int run(int reports) {
    int sent = 0, estimates = 0;
    for (NodeAnswer answer = NodeAnswer::none; answer != NodeAnswer::finished;) {
      if (sent < reports && client_.has_room()) {
        hal::RawReport report;
        report.host_time_ns = TimeNs{sent} * 16'666'667;
        const auto bytes = std::bit_cast<std::array<std::uint8_t, 8>>(1e-3 * sent);
        std::copy(bytes.begin(), bytes.end(), report.bytes.begin());
        report.size = 8;
        client_.send(report);
        if (++sent == reports) client_.finish();
      }
      const bool has_to_send = sent < reports && client_.has_room();
      answer = client_.receive(clock_.now_ns() + (has_to_send ? 0 : 20'000'000));
      if (answer == NodeAnswer::estimate) ++estimates;
    }
    return estimates;
  }

  VirtualLine line_;
  hal::Clock& clock_ = line_.near;  // of the test's thread
  LossyLine out_{line_.near}, back_{line_.far};
  QuietTarget target_;
  NodeClient client_;
  bool stops_ = false;
  std::thread thread_;
};

TEST_F(NodeClientTest, HasAnAnswerToEveryReport) {
  begin(3, {}, {});
  EXPECT_EQ(run(300), 303) << "the first three are of instants that are not ready yet";
  EXPECT_EQ(client_.reports_sent(), 300U);
  EXPECT_EQ(client_.reports_lost(), 0U);
  EXPECT_EQ(client_.frames_lost(), 0U);
  const auto health = client_.ask_health();
  ASSERT_TRUE(health);
  EXPECT_EQ(health->samples, 300U);
}

TEST_F(NodeClientTest, CountsReportsThatTheLineLoses) {
  begin(3, [](Type type, int n) { return type == Type::report && (n == 100 || n == 298); }, {});
  EXPECT_EQ(run(300), 301);
  EXPECT_EQ(client_.reports_lost(), 2U);
  const auto health = client_.ask_health();
  ASSERT_TRUE(health);
  EXPECT_EQ(health->frames.lost, 2U);
}

TEST_F(NodeClientTest, CountsAnswersThatTheLineLoses) {
  begin(0, {}, [](Type type, int n) { return type == Type::recommended_estimate && n == 7; });
  EXPECT_EQ(run(300), 299);
  EXPECT_EQ(client_.reports_lost(), 1U);
  EXPECT_EQ(client_.frames_lost(), 1U);
}

// The estimates that waited for the end answer no report, but their frames are numbered.
TEST_F(NodeClientTest, SeesThatAWaitingEstimateIsLost) {
  begin(3, {}, [](Type type, int n) { return type == Type::recommended_estimate && n == 301; });
  EXPECT_EQ(run(300), 302);
  EXPECT_EQ(client_.reports_lost(), 0U);
  EXPECT_EQ(client_.frames_lost(), 1U);
}

// Without answer to the last reports, it asks whether the target is there, and goes on.
TEST_F(NodeClientTest, AsksWhetherASilentTargetIsThere) {
  begin(0, [](Type type, int n) { return type == Type::finish && n == 0; }, {});
  EXPECT_EQ(run(20), 20);
  EXPECT_EQ(client_.reports_lost(), 0U);
}

TEST_F(NodeClientTest, GoesOnAfterAWindowOfReportsIsLost) {
  begin(0, [](Type type, int n) { return type == Type::report && n >= 10 && n < 60; }, {});
  // So many that the window is full: only the question for health opens it again.
  EXPECT_EQ(run(100), 50);
  EXPECT_EQ(client_.reports_lost(), 50U);
}

// During a run, and also where the answer is lost.
TEST_F(NodeClientTest, HasTheHealthOfTheRun) {
  begin(0, {}, [](Type type, int n) { return type == Type::health && n == 1; });
  const TimeNs begin_ns = clock_.now_ns();
  client_.send({});
  while (client_.health()->bad_reports == 0 && clock_.now_ns() - begin_ns < 20'000'000'000) {
    client_.request_health();
    (void)client_.receive(clock_.now_ns() + 20'000'000);
  }
  EXPECT_EQ(client_.health()->bad_reports, 1U) << "the report was empty";
  EXPECT_FALSE(client_.silent_since_ns());
  EXPECT_EQ(client_.frames_lost(), 1U);
}

// The question that follows is answered as well: it says what became of the report in between.
TEST_F(NodeClientTest, TakesNoLateAnswerForThatToALaterQuestion) {
  begin(0, {}, [this](Type type, int n) {
    if (type == Type::health && n == 1) {
      line_.far.sleep_until(line_.far.now_ns() + 2'500'000'000);
    }
    return false;
  });
  client_.request_health();
  client_.send({});
  const TimeNs begin_ns = clock_.now_ns();
  while (client_.silent_since_ns() && clock_.now_ns() - begin_ns < 20'000'000'000) {
    (void)client_.receive(clock_.now_ns() + 20'000'000);
  }
  EXPECT_GT(seconds(clock_.now_ns() - begin_ns), 2);
  EXPECT_FALSE(client_.silent_since_ns());
  EXPECT_EQ(client_.reports_lost(), 0U);
}

// What the greeting tells is looked at before anything is sent.
TEST_F(NodeClientTest, SaysBeforehandWhatTheTargetCannot) {
  connect();
  const auto expect_refused = [&](const hal::ReportLayout& layout, const hal::StartMessage& start,
                                  const char* words) {
    try {
      client_.begin(layout, start);
      ADD_FAILURE() << "takes it: " << words;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(words));
    }
  };
  hal::ReportLayout bad = layout();
  bad.coordinates[0].field.offset_bits = 1;
  expect_refused(bad, {}, "the line: cannot decode these reports; check the device's profile");
  hal::StartMessage start;
  start.followed.point = 2;
  expect_refused(layout(), start,
                 "cannot follow point 2: the reports have one point; follow point 1");
  start = {};
  start.lag = static_cast<std::uint8_t>(client_.greeting().longest_lag + 1);
  expect_refused(layout(), start, "no memory for a lag of ");
  // What only a target of another version refuses.
  start = {};
  start.recommended.noise.memory_s = 1e9;
  expect_refused(layout(), start, "refused message 3 at value ");
  client_.begin(layout(), {});
}

TEST_F(NodeClientTest, LimitsTheKernelsToTheTargetsMemory) {
  connect();
  const int most = client_.greeting().most_kernels;
  EXPECT_EQ(most, kMostKernels);
  hal::StartMessage start;
  for (const double kernels : {0.0, 40.0, 96.0}) {
    start.recommended.learning.kernels = kernels;
    EXPECT_EQ(client_.within_memory(start).recommended.learning.kernels, kernels);
  }
}

TEST_F(NodeClientTest, SaysThatNobodyIsThere) {
  const TimeNs begin_ns = clock_.now_ns();
  try {
    client_.connect([] { return false; });
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no estimator answers"));
  }
  EXPECT_LT(seconds(clock_.now_ns() - begin_ns), 10) << "of the line's time";
}

TEST_F(NodeClientTest, TakesALateGreetingForNoRestart) {
  connect();
  hal::LinkEnd earlier(out_);
  ASSERT_EQ(earlier.send(hal::HelloMessage{}), hal::Status::ok);
  client_.begin(layout(), {});
  EXPECT_EQ(run(20), 20);
}

TEST_F(NodeClientTest, WaitsForNoAcceptanceOnceItIsStopped) {
  connect();
  out_.lose([](Type, int) { return true; });
  stops_ = true;
  const TimeNs begin_ns = clock_.now_ns();
  EXPECT_THROW(client_.begin(layout(), {}), InputError);
  EXPECT_LE(seconds(clock_.now_ns() - begin_ns), 0.4);
}

class PatientClient : public NodeClientTest, public testing::WithParamInterface<double> {
 protected:
  PatientClient() : NodeClientTest(nanoseconds(GetParam())) {}
  // Of the line's time, until `act` finds that the target is silent; in patiences.
  double patiences_of(const std::function<void()>& act) {
    const TimeNs begin_ns = clock_.now_ns();
    EXPECT_THROW(act(), InputError);
    return seconds(clock_.now_ns() - begin_ns) / GetParam();
  }
};

TEST_P(PatientClient, GivesATargetThatNeverAnswersItsPatience) {
  const double patiences = patiences_of([&] { client_.connect([] { return false; }); });
  EXPECT_GE(patiences, 1.5);
  EXPECT_LE(patiences, 1.5 + 0.4 / GetParam()) << "a greeting is awaited for 0.3 s";
}

TEST_P(PatientClient, AsksThreeTimesWhetherATargetIsThereThatFellSilent) {
  std::atomic<bool> is_silent = false;
  begin(0, {}, [&](Type, int) { return is_silent.load(); });
  is_silent = true;
  const double patiences = patiences_of([&] { (void)run(20); });
  EXPECT_GE(patiences, 4);
  EXPECT_LE(patiences, 4 + 0.4 / GetParam());
}

INSTANTIATE_TEST_SUITE_P(Patiences, PatientClient, testing::Values(0.5, 2.0, 120.0));

TEST_F(NodeClientTest, SaysThatTheLineWasCut) {
  begin(0, {}, {});
  hal::RawReport report;
  report.size = 8;
  client_.send(report);
  line_.cut();
  try {
    for (int i = 0; i < 100; ++i) (void)client_.receive(clock_.now_ns() + 20'000'000);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("was closed"));
  }
}

TEST_F(NodeClientTest, CountsTheReportThatACutLineDidNotTake) {
  begin(0, {}, {});
  line_.cut();
  hal::RawReport report;
  report.size = 8;
  EXPECT_THROW(client_.send(report), InputError);
  EXPECT_EQ(client_.reports_sent(), 1U);
}

TEST_F(NodeClientTest, KnowsNoHealthAtOnceWhereTheLineWasCut) {
  begin(0, {}, {});
  line_.end_to_near();
  const TimeNs begin_ns = clock_.now_ns();
  EXPECT_FALSE(client_.ask_health());
  EXPECT_EQ(clock_.now_ns(), begin_ns);
}

// A peer that never falls silent: the clock goes on by a microsecond for each byte that is read.
class FloodLine final : public hal::ByteStream {
 public:
  FloodLine(hal::ManualClock& clock, std::vector<std::uint8_t> bytes)
      : clock_(clock), bytes_(std::move(bytes)) {}
  hal::Status read(TimeNs, std::span<std::uint8_t> bytes, std::size_t& count) override {
    for (std::uint8_t& byte : bytes) byte = bytes_[next_++ % bytes_.size()];
    count = bytes.size();
    clock_.sleep_until(clock_.now_ns() + static_cast<TimeNs>(count) * 1000);
    return hal::Status::ok;
  }
  hal::Status write(std::span<const std::uint8_t>) override { return hal::Status::ok; }

 private:
  hal::ManualClock& clock_;
  std::vector<std::uint8_t> bytes_;
  std::size_t next_ = 0;
};

template <class Message>
std::vector<std::uint8_t> frame_of(const Message& message) {
  std::array<std::uint8_t, hal::kMaxPayload> payload;
  std::array<std::uint8_t, hal::kMaxFrameSize> frame;
  const auto size = hal::put(message, payload);
  hal::FrameEncoder encoder;
  const std::size_t length = encoder.encode(static_cast<std::uint8_t>(Message::kType),
                                            std::span(payload).first(*size), frame);
  return {frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(length)};
}

TEST(FloodedNodeClient, EndsWhateverComes) {
  const std::vector<std::vector<std::uint8_t>> floods = {
      {0x55, 0xaa, 0x12},
      {0},
      {1, 2, 3, 0},
      frame_of(hal::HealthMessage{}),
      frame_of(hal::AcceptedMessage{hal::MessageType::layout})};
  for (std::size_t i = 0; i < floods.size(); ++i) {
    hal::ManualClock clock;
    FloodLine line(clock, floods[i]);
    NodeClient client(line, clock, "flood");
    EXPECT_THROW(client.connect([] { return false; }), InputError) << i;
    EXPECT_LT(clock.now_ns(), 10 * kNanosecondsPerSecond) << i;
    // And once it is asked to stop.
    int asked = 0;
    const TimeNs begin_ns = clock.now_ns();
    EXPECT_THROW(client.connect([&asked] { return ++asked > 1; }), InputError) << i;
    EXPECT_LT(clock.now_ns() - begin_ns, kNanosecondsPerSecond) << i;
    NodeClient other(line, clock, "flood");
    EXPECT_THROW(other.connect([] { return false; }), InputError) << i;
    EXPECT_THROW(other.begin(layout(), {}), InputError) << i;
    const TimeNs deadline_ns = clock.now_ns() + kNanosecondsPerSecond;
    EXPECT_EQ(client.receive(deadline_ns), NodeAnswer::none) << i;
    EXPECT_LT(clock.now_ns(), deadline_ns + kNanosecondsPerSecond) << i;
    client.finish();
    EXPECT_THROW(
        while (clock.now_ns() < 100 * kNanosecondsPerSecond) {
          (void)client.receive(clock.now_ns() + kNanosecondsPerSecond);
        },
        InputError)
        << i;
  }
}

}  // namespace
}  // namespace condyle::host
