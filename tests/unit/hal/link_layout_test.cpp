// SPDX-License-Identifier: Apache-2.0
#include "unit/hal/link_round_trip.h"

namespace condyle::hal {
namespace {

using namespace testing_support;

ReportField field_at(std::uint32_t offset_bits) {
  return {.offset_bits = offset_bits,
          .width_bits = 16,
          .type = FieldType::signed_integer,
          .byte_order = ByteOrder::big,
          .scale = 1e-6 + offset_bits,
          .offset = -0.5,
          .missing = -32768,
          .range = RawRange{-32000, 32001}};
}

// With all that a layout can hold.
LayoutMessage fullest_layout() {
  LayoutMessage message;
  ReportLayout& layout = message.layout;
  layout.rate_Hz = 500;
  layout.report_id = 7;
  layout.minimum_size_bytes = 120;
  layout.kind = SampleKind::three_points;
  std::uint32_t next = 8;
  const auto following = [&] {
    next += 16;
    return field_at(next - 16);
  };
  for (std::size_t i = 0; i < kMaxCoordinates; ++i) layout.coordinates.push_back({following(), i});
  layout.device_time = CountingField{following(), 60'000};
  layout.sequence = CountingField{following(), 50'000};
  for (auto* counting : {&*layout.device_time, &*layout.sequence}) {
    counting->field.type = FieldType::unsigned_integer;
    counting->field.missing.reset();
    counting->field.range.reset();
  }
  layout.device_time->field.scale = 1e-6;
  layout.drive_N = following();
  for (std::size_t i = 0; i < kMaxAuxiliary; ++i) layout.auxiliary.push_back(following());
  Checksum checksum{.polynomial = 0x1021, .initial = 0xFFFF, .reflects_output = true};
  checksum.final_xor = 0x1234;
  checksum.first_byte = 1;
  checksum.end_byte = next / 8;
  checksum.field = {.offset_bits = next, .width_bits = 16, .type = FieldType::unsigned_integer};
  layout.checksum = checksum;
  layout.restarts_on_reconnect = true;
  return message;
}

void expect_equal(const ReportField& a, const ReportField& b) {
  EXPECT_EQ(a.offset_bits, b.offset_bits);
  EXPECT_EQ(a.width_bits, b.width_bits);
  EXPECT_EQ(a.type, b.type);
  EXPECT_EQ(a.byte_order, b.byte_order);
  EXPECT_EQ(a.scale, b.scale);
  EXPECT_EQ(a.offset, b.offset);
  EXPECT_EQ(a.missing, b.missing);
  ASSERT_EQ(a.range.has_value(), b.range.has_value());
  if (!a.range) return;
  EXPECT_EQ(a.range->lowest, b.range->lowest);
  EXPECT_EQ(a.range->highest, b.range->highest);
}

TEST(LinkMessages, TheFullestLayoutArrives) {
  const ReportLayout a = fullest_layout().layout;
  ASSERT_FALSE(find_layout_problem(a));
  const ReportLayout b = sent(fullest_layout()).layout;
  EXPECT_EQ(a.rate_Hz, b.rate_Hz);
  EXPECT_EQ(a.report_id, b.report_id);
  EXPECT_EQ(a.minimum_size_bytes, b.minimum_size_bytes);
  EXPECT_EQ(a.kind, b.kind);
  ASSERT_EQ(a.coordinates.size(), b.coordinates.size());
  for (std::size_t i = 0; i < a.coordinates.size(); ++i) {
    expect_equal(a.coordinates[i].field, b.coordinates[i].field);
    EXPECT_EQ(a.coordinates[i].index, b.coordinates[i].index);
  }
  expect_equal(a.device_time->field, b.device_time->field);
  EXPECT_EQ(a.device_time->wraps_at, b.device_time->wraps_at);
  expect_equal(a.sequence->field, b.sequence->field);
  EXPECT_EQ(a.sequence->wraps_at, b.sequence->wraps_at);
  expect_equal(a.checksum->field, b.checksum->field);
  EXPECT_EQ(a.checksum->width_bits, b.checksum->width_bits);
  EXPECT_EQ(a.checksum->polynomial, b.checksum->polynomial);
  EXPECT_EQ(a.checksum->initial, b.checksum->initial);
  EXPECT_EQ(a.checksum->reflects_input, b.checksum->reflects_input);
  EXPECT_EQ(a.checksum->reflects_output, b.checksum->reflects_output);
  EXPECT_EQ(a.checksum->final_xor, b.checksum->final_xor);
  EXPECT_EQ(a.checksum->first_byte, b.checksum->first_byte);
  EXPECT_EQ(a.checksum->end_byte, b.checksum->end_byte);
  expect_equal(*a.drive_N, *b.drive_N);
  ASSERT_EQ(a.auxiliary.size(), b.auxiliary.size());
  for (std::size_t i = 0; i < a.auxiliary.size(); ++i) {
    expect_equal(a.auxiliary[i], b.auxiliary[i]);
  }
  EXPECT_EQ(a.restarts_on_reconnect, b.restarts_on_reconnect);
  expect_each_byte_counts(fullest_layout());
}

TEST(LinkMessages, EvenOneThatCannotBeUsedHasRoom) {
  LayoutMessage message = fullest_layout();
  ReportLayout& layout = message.layout;
  layout.device_time->field = layout.sequence->field = layout.checksum->field = field_at(8);
  ASSERT_TRUE(find_layout_problem(layout));
  sent(message);
}

TEST(LinkMessages, AnEmptyLayoutArrivesInOneThatWasUsed) {
  LayoutMessage received = fullest_layout();
  ASSERT_EQ(get(written(LayoutMessage{}), received).reason, RefusalReason::none);
  EXPECT_EQ(written(received), written(LayoutMessage{}));
  EXPECT_FALSE(received.layout.checksum);
  EXPECT_TRUE(received.layout.auxiliary.empty());
}

TEST(LinkMessages, RefusesLayoutsThatAreNone) {
  LayoutMessage message = fullest_layout();
  message.layout.rate_Hz = kNaN;
  expect_refused(message, RefusalReason::not_finite, 0);
  message = fullest_layout();
  message.layout.coordinates[0].field.scale = kInfinity;
  expect_refused(message, RefusalReason::not_finite, 10);
  message = fullest_layout();
  message.layout.kind = static_cast<SampleKind>(4);
  expect_refused(message, RefusalReason::unknown_value, 4);
  message = fullest_layout();
  message.layout.minimum_size_bytes = 0x10000;
  Bytes payload(kMaxPayload);
  EXPECT_FALSE(put(message, payload)) << "has no room in the message";
}

}  // namespace
}  // namespace condyle::hal
