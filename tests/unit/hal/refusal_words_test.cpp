// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/link/refusal_words.h"

#include <gmock/gmock.h>

#include "unit/hal/link_round_trip.h"

namespace condyle::hal {
namespace {

using namespace testing_support;
using testing::StartsWith;

ReportField number_at(std::uint32_t offset_bits) {
  return {.offset_bits = offset_bits, .width_bits = 64, .type = FieldType::floating_point};
}

// A position along one axis, and one of all else.
LayoutMessage usable_layout() {
  LayoutMessage message;
  ReportLayout& layout = message.layout;
  layout.kind = SampleKind::one_axis;
  layout.report_id = 1;
  (void)layout.coordinates.push_back({number_at(8), 0});
  layout.drive_N = number_at(72);
  (void)layout.auxiliary.push_back(number_at(136));
  (void)layout.auxiliary.push_back(number_at(200));
  layout.sequence = CountingField{
      {.offset_bits = 264, .width_bits = 16, .type = FieldType::unsigned_integer}, 60'000};
  layout.device_time = CountingField{
      {.offset_bits = 280, .width_bits = 32, .type = FieldType::unsigned_integer, .scale = 1e-6}};
  layout.checksum =
      Checksum{.field = {.offset_bits = 312, .width_bits = 16, .type = FieldType::unsigned_integer},
               .polynomial = 0x1021,
               .end_byte = 39};
  layout.minimum_size_bytes = 41;
  return message;
}

// What a target says of `layout`, in words.
RefusalWords refused(const LayoutMessage& layout) {
  RefusedMessage message{static_cast<std::uint8_t>(MessageType::layout), {}, {}};
  LayoutMessage received;
  message.refusal = get(written(layout), received);
  if (message.refusal.reason == RefusalReason::none) {
    message.refusal.reason = RefusalReason::unusable_layout;
    message.layout_problem = find_layout_problem(received.layout);
    EXPECT_TRUE(message.layout_problem) << "is not refused";
  }
  return words_of(message, layout, {});
}

std::string refused(const StartMessage& start) {
  StartMessage received;
  const Refusal refusal = get(written(start), received);
  return words_of({static_cast<std::uint8_t>(MessageType::start), refusal, {}}, {}, start).reason;
}

TEST(RefusalWords, NameTheValueOfALayoutThatCannotBeRead) {
  ASSERT_FALSE(find_layout_problem(usable_layout().layout));
  const auto expect = [](auto spoil, const std::string& reason) {
    LayoutMessage layout = usable_layout();
    spoil(layout.layout);
    EXPECT_EQ(refused(layout).reason, "the layout: " + reason);
  };
  expect([](auto& l) { l.rate_Hz = kNaN; }, "the rate is not a finite number");
  expect([](auto& l) { l.kind = static_cast<SampleKind>(9); },
         "the kind of sample has an unknown value");
  expect([](auto& l) { l.coordinates[0].field.scale = kInfinity; },
         "condyle's position, scale, is not a finite number");
  expect([](auto& l) { l.drive_N->offset = kNaN; },
         "the drive, value_offset, is not a finite number");
  expect([](auto& l) { l.auxiliary[1].scale = kNaN; },
         "auxiliary 2, scale, is not a finite number");
  expect([](auto& l) { l.sequence->field.type = static_cast<FieldType>(3); },
         "the sequence, type, has an unknown value");
  expect([](auto& l) { l.device_time->field.byte_order = static_cast<ByteOrder>(2); },
         "the device time, byte_order, has an unknown value");
  expect([](auto& l) { l.checksum->field.scale = kNaN; },
         "the checksum, scale, is not a finite number");
}

TEST(RefusalWords, NameTheFieldOfALayoutThatCannotBeUsed) {
  const auto expect = [](auto spoil, const std::string& reason, const std::string& mend) {
    LayoutMessage layout = usable_layout();
    spoil(layout.layout);
    const RefusalWords words = refused(layout);
    EXPECT_EQ(words.reason, "the layout: " + reason);
    EXPECT_EQ(words.mend, mend);
  };
  expect([](auto& l) { l.drive_N->offset_bits = 300; },
         "the drive reaches beyond the report's 41 bytes",
         "raise the minimum size, or move the field");
  expect([](auto& l) { l.auxiliary[0].width_bits = 65; }, "auxiliary 1 is 65 bits wide",
         "give 1 to 64");
  expect([](auto& l) { l.sequence->wraps_at = 2; },
         "the sequence starts again after 2 values: nothing can be told", "leave it out");
  expect([](auto& l) { l.device_time->field.offset_bits = 270; },
         "the device time has bits in common with the sequence", "each bit belongs to one field");
  expect(
      [](auto& l) {
        l.coordinates.clear();
        l.drive_N.reset();
        l.auxiliary.clear();
      },
      "condyle's position is missing", "give every coordinate of the kind");
}

// A target of another version may refuse what this side would not.
TEST(RefusalWords, NameTheFieldThatOnlyTheTargetRefuses) {
  const auto words = [](ProfilePart part, std::size_t index) {
    RefusedMessage message{static_cast<std::uint8_t>(MessageType::layout),
                           {RefusalReason::unusable_layout, 0},
                           LayoutProblem{part, index, LayoutFault::missing_value_impossible}};
    return words_of(message, usable_layout(), {}).reason;
  };
  EXPECT_THAT(words(ProfilePart::sequence, 0), StartsWith("the layout: the sequence cannot be"));
  EXPECT_THAT(words(ProfilePart::auxiliary, 1), StartsWith("the layout: auxiliary 2 cannot be"));
  EXPECT_THAT(words(ProfilePart::auxiliary, 2),
              StartsWith("the layout: the auxiliary fields cannot be"));
  EXPECT_THAT(words(ProfilePart::coordinates, 200),
              StartsWith("the layout: the coordinates cannot be"));
}

TEST(RefusalWords, NameTheLongestLag) {
  const StartMessage start{.lag = 10};
  const RefusedMessage message{
      static_cast<std::uint8_t>(MessageType::start), {RefusalReason::lag_too_long, 4}, {}};
  const RefusalWords words = words_of(message, {}, start);
  EXPECT_EQ(words.reason, "the start: the target has no memory for a lag of 10 samples");
  EXPECT_EQ(words.mend, "take a lag of at most 4, or a target of more memory");
}

TEST(RefusalWords, NameTheSettingOfAStart) {
  const auto expect = [](auto spoil, const std::string& reason) {
    StartMessage start;
    spoil(start);
    EXPECT_EQ(refused(start), "the start: " + reason);
  };
  expect([](auto& s) { s.lag = 17; }, "the lag is out of range");
  expect([](auto& s) { s.followed.point = 4; }, "the followed point is out of range");
  expect([](auto& s) { s.nominal_step_ns = -1; }, "the nominal step is out of range");
  expect([](auto& s) { s.recommended.assumed_mass_kg = kNaN; },
         "assumed_mass_kg is not a finite number");
  expect([](auto& s) { s.recommended.noise.memory_s = 1e9; }, "[noise] memory_s is out of range");
  expect([](auto& s) { s.recommended.outliers.huber_sd = 99; },
         "parameters that do not fit together");
  expect(
      [](auto& s) {
        s.estimator = EstimatorChoice::published;
        s.published.mass.process_variance[1] = -1;
      },
      "[mass] process_variance is out of range");
}

}  // namespace
}  // namespace condyle::hal
