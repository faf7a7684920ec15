// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/hid/descriptor_profile.h"

#include <gmock/gmock.h>

#include <cmath>

#include "condyle/hal/hid/profile_check.h"
#include "condyle/hal/report/report_decoder.h"
#include "hosted/config/device_profile_file.h"
#include "support/paths.h"
#include "unit/hal/report_bits.h"

namespace condyle::hal {
namespace {

using testing::HasSubstr;

constexpr std::uint32_t kAbsolute = 2, kRelative = 6, kPadding = 3;

// Three 16-bit values in tenths of a millimetre after a byte of buttons and the report id.
DescriptorField three_axes() {
  DescriptorField field;
  field.offset_bits = 16;
  field.width_bits = 16;
  field.count = 3;
  field.flags = kAbsolute;
  field.usages = {{0x0001'0030, 0x0001'0032}};
  field.logical_minimum = -1000;
  field.logical_maximum = 1000;
  field.unit = {0x11, -2, "m", 1e-4, 0.0};
  return field;
}

ReportDescriptor device() {
  DescriptorField buttons;
  buttons.offset_bits = 8;
  buttons.width_bits = 1;
  buttons.count = 8;
  buttons.flags = kAbsolute;
  buttons.usages = {{0x0009'0001, 0x0009'0008}};
  DescriptorField rotations = three_axes();
  rotations.offset_bits = 64;
  rotations.usages = {{0x0001'0033, 0x0001'0035}};
  rotations.unit = {0x12, 0, "rad", 1e-3, 0.0};
  return {.reports = {{.id = 3, .size_bits = 112, .fields = {buttons, three_axes(), rotations}}}};
}

std::string reason_of(const ReportDescriptor& descriptor, const DeviceProfile& base = {}) {
  const DescriptorProfile result = complete_from_descriptor(base, descriptor);
  EXPECT_EQ(result.profile.has_value(), result.reason.empty());
  return result.reason;
}

TEST(DescriptorProfile, FindsThePoint) {
  const DescriptorProfile result = complete_from_descriptor({}, device());
  ASSERT_TRUE(result.profile) << result.reason;
  EXPECT_EQ(result.profile->report_id, 3);
  EXPECT_EQ(result.profile->minimum_size_bytes, 14U);
  const ReportDecoder decoder(layout_of(*result.profile));
  std::vector<std::uint8_t> bytes(14);
  bytes[0] = 3;
  for (std::size_t i = 0; i < 3; ++i) {
    testing_support::write_bits(bytes, result.profile->coordinates[i].field,
                                static_cast<std::uint64_t>(-10 * static_cast<int>(i) + 5));
  }
  EXPECT_EQ(bytes[2], 5);
  EXPECT_EQ(bytes[4], 0xFB);
  DecodedReport report;
  ASSERT_EQ(decoder.decode(bytes, report), ReportFault::none);
  EXPECT_EQ(report.kind, SampleKind::one_point);
  EXPECT_TRUE(report.position_valid);
  EXPECT_DOUBLE_EQ(report.coordinates[0], 0.5e-3);
  EXPECT_DOUBLE_EQ(report.coordinates[2], -1.5e-3);
  // Out of the logical range: HID's way to say that there is no value.
  bytes[3] = 0x7F;
  ASSERT_EQ(decoder.decode(bytes, report), ReportFault::none);
  EXPECT_FALSE(report.position_valid);
}

TEST(DescriptorProfile, TurnsTheAxes) {
  DeviceProfile base;
  base.descriptor_axes = {{{Axis::y}, {Axis::z, true}, {Axis::x}}};
  const DescriptorProfile result = complete_from_descriptor(base, device());
  ASSERT_TRUE(result.profile) << result.reason;
  const auto& c = result.profile->coordinates;
  EXPECT_EQ(c[0].field.offset_bits, 32U) << "condyle's x is the device's y";
  EXPECT_EQ(c[1].field.offset_bits, 48U);
  EXPECT_EQ(c[1].field.scale, -1e-4);
  EXPECT_EQ(c[2].field.offset_bits, 16U);
  EXPECT_FALSE(result.profile->descriptor_axes) << "complete";
}

TEST(DescriptorProfile, RefusesToGuess) {
  const auto with = [](auto spoil) {
    ReportDescriptor descriptor = device();
    spoil(descriptor.reports[0].fields[1]);
    return reason_of(descriptor);
  };
  EXPECT_EQ(with([](auto&) {}), "");
  EXPECT_THAT(reason_of({}), HasSubstr("describes no X"));
  EXPECT_THAT(with([](auto& f) {
                f.usages = {{0x0001'0030, 0x0001'0031}, {0, 0}};
              }),
              HasSubstr("describes no Z"));
  EXPECT_THAT(with([](auto& f) { f.flags = kRelative; }), HasSubstr("X is relative"));
  EXPECT_THAT(with([](auto& f) { f.flags = kPadding; }), HasSubstr("no X"));
  EXPECT_THAT(with([](auto& f) { f.flags = 0; }), HasSubstr("no X")) << "an array";
  EXPECT_THAT(with([](auto& f) { f.unit = {}; }), HasSubstr("X has no unit"));
  EXPECT_THAT(with([](auto& f) { f.unit.text = "rad"; }),
              HasSubstr("X is not a length (unit rad)"));
  EXPECT_THAT(with([](auto& f) { f.unit.scale = {}; }), HasSubstr("X is not a length"));
  EXPECT_THAT(with([](auto& f) { f.unit.scale = NAN; }), HasSubstr("not finite"));
  EXPECT_THAT(with([](auto& f) { f.width_bits = 72; }), HasSubstr("72 bits wide"));
  EXPECT_THAT(with([](auto& f) { f.offset_bits = 100; }), HasSubstr("beyond the report's 14"));
  ReportDescriptor output = device();
  output.reports[0].direction = ReportDirection::output;
  EXPECT_THAT(reason_of(output), HasSubstr("no X"));
}

TEST(DescriptorProfile, ChoosesAmongReportsOnlyWhereTold) {
  ReportDescriptor two = device();
  two.reports.push_back(two.reports[0]);
  two.reports[1].id = 4;
  EXPECT_THAT(reason_of(two), HasSubstr("2 fields as X"));
  DeviceProfile base;
  base.report_id = 4;
  EXPECT_EQ(reason_of(two, base), "");
  ReportDescriptor split = device();
  split.reports[0].fields[1].usages = {{0x0001'0030, 0x0001'0031}, {0, 0}};
  split.reports.push_back(device().reports[0]);
  split.reports[1].fields[1].usages = {{0x0001'0032, 0x0001'0032}, {0, 0}};
  EXPECT_THAT(reason_of(split), HasSubstr("Z is in another report"));
}

TEST(DescriptorProfile, KeepsWhatTheFileSays) {
  DeviceProfile base = host::load_device_profile(
      testing_support::source_path("/hal/profiles/self_describing_3_axis.toml"));
  ASSERT_TRUE(base.descriptor_axes);
  CountingField buttons;
  buttons.field = {.offset_bits = 8, .width_bits = 8, .type = FieldType::unsigned_integer};
  base.sequence = buttons;
  const DescriptorProfile result = complete_from_descriptor(base, device());
  ASSERT_TRUE(result.profile) << result.reason;
  EXPECT_EQ(result.profile->name, base.name);
  EXPECT_TRUE(result.profile->sequence);
  base.sequence->field.width_bits = 9;
  EXPECT_THAT(reason_of(device(), base), HasSubstr("in common with the sequence"));
}

}  // namespace
}  // namespace condyle::hal
