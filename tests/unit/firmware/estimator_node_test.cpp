// SPDX-License-Identifier: Apache-2.0
// The node that a microcontroller runs, here on this computer: what it answers, whatever it is
// told.
#include "condyle/firmware/estimator_node.h"

#include <gmock/gmock.h>

#include <atomic>
#include <bit>
#include <memory>
#include <thread>
#include <vector>

#include "support/random.h"
#include "support/virtual_line.h"

namespace condyle::firmware {
namespace {

using hal::MessageType;
using hal::RefusalReason;
using hal::Status;

constexpr TimeNs kPatience_ns = 5'000'000'000;

class TestTarget final : public NodeTarget {
 public:
  hal::GreetingMessage greeting() override {
    hal::GreetingMessage greeting;
    greeting.core_name = hal::fixed_text("test");
    greeting.boot_count = 7;
    return greeting;
  }
  std::optional<hal::FaultMessage> fault() override {
    hal::FaultMessage fault;
    fault.kind = hal::FaultKind::usage;
    fault.pc = 0x1234;
    return fault;
  }
  void add_to(hal::HealthMessage& health) override { health.uart_overruns = 3; }
  void feed_watchdog() override { ++feeds_; }
  int feeds() const { return feeds_; }

 private:
  std::atomic<int> feeds_ = 0;
};

// A node on a thread, and the PC's end of the line to it.
class EstimatorNodeTest : public testing::Test {
 protected:
  static constexpr int kMostLag = 4, kKernels = 32;
  using Node = EstimatorNode<float, std::type_identity_t, kMostLag, true, kKernels>;
  template <bool kIdentifies>
  using Expected = SensorOf<float, 1, kMostLag, kIdentifies, kKernels>;

  EstimatorNodeTest() {
    line_.attach_far();
    thread_ = std::thread([this] {
      std::make_unique<Node>(line_.far, line_.far, target_)->serve();
      line_.detach_far();
    });
    EXPECT_TRUE(receives(MessageType::greeting));
    EXPECT_TRUE(receives(MessageType::fault));
  }
  ~EstimatorNodeTest() override {
    line_.cut();
    thread_.join();
  }

  bool receives(MessageType type) {
    return end_.receive(line_.near.now_ns() + kPatience_ns) == Status::ok && end_.type() == type;
  }
  template <class Message>
  void tell(const Message& message) {
    ASSERT_EQ(end_.send(message), Status::ok);
  }
  void expect_learning(int lag);
  template <class Message>
  Message heard() {
    Message message;
    EXPECT_TRUE(receives(Message::kType));
    EXPECT_EQ(hal::get(end_.frame().payload, message).reason, RefusalReason::none);
    return message;
  }
  void expect_accepted(MessageType type) { EXPECT_EQ(heard<hal::AcceptedMessage>().message, type); }
  void expect_refused(MessageType type, RefusalReason reason) {
    const auto refused = heard<hal::RefusedMessage>();
    EXPECT_EQ(refused.message, static_cast<std::uint8_t>(type));
    EXPECT_EQ(refused.refusal.reason, reason);
  }

  // Numbers of 64 bits: a position along one axis; with `has_drive` a drive after it.
  static hal::LayoutMessage layout(bool has_drive = false) {
    hal::LayoutMessage message;
    message.layout.kind = SampleKind::one_axis;
    hal::ReportField field;
    field.width_bits = 64;
    field.type = hal::FieldType::floating_point;
    (void)message.layout.coordinates.push_back({field, 0});
    message.layout.minimum_size_bytes = 8;
    if (has_drive) {
      field.offset_bits = 64;
      message.layout.drive_N = field;
      message.layout.minimum_size_bytes = 16;
    }
    return message;
  }
  void begin(hal::StartMessage start, bool has_drive = false) {
    tell(layout(has_drive));
    expect_accepted(MessageType::layout);
    start.recommended.learning.kernels = kKernels;
    tell(start);
    expect_accepted(MessageType::start);
  }
  void report(TimeNs time_ns, double position_m) {
    const auto bytes = std::bit_cast<std::array<std::uint8_t, 8>>(position_m);
    tell(hal::ReportMessage{time_ns, bytes});
  }

  testing_support::VirtualLine line_;
  hal::LinkEnd end_{line_.near};
  TestTarget target_;
  std::thread thread_;
};

TEST_F(EstimatorNodeTest, GreetsWithItsNameScalarAndFault) {
  tell(hal::HelloMessage{});
  const auto greeting = heard<hal::GreetingMessage>();
  EXPECT_EQ(hal::text_of(greeting.core_name), "test");
  EXPECT_EQ(greeting.scalar_size, sizeof(float));
  EXPECT_EQ(greeting.boot_count, 7U);
  EXPECT_TRUE(greeting.has_fault);
  EXPECT_EQ(heard<hal::FaultMessage>().pc, 0x1234U);
  tell(hal::HelloMessage{.version = hal::kLinkVersion + 1});
  expect_refused(MessageType::hello, RefusalReason::wrong_version);
}

TEST_F(EstimatorNodeTest, TakesNothingOutOfItsTurn) {
  report(0, 0);
  expect_refused(MessageType::report, RefusalReason::not_expected);
  tell(hal::FinishMessage{});
  expect_refused(MessageType::finish, RefusalReason::not_expected);
  tell(hal::StartMessage{});
  expect_refused(MessageType::start, RefusalReason::not_expected);
  tell(hal::FaultMessage{});  // what only a target says
  expect_refused(MessageType::fault, RefusalReason::unknown_type);
  begin({});
  tell(layout());
  expect_refused(MessageType::layout, RefusalReason::not_expected);
}

TEST_F(EstimatorNodeTest, RefusesLayoutsPointsAndParametersThatCannotBeUsed) {
  hal::LayoutMessage bad = layout();
  bad.layout.coordinates[0].field.offset_bits = 1;
  tell(bad);
  const auto refused = heard<hal::RefusedMessage>();
  EXPECT_EQ(refused.refusal.reason, RefusalReason::unusable_layout);
  tell(hal::StartMessage{});
  expect_refused(MessageType::start, RefusalReason::not_expected);  // there is no layout

  tell(layout());
  expect_accepted(MessageType::layout);
  hal::StartMessage start;
  start.followed.point = 2;
  tell(start);
  expect_refused(MessageType::start, RefusalReason::coordinate_not_followed);
  start = {};
  start.recommended.noise.memory_s = 1e9;
  tell(start);
  expect_refused(MessageType::start, RefusalReason::out_of_range);
  start = {};
  start.recommended.outliers.huber_sd = 7;
  start.recommended.outliers.gate_sd = 6;
  tell(start);
  expect_refused(MessageType::start, RefusalReason::parameters_do_not_fit);
  start = {};
  start.lag = kMostLag + 1;
  tell(start);
  expect_refused(MessageType::start, RefusalReason::lag_too_long);
  start = {};
  start.recommended.learning.kernels = kKernels + 1;
  tell(start);
  expect_refused(MessageType::start, RefusalReason::too_many_kernels);
}

// What is learned is what the sensor learns, bit for bit.
void EstimatorNodeTest::expect_learning(int lag) {
  hal::StartMessage start;
  start.lag = static_cast<std::uint8_t>(lag);
  begin(start);
  Expected<false> sensor(start.recommended, lag);
  SampleChecker checker;
  testing_support::Random random(1);
  int learned = 0;
  for (int i = 0; i < 600; ++i) {
    Sample sample;
    sample.time_ns = TimeNs{i} * 16'666'667;
    sample.coordinates[0] = 0.01 * std::sin(0.1 * i) + 5e-5 * random.normal();
    report(sample.time_ns, sample.coordinates[0]);
    const auto expected = sensor.process(sample, checker.check(sample));
    const auto heard_now = heard<hal::RecommendedEstimateMessage<float>>().estimate.axes[0];
    if (!expected.is_ready || !std::isfinite(expected.axes[0].velocity_m_s.value)) continue;
    ASSERT_EQ(heard_now.velocity_m_s.value, expected.axes[0].velocity_m_s.value);
    ASSERT_EQ(heard_now.velocity_learned, expected.axes[0].velocity_learned);
    ASSERT_EQ(heard_now.acceleration_learned, expected.axes[0].acceleration_learned);
    if (heard_now.velocity_learned > 0) ++learned;
  }
  EXPECT_GT(learned, 300) << lag;
}
TEST_F(EstimatorNodeTest, LearnsWithoutALag) {
  expect_learning(0);
}
TEST_F(EstimatorNodeTest, LearnsWithALagBelowTheTeachers) {
  expect_learning(1);
}

// The estimates are those of the sensor itself, bit for bit; those that wait come after finish.
TEST_F(EstimatorNodeTest, AnswersEachReportWithItsEstimate) {
  hal::StartMessage start;
  start.lag = 3;
  begin(start);
  RecommendedSensor<float, 1> sensor(start.recommended, start.lag);
  SampleChecker checker;
  std::vector<RecommendedEstimate<float>> expected;
  constexpr int kSamples = 200;
  for (int i = 0; i < kSamples; ++i) {
    Sample sample;
    sample.time_ns = TimeNs{i} * 16'666'667;
    sample.coordinates[0] = 0.01 * std::sin(0.1 * i);
    report(sample.time_ns, sample.coordinates[0]);
    expected.push_back(sensor.process(sample, checker.check(sample)));
    const auto heard_now = heard<hal::RecommendedEstimateMessage<float>>();
    ASSERT_EQ(heard_now.sample.time_ns, sample.time_ns);
    ASSERT_EQ(heard_now.estimate.is_ready, expected.back().is_ready);
    if (!expected.back().is_ready) continue;
    ASSERT_EQ(heard_now.estimate.axes[0].velocity_m_s.value,
              expected.back().axes[0].velocity_m_s.value);
  }
  tell(hal::FinishMessage{});
  for (RecommendedEstimate<float> waiting; sensor.drain(waiting);) {
    const auto heard_now = heard<hal::RecommendedEstimateMessage<float>>();
    EXPECT_EQ(heard_now.estimate.axes[0].velocity_m_s.value, waiting.axes[0].velocity_m_s.value);
  }
  expect_accepted(MessageType::finish);
  tell(hal::AskHealthMessage{});
  const auto health = heard<hal::HealthMessage>();
  EXPECT_EQ(health.samples, kSamples);
  EXPECT_EQ(health.reports.received, kSamples);
  EXPECT_EQ(health.uart_overruns, 3U);
  EXPECT_GT(target_.feeds(), kSamples);
}

// Conclusions are those of the sensor itself: one before the estimate with which it was drawn, and
// one at the end.
TEST_F(EstimatorNodeTest, IdentifiesFrictionAndMass) {
  hal::StartMessage start;
  start.identifies = true;
  start.recommended.impedance.drive.missing_share = 0;
  start.recommended.impedance.drive.delay_sd_s = 5e-4;
  start.recommended.learning.kernels = kKernels;
  tell(layout());
  expect_accepted(MessageType::layout);
  tell(start);
  expect_refused(MessageType::start, RefusalReason::cannot_identify);
  begin(start, true);
  Expected<true> sensor(start.recommended, 0, FollowedPoint(), 0);
  SampleChecker checker;
  std::uint64_t conclusions = 0;
  const auto expect_conclusion = [&] {
    const auto heard_now = heard<hal::ConclusionMessage<float>>().conclusion;
    EXPECT_EQ(heard_now.mass_kg.limit, sensor.conclusion().mass_kg.limit);
    EXPECT_EQ(heard_now.used_s, sensor.conclusion().used_s);
    EXPECT_EQ(heard_now.mass_kg.quantity.value, sensor.conclusion().mass_kg.quantity.value);
    EXPECT_EQ(heard_now.friction_Ns_m.quantity.standard_deviation,
              sensor.conclusion().friction_Ns_m.quantity.standard_deviation);
  };
  testing_support::Random random(2);
  for (int i = 0; i < 1200; ++i) {
    const double t = i / 60.0, w = 8;
    Sample sample;
    sample.time_ns = nanoseconds(t);
    sample.coordinates[0] = 0.01 * (std::sin(w * t) + 0.3 * std::sin(2.3 * w * t));
    const double v = 0.01 * w * (std::cos(w * t) + 0.69 * std::cos(2.3 * w * t)),
                 a = -0.01 * w * w * (std::sin(w * t) + 1.587 * std::sin(2.3 * w * t));
    sample.drive_N = 0.25 * a + 0.5 * v + 20 * sample.coordinates[0] + 0.01 * random.normal();
    sample.coordinates[0] += 5e-5 * random.normal();
    sample.drive_valid = true;
    std::array<double, 2> numbers = {sample.coordinates[0], sample.drive_N};
    tell(hal::ReportMessage{sample.time_ns, std::bit_cast<std::array<std::uint8_t, 16>>(numbers)});
    const auto expected = sensor.process(sample, checker.check(sample));
    if (sensor.conclusions() != conclusions) {
      conclusions = sensor.conclusions();
      expect_conclusion();
    }
    const auto heard_now = heard<hal::RecommendedEstimateMessage<float>>();
    ASSERT_EQ(heard_now.estimate.axes[0].velocity_m_s.value, expected.axes[0].velocity_m_s.value);
  }
  tell(hal::FinishMessage{});
  sensor.conclude();
  expect_conclusion();
  expect_accepted(MessageType::finish);
  EXPECT_GT(conclusions, 19U);
  EXPECT_EQ(sensor.conclusion().mass_kg.limit, ImpedanceLimit::none);
}

TEST_F(EstimatorNodeTest, SaysWhichReportsLedToNoEstimate) {
  begin({});
  tell(hal::ReportMessage{0, std::array<std::uint8_t, 3>{}});
  // Nothing tells that it is the last: the answer comes with the next report, or while it waits.
  expect_accepted(MessageType::report);
  tell(hal::AskHealthMessage{});
  const auto health = heard<hal::HealthMessage>();
  EXPECT_EQ(health.bad_reports, 1U);
  EXPECT_EQ(health.reports.too_short, 1U);
  report(1, 0.01);
  EXPECT_TRUE(receives(MessageType::recommended_estimate));
}

TEST_F(EstimatorNodeTest, ANewGreetingEndsARun) {
  begin({});
  report(0, 0.01);
  EXPECT_TRUE(receives(MessageType::recommended_estimate));
  tell(hal::HelloMessage{});
  (void)heard<hal::GreetingMessage>();
  EXPECT_TRUE(receives(MessageType::fault));
  report(1, 0.01);
  expect_refused(MessageType::report, RefusalReason::not_expected);
  begin({});
  report(2, 0.01);
  EXPECT_TRUE(receives(MessageType::recommended_estimate));
}

// Damaged frames are counted, and what follows them is answered.
TEST_F(EstimatorNodeTest, OutlivesRubbish) {
  begin({});
  std::vector<std::uint8_t> rubbish(5000);
  for (std::size_t i = 0; i < rubbish.size(); ++i) {
    rubbish[i] = static_cast<std::uint8_t>(i * i % 251);
  }
  ASSERT_EQ(line_.near.write(rubbish), Status::ok);
  report(0, 0.01);
  EXPECT_TRUE(receives(MessageType::recommended_estimate));
  tell(hal::AskHealthMessage{});
  EXPECT_GT(heard<hal::HealthMessage>().frames.refused(), 0U);
}

}  // namespace
}  // namespace condyle::firmware
