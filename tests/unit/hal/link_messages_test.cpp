// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/link/link_messages.h"

#include "support/rapidcheck_gtest.h"
#include "unit/hal/link_round_trip.h"

namespace condyle::hal {
namespace {

using namespace testing_support;

RC_GTEST_PROP(LinkMessages, ReportsArrive, (TimeNs host_time_ns, std::uint8_t byte)) {
  const auto size = *rc::gen::inRange<std::size_t>(0, kMaxReportSize + 1);
  const Bytes bytes(size, byte);
  const Bytes payload = written(ReportMessage{host_time_ns, bytes});
  RC_ASSERT(payload.size() == size + 8);
  ReportMessage received;
  RC_ASSERT(get(payload, received).reason == RefusalReason::none);
  RC_ASSERT(received.host_time_ns == host_time_ns);
  RC_ASSERT(Bytes(received.bytes.begin(), received.bytes.end()) == bytes);
}

TEST(LinkMessages, RefusesReportsThatAreTooLong) {
  const Bytes bytes(kMaxReportSize + 1);
  Bytes payload(kMaxPayload);
  EXPECT_FALSE(put(ReportMessage{0, bytes}, payload));
  ReportMessage received;
  EXPECT_EQ(get(Bytes(8 + kMaxReportSize + 1), received).reason, RefusalReason::wrong_size);
  for (std::size_t size = 0; size < 8; ++size) {
    EXPECT_EQ(get(Bytes(size), received).reason, RefusalReason::wrong_size);
  }
}

TEST(LinkMessages, TheSmallOnesArrive) {
  EXPECT_EQ(sent(HelloMessage{0x1234}).version, 0x1234);
  EXPECT_EQ(written(HelloMessage{}), (Bytes{6, 0}));  // the version that nodes answer
  EXPECT_TRUE(written(FinishMessage{}).empty());
  sent(FinishMessage{});
  EXPECT_TRUE(written(AskHealthMessage{}).empty());
  sent(AskHealthMessage{});
  EXPECT_TRUE(written(ReconnectedMessage{}).empty());
  sent(ReconnectedMessage{});
  EXPECT_EQ(sent(AcceptedMessage{MessageType::start}).message, MessageType::start);
  expect_refused(AcceptedMessage{static_cast<MessageType>(8)}, RefusalReason::unknown_value, 0);
  expect_each_byte_counts(AcceptedMessage{MessageType::start});

  const RefusedMessage refused{200, {RefusalReason::out_of_range, 0x0123}};
  const RefusedMessage a = sent(refused);
  EXPECT_EQ(a.message, 200);
  EXPECT_EQ(a.refusal.reason, RefusalReason::out_of_range);
  EXPECT_EQ(a.refusal.index, 0x0123);
  expect_each_byte_counts(a);
}

TEST(LinkMessages, GreetingsAndFaultsArrive) {
  GreetingMessage greeting;
  greeting.version = 3;
  greeting.software_version = fixed_text("0.1.0-sixteen-by");
  greeting.core_name = fixed_text("Cortex-M7");
  greeting.scalar_size = 4;
  greeting.most_kernels = 64;
  greeting.boot_count = 0xFEDCBA98;
  greeting.reset_cause = ResetCause::watchdog;
  greeting.has_fault = true;
  const GreetingMessage a = sent(greeting);
  EXPECT_EQ(a.version, 3);
  EXPECT_EQ(text_of(a.software_version), "0.1.0-sixteen-by");
  EXPECT_EQ(text_of(a.core_name), "Cortex-M7");
  EXPECT_EQ(a.scalar_size, 4);
  EXPECT_EQ(a.most_kernels, 64);
  EXPECT_EQ(a.boot_count, 0xFEDCBA98);
  EXPECT_EQ(a.reset_cause, ResetCause::watchdog);
  EXPECT_TRUE(a.has_fault);
  expect_each_byte_counts(greeting);
  greeting.scalar_size = 5;
  expect_refused(greeting, RefusalReason::unknown_value, 33);
  greeting = a;
  greeting.core_name[2] = '\x1B';
  expect_refused(greeting, RefusalReason::unknown_value);
  greeting.core_name = {'a', '\0', 'b'};
  expect_refused(greeting, RefusalReason::unknown_value);
  EXPECT_EQ(text_of(fixed_text("longer than sixteen")), "longer than sixt");

  const FaultMessage b = sent(FaultMessage{FaultKind::usage, 1, 2, 3, 4, 0xFFFFFFFF});
  EXPECT_EQ(b.kind, FaultKind::usage);
  EXPECT_EQ(b.pc, 1U);
  EXPECT_EQ(b.lr, 2U);
  EXPECT_EQ(b.cfsr, 3U);
  EXPECT_EQ(b.hfsr, 4U);
  EXPECT_EQ(b.bfar, 0xFFFFFFFF);
  expect_each_byte_counts(b);
}

TEST(LinkMessages, HealthArrivesWithEveryCount) {
  HealthMessage message;
  std::uint64_t next = std::uint64_t{1} << 60U;
  const auto each = [](auto& m, auto visit) {
    FrameCounts& f = m.frames;
    ReportCounts& r = m.reports;
    TransportCounts& t = m.transport;
    for (auto* n : {&f.accepted,
                    &f.wrong_checksum,
                    &f.bad_stuffing,
                    &f.too_short,
                    &f.too_long,
                    &f.lost,
                    &f.restarts,
                    &r.received,
                    &r.lost,
                    &r.duplicated,
                    &r.sequence_restarts,
                    &r.unknown_losses,
                    &r.unknown_reconnections,
                    &r.clock_jumps,
                    &r.other_reports,
                    &r.too_short,
                    &r.wrong_checksum,
                    &r.counter_out_of_range,
                    &r.unusable_profile,
                    &t.stalls,
                    &t.transfer_errors,
                    &t.oversized,
                    &t.disconnections,
                    &m.samples,
                    &m.timeouts,
                    &m.bad_reports,
                    &m.disconnections,
                    &m.uart_overruns,
                    &m.dropped_bytes}) {
      visit(*n);
    }
    for (auto& n : m.events) visit(n);
  };
  each(message, [&next](auto& number) { number = next++; });
  message.stack_used_bytes = 0xF0000001;
  message.stack_size_bytes = 0xF0000002;
  message.uptime_ns = -5;
  HealthMessage received = sent(message);
  std::uint64_t expected = std::uint64_t{1} << 60U;
  each(received, [&expected](auto& number) { EXPECT_EQ(number, expected++); });
  EXPECT_EQ(received.stack_used_bytes, 0xF0000001);
  EXPECT_EQ(received.stack_size_bytes, 0xF0000002);
  EXPECT_EQ(received.uptime_ns, -5);
  EXPECT_EQ(written(message).size(), (7U + 12 + 4 + 4 + kEventCount + 2) * 8 + 2 * 4 + 8);
}

TEST(LinkMessages, KnowsItsTypes) {
  std::size_t known = 0;
  for (unsigned type = 0; type < 256; ++type) {
    known += is_message_type(static_cast<std::uint8_t>(type)) ? 1U : 0U;
  }
  EXPECT_EQ(known, 15U);
  EXPECT_FALSE(is_message_type(0));
}

}  // namespace
}  // namespace condyle::hal
