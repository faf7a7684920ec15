// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/hid/profile_check.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "condyle/hal/report/report_decoder.h"
#include "hosted/config/device_profile_file.h"
#include "support/paths.h"

namespace condyle::hal {
namespace {

using testing::HasSubstr;

DeviceProfile facebow() {
  return host::load_device_profile(
      testing_support::source_path("/hal/profiles/condyle_facebow.toml"));
}

// The problem that `spoil` makes; such a profile decodes nothing, either.
ProfileProblem problem_of(const std::function<void(DeviceProfile&)>& spoil) {
  DeviceProfile profile = facebow();
  spoil(profile);
  const auto problem = find_problem(profile);
  DecodedReport report;
  const std::vector<std::uint8_t> bytes(64, 1);
  EXPECT_EQ(ReportDecoder(layout_of(profile)).decode(bytes, report), ReportFault::unusable_profile);
  return problem.value_or(ProfileProblem{ProfilePart::rate, 0, "no problem", ""});
}

void expect(const std::function<void(DeviceProfile&)>& spoil, ProfilePart part,
            const char* reason) {
  const ProfileProblem problem = problem_of(spoil);
  EXPECT_THAT(problem.reason, HasSubstr(reason));
  EXPECT_EQ(problem.part, part) << reason;
}

TEST(ProfileCheck, TheShippedProfileIsUsable) {
  EXPECT_FALSE(find_problem(facebow()));
}

TEST(DeviceProfile, StepsByItsRate) {
  DeviceProfile profile;
  EXPECT_FALSE(profile.nominal_step_ns());
  profile.rate_Hz = 250;
  EXPECT_EQ(profile.nominal_step_ns(), 4'000'000);
}

TEST(ProfileCheck, FindsProblemsOfFields) {
  const auto expect_field = [](const std::function<void(ReportField&)>& spoil, const char* reason) {
    expect([&](DeviceProfile& p) { spoil(p.coordinates[8].field); }, ProfilePart::coordinates,
           reason);
  };
  expect_field([](auto& f) { f.width_bits = 0; }, "condyle's z3 is 0 bits wide");
  expect_field([](auto& f) { f.width_bits = 65; }, "65 bits wide");
  expect_field([](auto& f) { f.offset_bits = 29 * 8 - 15; }, "beyond the report's 29 bytes");
  expect_field([](auto& f) { f.offset_bits = 0xFFFF'FFFF; }, "beyond the report's 29 bytes");
  expect_field([](auto& f) { f.offset_bits = 7; }, "overlaps the report id");
  expect_field([](auto& f) { f.type = FieldType::floating_point; }, "floating-point number of 16");
  expect_field([](auto& f) { f.byte_order = ByteOrder::big, f.width_bits = 12; }, "whole bytes");
  expect_field([](auto& f) { f.scale = 0; }, "scale that is zero");
  expect_field([](auto& f) { f.scale = NAN; }, "zero or not finite");
  expect_field([](auto& f) { f.offset = INFINITY; }, "offset that is not finite");
  expect_field([](auto& f) { f.missing = 32768; }, "cannot hold the value 32768");
  expect_field([](auto& f) { f.range = {5, 4}; }, "valid range that its bits cannot hold");
  expect_field([](auto& f) { f.range = {-40000, 4}; }, "valid range that its bits cannot hold");
  expect([](auto& p) { p.coordinates[8].field.offset_bits -= 1; }, ProfilePart::coordinates,
         "condyle's z3 has bits in common with condyle's y3");
  expect([](auto& p) { p.sequence->field.width_bits = 33; }, ProfilePart::device_time,
         "the device time has bits in common with the sequence");
}

// Special values are checked against what the bits hold, at any width.
TEST(ProfileCheck, KnowsTheLargestValueOfEveryWidth) {
  for (std::uint32_t width = 1; width < 64; ++width) {
    DeviceProfile profile;
    profile.kind = SampleKind::one_axis;
    profile.minimum_size_bytes = 8;
    profile.coordinates.push_back({{.width_bits = width}, 0});
    ReportField& field = profile.coordinates[0].field;
    for (const FieldType type : {FieldType::unsigned_integer, FieldType::signed_integer}) {
      field.type = type;
      const std::uint32_t digits = type == FieldType::signed_integer ? width - 1 : width;
      const auto highest = static_cast<std::int64_t>((std::uint64_t{1} << digits) - 1);
      field.missing = highest;
      EXPECT_FALSE(find_problem(profile)) << width;
      if (digits == 63) continue;
      field.missing = highest + 1;
      EXPECT_TRUE(find_problem(profile)) << width;
    }
  }
}

TEST(ProfileCheck, FindsProblemsOfCoordinates) {
  const ProfilePart part = ProfilePart::coordinates;
  expect([](auto& p) { p.coordinates.pop_back(); }, part, "condyle's z3 is missing");
  expect([](auto& p) { p.coordinates[3].index = 0; }, part, "condyle's x1 is given twice");
  expect([](auto& p) { p.coordinates[3].index = 9; }, part, "no such coordinate");
  expect([](auto& p) { p.kind = SampleKind::one_point; }, part, "no such coordinate");
  expect([](auto& p) { p.descriptor_axes = kSameAxes; }, part, "requested from the descriptor");
  EXPECT_EQ(problem_of([](auto& p) { p.descriptor_axes = kSameAxes; }).index, 0U);
}

TEST(ProfileCheck, FindsProblemsOfCountsAndClocks) {
  const ProfilePart sequence = ProfilePart::sequence, time = ProfilePart::device_time;
  expect([](auto& p) { p.sequence->field.type = FieldType::signed_integer; }, sequence,
         "the sequence is not an unsigned integer");
  expect([](auto& p) { p.sequence->field.width_bits = 1; }, sequence, "too few to be useful");
  expect([](auto& p) { p.sequence->wraps_at = 1; }, sequence, "too few to be useful");
  expect([](auto& p) { p.sequence->wraps_at = 0x1'0000'0001; }, sequence, "more than its bits");
  expect([](auto& p) { p.device_time->field.scale = -1e-6; }, time, "ticks shorter");
  expect([](auto& p) { p.device_time->field.scale = 1e-12; }, time, "ticks shorter");
  expect([](auto& p) { p.device_time->wraps_at = 3999; }, time, "before the second report");
  expect([](auto& p) { p.rate_Hz = -1; }, ProfilePart::rate, "negative or not finite");
}

TEST(ProfileCheck, FindsProblemsOfTheRest) {
  const ProfilePart checksum = ProfilePart::checksum, auxiliary = ProfilePart::auxiliary;
  expect([](auto& p) { p.minimum_size_bytes = 0; }, ProfilePart::minimum_size, "0 bytes");
  expect([](auto& p) { p.minimum_size_bytes = 1025; }, ProfilePart::minimum_size, "1025 bytes");
  expect([](auto& p) { p.checksum->width_bits = 12; }, checksum, "12 bits wide");
  expect([](auto& p) { p.checksum->field.width_bits = 8; }, checksum, "another width");
  expect([](auto& p) { p.checksum->polynomial = 0; }, checksum, "polynomial of zero");
  expect([](auto& p) { p.checksum->polynomial = 0x11021; }, checksum, "wider than the sum");
  EXPECT_THAT(problem_of([](auto& p) { p.checksum->polynomial = 0; }).mend,
              HasSubstr("at most 65535"));
  expect([](auto& p) { p.checksum->end_byte = 28; }, checksum, "covers its own bytes");
  expect([](auto& p) { p.checksum->end_byte = 30; }, checksum, "beyond the report's 29");
  expect([](auto& p) { p.checksum->end_byte = 0; }, checksum, "covers no bytes");
  const ReportField any{.offset_bits = 8, .width_bits = 8};
  expect([&](auto& p) { p.auxiliary.resize(33, {"a", "V", any}); }, auxiliary, "too many");
  expect([&](auto& p) { p.auxiliary.resize(2, {"a", "V", any}); }, auxiliary, "the same name");
  expect([&](auto& p) { p.auxiliary.resize(1, {"a", "", any}); }, auxiliary, "no name or unit");
}

}  // namespace
}  // namespace condyle::hal
