// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/report/report_decoder.h"

#include <algorithm>
#include <boost/crc.hpp>
#include <cmath>
#include <cstring>
#include <numeric>
#include <random>

#include "condyle/hal/hid/profile_check.h"
#include "hosted/config/device_profile_file.h"
#include "support/paths.h"
#include "support/rapidcheck_gtest.h"
#include "unit/hal/report_bits.h"

namespace condyle::hal {
namespace {

using testing_support::write_bits;
using Bytes = std::vector<std::uint8_t>;

DeviceProfile facebow() {
  return host::load_device_profile(
      testing_support::source_path("/hal/profiles/condyle_facebow.toml"));
}

void add_checksum(Bytes& report) {
  boost::crc_ccitt_false_t checksum;
  checksum.process_bytes(report.data(), 27);
  report[27] = static_cast<std::uint8_t>(checksum.checksum() & 0xFFU);
  report[28] = static_cast<std::uint8_t>(checksum.checksum() >> 8U);
}

// Count 0x04030201, time 0x00FFEEDD, coordinates 1, -1, 2, -2, 3, -3, 4, -4, 5 counts.
Bytes facebow_report() {
  Bytes report = {1,    0x01, 0x02, 0x03, 0x04, 0xDD, 0xEE, 0xFF, 0x00, 1,    0, 0xFF, 0xFF, 2, 0,
                  0xFE, 0xFF, 3,    0,    0xFD, 0xFF, 4,    0,    0xFC, 0xFF, 5, 0,    0,    0};
  add_checksum(report);
  return report;
}

TEST(ReportDecoder, ReadsTheFacebowsReport) {
  const ReportDecoder decoder(layout_of(facebow()));
  DecodedReport decoded;
  ASSERT_EQ(decoder.decode(facebow_report(), decoded), ReportFault::none);
  EXPECT_EQ(decoded.kind, SampleKind::three_points);
  EXPECT_EQ(decoded.sequence, 0x04030201U);
  EXPECT_EQ(decoded.device_time, 0x00FFEEDDU);
  EXPECT_TRUE(decoded.position_valid);
  const double counts[] = {1, -1, 2, -2, 3, -3, 4, -4, 5};
  for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(decoded.coordinates[i], counts[i] * 4e-6) << i;
  EXPECT_FALSE(decoded.drive_valid);
  EXPECT_EQ(decoded.auxiliary_count, 0U);
}

TEST(ReportDecoder, MarksAPointThatWasNotSeen) {
  const ReportDecoder decoder(layout_of(facebow()));
  Bytes report = facebow_report();
  report[17] = 0;
  report[18] = 0x80;
  add_checksum(report);
  DecodedReport decoded;
  ASSERT_EQ(decoder.decode(report, decoded), ReportFault::none);
  EXPECT_FALSE(decoded.position_valid);
  EXPECT_TRUE(std::isnan(decoded.coordinates[4]));
  EXPECT_EQ(decoded.coordinates[5], -12e-6) << "the others stay";
}

TEST(ReportDecoder, NamesEveryFaultAndLeavesTheResultAlone) {
  const ReportDecoder decoder(layout_of(facebow()));
  DecodedReport decoded;
  decoded.drive_N = 42;
  const Bytes whole = facebow_report();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_EQ(decoder.decode(std::span(whole).first(size), decoded), ReportFault::too_short);
  }
  Bytes other = whole;
  other[0] = 2;
  EXPECT_EQ(decoder.decode(other, decoded), ReportFault::other_report);
  for (std::size_t bit = 8; bit < whole.size() * 8; ++bit) {
    Bytes damaged = whole;
    damaged[bit / 8] = static_cast<std::uint8_t>(damaged[bit / 8] ^ 1U << bit % 8);
    EXPECT_EQ(decoder.decode(damaged, decoded), ReportFault::wrong_checksum) << bit;
  }
  EXPECT_EQ(ReportDecoder(layout_of(DeviceProfile{})).decode(whole, decoded),
            ReportFault::unusable_profile);
  EXPECT_EQ(decoded.drive_N, 42) << "written only where there is a report";
}

TEST(ReportDecoder, TakesLongerReports) {
  Bytes report = facebow_report();
  report.resize(64, 0xAA);
  DecodedReport decoded;
  EXPECT_EQ(ReportDecoder(layout_of(facebow())).decode(report, decoded), ReportFault::none);
}

TEST(ReportDecoder, RefusesACountBeyondItsWrap) {
  DeviceProfile profile = facebow();
  profile.checksum.reset();
  for (auto* counting : {&profile.sequence, &profile.device_time}) {
    DecodedReport decoded;
    const Bytes report = facebow_report();
    const std::uint64_t value = read_raw((*counting)->field, report);
    (*counting)->wraps_at = value;
    EXPECT_EQ(ReportDecoder(layout_of(profile)).decode(report, decoded),
              ReportFault::counter_out_of_range);
    (*counting)->wraps_at = value + 1;
    EXPECT_EQ(ReportDecoder(layout_of(profile)).decode(report, decoded), ReportFault::none);
  }
}

TEST(ReportDecoder, TakesNoPositionBeyondTenMetres) {
  DeviceProfile profile;
  profile.kind = SampleKind::one_point;
  profile.minimum_size_bytes = 12;
  for (std::uint32_t i = 0; i < 3; ++i) {
    profile.coordinates.push_back({{.offset_bits = 32 * i,
                                    .width_bits = 32,
                                    .type = FieldType::floating_point,
                                    .scale = 1e-3},
                                   i});
  }
  const ReportDecoder decoder(layout_of(profile));
  const auto decoded = [&](float z_mm) {
    const float xyz_mm[] = {1, -2, z_mm};
    Bytes report(sizeof xyz_mm);
    std::memcpy(report.data(), xyz_mm, sizeof xyz_mm);
    DecodedReport result;
    EXPECT_EQ(decoder.decode(report, result), ReportFault::none);
    return result;
  };
  EXPECT_TRUE(decoded(9999).position_valid);
  for (const float far_mm : {-3.7e28F, 1e8F, 120e3F, -120e3F, 10'001.0F}) {
    EXPECT_FALSE(decoded(far_mm).position_valid) << far_mm;
    EXPECT_EQ(decoded(far_mm).coordinates[0], 1e-3) << "the numbers stay, to be looked at";
  }
}

TEST(ReportDecoder, BringsAQuaternionToLengthOne) {
  DeviceProfile profile;
  profile.kind = SampleKind::pose;
  profile.minimum_size_bytes = 7;
  for (std::uint32_t i = 0; i < 7; ++i) {
    const ReportField field{
        .offset_bits = 8 * i, .width_bits = 8, .scale = i < 3 ? 1e-3 : 1 / 127.0};
    profile.coordinates.push_back({field, i});
  }
  const ReportDecoder decoder(layout_of(profile));
  DecodedReport decoded;
  ASSERT_EQ(decoder.decode(Bytes{1, 2, 3, 90, 90, 0, 0}, decoded), ReportFault::none);
  EXPECT_TRUE(decoded.position_valid);
  EXPECT_DOUBLE_EQ(decoded.coordinates[3], std::sqrt(0.5));
  ASSERT_EQ(decoder.decode(Bytes{1, 2, 3, 0, 0, 0, 0}, decoded), ReportFault::none);
  EXPECT_FALSE(decoded.position_valid) << "zeros are no orientation";
  ASSERT_EQ(decoder.decode(Bytes{1, 2, 3, 120, 0, 0, 0}, decoded), ReportFault::none);
  EXPECT_FALSE(decoded.position_valid) << "5 % too short";
}

// A profile of fields of random width, one after the other with gaps, in random order.
DeviceProfile any_profile() {
  DeviceProfile profile;
  profile.kind =
      *rc::gen::element(SampleKind::one_axis, SampleKind::one_point, SampleKind::three_points);
  const bool is_numbered = *rc::gen::arbitrary<bool>();
  if (is_numbered) profile.report_id = *rc::gen::arbitrary<std::uint8_t>();
  std::uint32_t end_bits = is_numbered ? 8 : 0;
  const auto next_field = [&](bool is_count) {
    ReportField field;
    field.type = is_count || *rc::gen::arbitrary<bool>() ? FieldType::unsigned_integer
                                                         : FieldType::signed_integer;
    field.byte_order = *rc::gen::arbitrary<bool>() ? ByteOrder::big : ByteOrder::little;
    if (field.byte_order == ByteOrder::big) {
      end_bits = (end_bits + 7) / 8 * 8;
      field.width_bits = 8 * *rc::gen::inRange<std::uint32_t>(1, 7);  // exact as a double
    } else {
      end_bits += *rc::gen::inRange<std::uint32_t>(0, 9);
      field.width_bits = *rc::gen::inRange<std::uint32_t>(2, 54);
    }
    field.offset_bits = end_bits;
    end_bits += field.width_bits;
    field.scale = is_count ? 1.0 : 0.25;
    return field;
  };
  std::vector<std::size_t> order(coordinate_count(profile.kind));
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937(*rc::gen::arbitrary<std::uint32_t>()));
  profile.sequence = CountingField{next_field(true), 0};
  for (const std::size_t index : order) profile.coordinates.push_back({next_field(false), index});
  profile.device_time = CountingField{next_field(true), 0};
  profile.drive_N = next_field(false);
  const auto auxiliary_count = *rc::gen::inRange<std::size_t>(0, kMaxAuxiliary + 1);
  for (std::size_t i = 0; i < auxiliary_count; ++i) {
    profile.auxiliary.push_back({"a" + std::to_string(i), "V", next_field(false)});
  }
  profile.minimum_size_bytes = (end_bits + 7) / 8;
  return profile;
}

RC_GTEST_PROP(ReportDecoder, ReadsWhatWasEncoded, ()) {
  const DeviceProfile profile = any_profile();
  RC_ASSERT(!find_problem(profile));
  Bytes bytes =
      *rc::gen::container<Bytes>(profile.minimum_size_bytes, rc::gen::arbitrary<std::uint8_t>());
  if (profile.report_id) bytes[0] = *profile.report_id;
  // Writes a random number and gives what is to be read.
  const auto write = [&](const ReportField& field) {
    const std::uint64_t raw = *rc::gen::inRange<std::uint64_t>(0, std::uint64_t{1} << 62U) >>
                              (62 - std::min(field.width_bits, 62U));
    write_bits(bytes, field, raw);
    auto number = static_cast<double>(raw);
    const bool is_negative = (raw >> (field.width_bits - 1) & 1U) != 0;
    if (field.type == FieldType::signed_integer && is_negative) {
      number -= std::exp2(field.width_bits);
    }
    return number * field.scale;
  };
  const double sequence = write(profile.sequence->field);
  const double time = write(profile.device_time->field);
  const double drive_N = write(*profile.drive_N);
  std::array<double, 9> coordinates{};
  for (const CoordinateField& c : profile.coordinates) coordinates[c.index] = write(c.field);
  std::vector<double> auxiliary;
  for (const AuxiliaryField& a : profile.auxiliary) auxiliary.push_back(write(a.field));

  DecodedReport decoded;
  RC_ASSERT(ReportDecoder(layout_of(profile)).decode(bytes, decoded) == ReportFault::none);
  RC_ASSERT(static_cast<double>(decoded.sequence.value()) == sequence);
  RC_ASSERT(static_cast<double>(decoded.device_time.value()) == time);
  RC_ASSERT(decoded.drive_valid);
  RC_ASSERT(decoded.drive_N == drive_N);
  RC_ASSERT(decoded.position_valid == !is_out_of_range(profile.kind, coordinates.data()));
  RC_ASSERT(decoded.coordinates == coordinates);
  RC_ASSERT(decoded.auxiliary_count == auxiliary.size());
  for (std::size_t i = 0; i < auxiliary.size(); ++i) {
    RC_ASSERT(decoded.auxiliary[i].value == auxiliary[i]);
  }
}

RC_GTEST_PROP(ReportDecoder, TakesAnyBytes, (const Bytes& bytes)) {
  const DeviceProfile profile = any_profile();
  DecodedReport decoded;
  const ReportFault fault = ReportDecoder(layout_of(profile)).decode(bytes, decoded);
  const bool is_other = profile.report_id && !bytes.empty() && bytes[0] != *profile.report_id;
  const bool is_short = bytes.size() < profile.minimum_size_bytes;
  RC_ASSERT(fault == (is_other   ? ReportFault::other_report
                      : is_short ? ReportFault::too_short
                                 : ReportFault::none));
}

}  // namespace
}  // namespace condyle::hal
