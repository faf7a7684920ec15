// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/report/report_field.h"

#include <cmath>
#include <limits>

#include "support/rapidcheck_gtest.h"
#include "unit/hal/report_bits.h"

namespace condyle::hal {
namespace {

using testing_support::write_bits;

// Any place and width; of big-endian ones whole bytes.
ReportField any_field(FieldType type) {
  ReportField field;
  field.type = type;
  const bool is_big = *rc::gen::arbitrary<bool>();
  field.byte_order = is_big ? ByteOrder::big : ByteOrder::little;
  const std::uint32_t unit = is_big ? 8 : 1;
  field.width_bits = type == FieldType::floating_point
                         ? *rc::gen::element(32U, 64U)
                         : unit * *rc::gen::inRange<std::uint32_t>(1, 64 / unit + 1);
  field.offset_bits = unit * *rc::gen::inRange<std::uint32_t>(0, 128 / unit);
  return field;
}

// Exactly as long as the field needs, the rest of it arbitrary, so that sanitizers see a byte too
// far.
std::vector<std::uint8_t> any_bytes_for(const ReportField& field) {
  const std::size_t size = (field.offset_bits + field.width_bits + 7) / 8;
  return *rc::gen::container<std::vector<std::uint8_t>>(size, rc::gen::arbitrary<std::uint8_t>());
}

std::uint64_t any_raw(std::uint32_t width_bits) {
  // arbitrary() keeps to small numbers; the whole range is wanted.
  const auto high = *rc::gen::resize(1000, rc::gen::arbitrary<std::uint32_t>());
  const auto low = *rc::gen::resize(1000, rc::gen::arbitrary<std::uint32_t>());
  return (std::uint64_t{high} << 32U | low) >> (64 - width_bits);
}

RC_GTEST_PROP(ReportField, ReadsWhatWasWritten, ()) {
  const ReportField field = any_field(FieldType::unsigned_integer);
  std::vector<std::uint8_t> bytes = any_bytes_for(field);
  const std::uint64_t raw = any_raw(field.width_bits);
  write_bits(bytes, field, raw);
  RC_ASSERT(lies_within(field, bytes.size()));
  RC_ASSERT(read_raw(field, bytes) == raw);
  RC_ASSERT(read_value(field, bytes).value == static_cast<double>(raw));
}

RC_GTEST_PROP(ReportField, ExtendsTheSign, ()) {
  const ReportField field = any_field(FieldType::signed_integer);
  std::vector<std::uint8_t> bytes = any_bytes_for(field);
  const std::uint64_t magnitude = any_raw(field.width_bits) >> 1U;
  const bool is_negative = *rc::gen::arbitrary<bool>();
  const std::uint64_t raw = is_negative ? ~magnitude : magnitude;
  write_bits(bytes, field, raw);
  const auto expected = static_cast<double>(static_cast<std::int64_t>(raw));
  RC_ASSERT(read_value(field, bytes).value == expected);
}

RC_GTEST_PROP(ReportField, ReadsFloatingPoint, (double number)) {
  const ReportField field = any_field(FieldType::floating_point);
  std::vector<std::uint8_t> bytes = any_bytes_for(field);
  const double expected = field.width_bits == 64 ? number : double{static_cast<float>(number)};
  write_bits(bytes, field,
             field.width_bits == 64 ? std::bit_cast<std::uint64_t>(number)
                                    : std::bit_cast<std::uint32_t>(static_cast<float>(number)));
  const MeasuredValue value = read_value(field, bytes);
  RC_ASSERT(value.valid == std::isfinite(expected));
  if (value.valid) RC_ASSERT(value.value == expected);
}

MeasuredValue value_of(ReportField field, std::uint64_t raw) {
  std::vector<std::uint8_t> bytes(8);
  write_bits(bytes, field, raw);
  return read_value(field, bytes);
}

TEST(ReportField, ScalesToSi) {
  const ReportField field{.width_bits = 16, .scale = 4e-6, .offset = 0.5};
  EXPECT_DOUBLE_EQ(value_of(field, 0xFFFF).value, 0.5 - 4e-6);
}

TEST(ReportField, SaysWhatWasNotMeasured) {
  ReportField field{.width_bits = 16, .missing = -32768};
  EXPECT_FALSE(value_of(field, 0x8000).valid);
  EXPECT_TRUE(std::isnan(value_of(field, 0x8000).value)) << "never invented";
  EXPECT_TRUE(value_of(field, 0x8001).valid);
  field.range = {-100, 100};
  EXPECT_FALSE(value_of(field, 0x8000).valid);
  EXPECT_FALSE(value_of(field, 101).valid);
  EXPECT_TRUE(value_of(field, 100).valid);
  EXPECT_TRUE(value_of(field, 0xFF9C).valid) << "-100";
  EXPECT_FALSE(value_of(field, 0xFF9B).valid);
}

TEST(ReportField, ComparesWideUnsignedValuesAsTwosComplement) {
  const ReportField field{.width_bits = 64, .type = FieldType::unsigned_integer, .missing = -1};
  EXPECT_FALSE(value_of(field, ~std::uint64_t{0}).valid);
  EXPECT_TRUE(value_of(field, ~std::uint64_t{1}).valid);
}

TEST(ReportField, TakesNoNumberThatIsNotFinite) {
  const ReportField narrow{.width_bits = 32, .type = FieldType::floating_point};
  for (const std::uint64_t raw : {0x7F800000U, 0xFF800000U, 0x7FC00000U, 0x7F800001U}) {
    EXPECT_FALSE(value_of(narrow, raw).valid) << std::hex << raw;
  }
  const ReportField overflowing{.width_bits = 64, .type = FieldType::floating_point, .scale = 1e10};
  EXPECT_FALSE(value_of(overflowing, std::bit_cast<std::uint64_t>(1e300)).valid);
  const ReportField marked{.width_bits = 32, .type = FieldType::floating_point, .missing = -9999};
  EXPECT_FALSE(value_of(marked, std::bit_cast<std::uint32_t>(-9999.0F)).valid);
  EXPECT_TRUE(value_of(marked, std::bit_cast<std::uint32_t>(-9998.0F)).valid);
}

}  // namespace
}  // namespace condyle::hal
