// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/hid/report_descriptor.h"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>

#include "support/rapidcheck_gtest.h"
#include "support/table.h"
#include "support/temporary_folder.h"
#include "support/tier.h"
#include "unit/hal/descriptor_bytes.h"

namespace condyle::hal {
namespace {

using testing::HasSubstr;
using testing_support::DescriptorBytes;

ReportDescriptor decoded(const DescriptorBytes& descriptor) {
  const DescriptorResult result = parse_report_descriptor(descriptor.bytes);
  EXPECT_TRUE(result.descriptor.has_value())
      << "byte " << result.error.byte_offset << ": " << result.error.reason;
  return result.descriptor.value_or(ReportDescriptor{});
}

void expect_refused(const DescriptorBytes& descriptor, std::size_t byte_offset,
                    const char* reason) {
  const DescriptorResult result = parse_report_descriptor(descriptor.bytes);
  ASSERT_FALSE(result.descriptor.has_value());
  EXPECT_EQ(result.error.byte_offset, byte_offset) << result.error.reason;
  EXPECT_THAT(result.error.reason, HasSubstr(reason));
}

DescriptorField one_field(std::int64_t unit_code, std::int64_t exponent) {
  const auto descriptor = decoded(DescriptorBytes()
                                      .begin()
                                      .logical(0, 1000)
                                      .physical(0, 500)
                                      .unit(unit_code, exponent)
                                      .values(16, 1)
                                      .input()
                                      .end());
  return descriptor.reports.at(0).fields.at(0);
}

TEST(ReportDescriptor, ScalesAThreeAxisDeviceToMetres) {
  const auto descriptor = decoded(DescriptorBytes()
                                      .usage_page(1)
                                      .usage(8)
                                      .begin()
                                      .report_id(1)
                                      .logical(-350, 350)
                                      .physical(-1400, 1400)
                                      .unit(0x11, -4)
                                      .usage(0x30)
                                      .usage(0x31)
                                      .usage(0x32)
                                      .values(16, 3)
                                      .input(6)
                                      .end());
  ASSERT_EQ(descriptor.reports.size(), 1U);
  const DescribedReport& report = descriptor.reports[0];
  EXPECT_EQ(report.id, 1);
  EXPECT_EQ(report.size_bits, 56U);
  const DescriptorField& field = report.fields.at(0);
  EXPECT_EQ(field.offset_bits, 8U);
  EXPECT_EQ(field.width_bits, 16U);
  EXPECT_EQ(field.count, 3U);
  EXPECT_EQ(field.usage_of(2), 0x00010032U);
  EXPECT_TRUE(field.is_signed() && field.is_relative() && field.is_variable());
  EXPECT_EQ(field.unit.text, "m");
  EXPECT_EQ(field.unit.scale, 4e-6);  // exactly: decimal units are converted without rounding twice
  EXPECT_EQ(field.unit.offset, 0);
}

// HID 1.11, section 6.2.2.7: systems, powers and exponents.
TEST(ReportDescriptor, ConvertsUnitsToSi) {
  struct Case {
    std::int64_t code, exponent;
    const char* text;
    double physical_unit_SI;
  };
  for (const Case& unit : {
           Case{0x11, 0, "m", 0.01}, Case{0x11, -1, "m", 1e-3}, Case{0x13, 0, "m", 0.0254},
           Case{0x12, 0, "rad", 1}, Case{0x14, 0, "rad", std::numbers::pi / 180},
           Case{0xE111, 5, "kg m/s^2", 1},  // newton
           Case{0x1001, -3, "s", 1e-3}, Case{0xF001, 0, "1/s", 1}, Case{0xF011, 0, "m/s", 0.01},
           Case{0x00F0D121, 7, "kg m^2/(s^3 A)", 1},  // volt, as HID 1.11's own table has it
       }) {
    SCOPED_TRACE(unit.text);
    const DescriptorField field = one_field(unit.code, unit.exponent);
    EXPECT_EQ(field.unit.text, unit.text);
    ASSERT_TRUE(field.unit.scale.has_value());
    EXPECT_NEAR(*field.unit.scale, 0.5 * unit.physical_unit_SI, 1e-15 * unit.physical_unit_SI);
  }
}

TEST(ReportDescriptor, GivesNoScaleWhereNoneIsDefined) {
  EXPECT_FALSE(one_field(0, 0).unit.scale.has_value());        // no unit
  EXPECT_FALSE(one_field(0x15, 0).unit.scale.has_value());     // reserved system
  EXPECT_FALSE(one_field(0x10003, 0).unit.scale.has_value());  // degrees Fahrenheit: no zero
  EXPECT_TRUE(one_field(0x10001, 0).unit.scale.has_value());   // kelvin
}

// value = scale * raw + offset holds at both ends of the range, for any ranges.
RC_GTEST_PROP(ReportDescriptor, MapsLogicalEndsToPhysicalEnds, ()) {
  const auto logical_minimum = *rc::gen::inRange<std::int64_t>(-100'000, 100'000);
  const auto logical_maximum = logical_minimum + *rc::gen::inRange<std::int64_t>(1, 100'000);
  const auto physical_minimum = *rc::gen::inRange<std::int64_t>(-100'000, 100'000);
  const auto physical_maximum = physical_minimum + *rc::gen::inRange<std::int64_t>(1, 100'000);
  RC_PRE(physical_minimum != 0 || physical_maximum != 0);
  const auto exponent = *rc::gen::inRange(-8, 8);
  const auto descriptor = decoded(DescriptorBytes()
                                      .begin()
                                      .logical(logical_minimum, logical_maximum)
                                      .physical(physical_minimum, physical_maximum)
                                      .unit(0x11, exponent)
                                      .values(32, 1)
                                      .input()
                                      .end());
  const FieldUnit& unit = descriptor.reports.at(0).fields.at(0).unit;
  RC_ASSERT(unit.scale.has_value());
  const double metre = std::pow(10.0, exponent) * 0.01;
  const double tolerance = 1e-9 * metre * 200'000;
  const auto value = [&](std::int64_t raw) {
    return *unit.scale * static_cast<double>(raw) + *unit.offset;
  };
  RC_ASSERT(std::abs(value(logical_minimum) - metre * static_cast<double>(physical_minimum)) <
            tolerance);
  RC_ASSERT(std::abs(value(logical_maximum) - metre * static_cast<double>(physical_maximum)) <
            tolerance);
}

TEST(ReportDescriptor, ReadsMaximaAsUnsignedWhereMinimaAreNot) {
  const auto descriptor = decoded(
      DescriptorBytes().begin().item(0x14, 0, 1).item(0x24, 0xFF, 1).values(8, 1).input().end());
  EXPECT_EQ(descriptor.reports.at(0).fields.at(0).logical_maximum, 255);
  EXPECT_EQ(descriptor.reports.at(0).fields.at(0).physical_maximum, 255);  // none given: as logical
}

TEST(ReportDescriptor, AFieldWithoutSizeOrCountHasNoBits) {
  const auto without_count =
      decoded(DescriptorBytes().begin().logical(0, 1).item(0x74, 8, 1).input().end());
  EXPECT_EQ(without_count.reports.at(0).size_bits, 0U);
  const auto without_size =
      decoded(DescriptorBytes().begin().logical(0, 1).item(0x94, 2, 1).input().end());
  EXPECT_EQ(without_size.reports.at(0).size_bits, 0U);
}

TEST(ReportDescriptor, RestoresTheGlobalStateOnPop) {
  const auto descriptor = decoded(DescriptorBytes()
                                      .usage_page(1)
                                      .begin()
                                      .logical(0, 10)
                                      .values(8, 2)
                                      .push()
                                      .logical(0, 20)
                                      .values(4, 1)
                                      .usage_page(9)
                                      .usage(1)
                                      .input()
                                      .pop()
                                      .usage(0x30)
                                      .input()
                                      .end());
  const auto& fields = descriptor.reports.at(0).fields;
  ASSERT_EQ(fields.size(), 2U);
  EXPECT_EQ(fields[0].usage_of(0), 0x00090001U);
  EXPECT_EQ(fields[1].usage_of(0), 0x00010030U);
  EXPECT_EQ(fields[1].logical_maximum, 10);
  EXPECT_EQ(fields[1].offset_bits, 4U);
  EXPECT_EQ(descriptor.reports[0].size_bits, 20U);
}

TEST(ReportDescriptor, ReadsRangesOfUsagesAndExtendedOnes) {
  const auto descriptor = decoded(DescriptorBytes()
                                      .usage_page(9)
                                      .begin()
                                      .logical(0, 1)
                                      .values(1, 5)
                                      .item(0x18, 1, 1)  // usage minimum
                                      .item(0x28, 3, 1)  // usage maximum
                                      .usage(0xFF000042)
                                      .input()
                                      .end());
  const DescriptorField& field = descriptor.reports.at(0).fields.at(0);
  EXPECT_EQ(field.usage_of(0), 0x00090001U);
  EXPECT_EQ(field.usage_of(2), 0x00090003U);
  EXPECT_EQ(field.usage_of(3), 0xFF000042U);
  EXPECT_EQ(field.usage_of(4), 0xFF000042U);  // the last usage holds for all that follow
  EXPECT_EQ(field.usage_of(5), 0U);           // there is no such value
}

// HID 1.11, 6.2.2.8: the page declared last before the main item holds.
TEST(ReportDescriptor, TakesTheUsagePageDeclaredLast) {
  const auto descriptor = decoded(DescriptorBytes()
                                      .usage_page(9)
                                      .begin()
                                      .logical(0, 1)
                                      .values(1, 2)
                                      .usage(0x30)
                                      .usage(0x31)
                                      .usage_page(1)
                                      .input()
                                      .end());
  EXPECT_EQ(descriptor.reports.at(0).fields.at(0).usage_of(1), 0x00010031U);
}

TEST(ReportDescriptor, TellsReportsApart) {
  const auto descriptor = decoded(DescriptorBytes()
                                      .begin()
                                      .logical(0, 255)
                                      .report_id(3)
                                      .values(8, 2)
                                      .input()
                                      .feature()
                                      .report_id(4)
                                      .values(8, 7)
                                      .input()
                                      .report_id(3)
                                      .values(3, 1)
                                      .input(1)
                                      .end());
  ASSERT_EQ(descriptor.reports.size(), 3U);
  EXPECT_EQ(descriptor.reports[0].size_bits, 8U + 16 + 3);
  EXPECT_EQ(descriptor.reports[1].direction, ReportDirection::feature);
  EXPECT_EQ(descriptor.reports[1].size_bits, 24U);
  EXPECT_EQ(descriptor.reports[2].id, 4);
  EXPECT_EQ(descriptor.reports[2].size_bits, 64U);
  EXPECT_TRUE(descriptor.reports[0].fields.at(1).is_constant());
}

TEST(ReportDescriptor, TakesTheFirstOfAlternativeUsages) {
  const auto bytes = [] {
    return DescriptorBytes()
        .usage_page(1)
        .begin()
        .logical(0, 1)
        .values(1, 1)
        .item(0xA8, 1, 1)
        .usage(0x30);
  };
  const ReportDescriptor of_one = decoded(bytes().usage(0x31).item(0xA8, 0, 1).input().end());
  const ReportDescriptor of_range =
      decoded(bytes().item(0x18, 0x31, 1).item(0x28, 0x32, 1).item(0xA8, 0, 1).input().end());
  for (const ReportDescriptor& descriptor : {of_one, of_range}) {
    const DescriptorField& field = descriptor.reports.at(0).fields.at(0);
    ASSERT_EQ(field.usages.size(), 1U);
    EXPECT_EQ(field.usages[0].first, 0x00010030U);
  }
}

TEST(ReportDescriptor, SignsAFieldThatReachesBelowZero) {
  DescriptorField field;
  for (const int minimum : {-1, 0, 1}) {
    field.logical_minimum = minimum;
    EXPECT_EQ(field.is_signed(), minimum < 0);
  }
}

TEST(ReportDescriptor, RefusalsNameTheByte) {
  expect_refused(DescriptorBytes().begin(), 2, "not closed");
  expect_refused(DescriptorBytes().end(), 0, "not begun");
  expect_refused(DescriptorBytes().begin().pop().end(), 2, "pop without a push");
  expect_refused(DescriptorBytes().begin().report_id(0).end(), 2, "report id 0");
  expect_refused(DescriptorBytes().begin().item(0x74, 257, 2).end(), 2, "report size of 257");
  expect_refused(DescriptorBytes().begin().item(0x94, 12289, 2).end(), 2, "report count of 12289");
  expect_refused(DescriptorBytes().begin().logical(5, 4).values(8, 1).input().end(), 18,
                 "before it starts");
  expect_refused(DescriptorBytes().begin().values(256, 12288).input().end(), 8, "longer than");
  expect_refused(
      DescriptorBytes().begin().values(8, 1).input().report_id(1).values(8, 1).input().end(), 18,
      "numbered and unnumbered");
  DescriptorBytes cut;
  cut.begin().bytes.push_back(0x26);  // promises two bytes
  expect_refused(cut, 2, "cut off");
  DescriptorBytes too_long;
  too_long.bytes.assign(kMaxDescriptorSize + 1, 0x14);
  expect_refused(too_long, kMaxDescriptorSize, "longer than 4096");
}

TEST(ReportDescriptor, SaysWhatItDidNotRead) {
  EXPECT_THAT(decoded(DescriptorBytes()).notes, testing::ElementsAre(HasSubstr("empty")));
  DescriptorBytes odd;
  odd.bytes = {0xFE, 0x01, 0x10, 0x00};  // a long item
  odd.begin().logical(0, 1).values(1, 1).item(0x28, 3, 1).input().end().item(0xD0, 0, 1);
  odd.item(0x0C, 0, 1);
  EXPECT_THAT(
      decoded(odd).notes,
      testing::ElementsAre(HasSubstr("long item"), HasSubstr("half of a range"),
                           HasSubstr("unknown main item, tag 13"), HasSubstr("reserved type")));
}

// Fields of any reports, written and read again.
RC_GTEST_PROP(ReportDescriptor, FindsEveryFieldWhereItWasPut, ()) {
  DescriptorBytes descriptor;
  descriptor.usage_page(1).begin();
  struct Expected {
    std::uint8_t id;
    ReportDirection direction;
    std::uint32_t offset_bits, width_bits, count, usage;
  };
  std::vector<Expected> expected;
  std::uint32_t sizes[3][4] = {};
  const int fields = *rc::gen::inRange(1, 40);
  for (int i = 0; i < fields; ++i) {
    const auto id = *rc::gen::inRange<std::uint8_t>(1, 5);
    const auto direction = static_cast<ReportDirection>(*rc::gen::inRange(0, 3));
    const auto width = *rc::gen::inRange<std::uint32_t>(1, 65);
    const auto count = *rc::gen::inRange<std::uint32_t>(1, 20);
    const auto usage = *rc::gen::inRange<std::uint32_t>(0x30, 0x39);
    std::uint32_t& size = sizes[static_cast<int>(direction)][id - 1];
    if (size == 0) size = 8;
    expected.push_back({id, direction, size, width, count, 0x00010000 | usage});
    size += width * count;
    descriptor.report_id(id).logical(-1, 1).values(width, count).usage(usage);
    direction == ReportDirection::input    ? descriptor.input()
    : direction == ReportDirection::output ? descriptor.output()
                                           : descriptor.feature();
  }
  const auto result = parse_report_descriptor(descriptor.end().bytes);
  RC_ASSERT(result.descriptor.has_value());
  std::size_t found = 0;
  for (const DescribedReport& report : result.descriptor->reports) {
    RC_ASSERT(report.size_bits == sizes[static_cast<int>(report.direction)][*report.id - 1]);
    auto next = expected.begin();
    for (const DescriptorField& field : report.fields) {
      while (next->id != *report.id || next->direction != report.direction) ++next;
      RC_ASSERT(field.offset_bits == next->offset_bits);
      RC_ASSERT(field.width_bits == next->width_bits);
      RC_ASSERT(field.count == next->count);
      RC_ASSERT(field.usage_of(0) == next->usage);
      ++next;
      ++found;
    }
  }
  RC_ASSERT(found == expected.size());
}

// A decoded descriptor's fields fill their reports and do not overlap.
void expect_consistent(const ReportDescriptor& descriptor) {
  for (const DescribedReport& report : descriptor.reports) {
    std::uint32_t next = report.id ? 8 : 0;
    for (const DescriptorField& field : report.fields) {
      EXPECT_EQ(field.offset_bits, next);
      next += field.width_bits * field.count;
    }
    EXPECT_EQ(report.size_bits, next);
  }
}

TEST(RealReportDescriptors, AreDecodedOrRefusedWithTheByte) {
  const std::string archive = testing_support::reference_data("hid_descriptors/descriptors.tar.gz");
  if (archive.empty()) GTEST_SKIP() << "set CONDYLE_REFERENCE_DATA to the folder of reference data";
  const testing_support::TemporaryFolder folder;
  const std::string unpack = "tar xzf '" + archive + "' -C '" + folder.path().string() + "'";
  ASSERT_EQ(std::system(unpack.c_str()), 0);
  int decoded_count = 0, refused = 0;
  const auto step =
      testing_support::runs<std::size_t>(5, 1, 1);  // a sanitizer slows this most of all
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    if (entry.path().filename() == "COPYING") continue;
    SCOPED_TRACE(entry.path().filename());
    std::ifstream file(entry.path(), std::ios::binary);
    std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
    const DescriptorResult result = parse_report_descriptor(bytes);
    if (result.descriptor) {
      ++decoded_count;
      expect_consistent(*result.descriptor);
    } else {
      ++refused;
      EXPECT_LE(result.error.byte_offset, bytes.size());
      EXPECT_FALSE(result.error.reason.empty());
    }
    // Cut anywhere, it is decoded or refused, and nothing else.
    for (std::size_t size = 0; size < bytes.size(); size += step) {
      const auto cut = parse_report_descriptor(std::span(bytes).first(size));
      EXPECT_TRUE(cut.descriptor.has_value() != !cut.error.reason.empty());
    }
  }
  EXPECT_GE(decoded_count, 599 * 97 / 100 + 1);
  EXPECT_EQ(decoded_count + refused, 599);
}

}  // namespace
}  // namespace condyle::hal
