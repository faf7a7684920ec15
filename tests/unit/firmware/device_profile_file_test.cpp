// SPDX-License-Identifier: Apache-2.0
#include "hosted/config/device_profile_file.h"

#include <gmock/gmock.h>

#include <cmath>

#include "condyle/hal/hid/profile_check.h"
#include "condyle/hal/report/report_decoder.h"
#include "hosted/files/input_error.h"
#include "support/paths.h"
#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// A point of three bytes each way after the report id; 15 lines.
constexpr const char* kPoint = R"(name = "n"
vendor_id = 1
product_id = 2
[report]
id = 1
minimum_size_bytes = 20
[coordinates]
kind = "one_point"
offset_bytes = 1
width_bits = 24
type = "signed"
unit = "mm"
scale = 0.001
)";

hal::DeviceProfile parse(const std::string& text) {
  return parse_device_profile("p.toml", text);
}

std::string problem_of(const std::string& text) {
  try {
    parse(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

// kPoint with `from` replaced by `to`.
std::string changed(const std::string& from, const std::string& to) {
  std::string text = kPoint;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string problem_of(const std::string& from, const std::string& to) {
  return problem_of(changed(from, to));
}

std::string problem_with(const std::string& more) {
  return problem_of(kPoint + more);
}

TEST(DeviceProfileFile, TakesCompanionsWithoutCoordinates) {
  const std::string text = kPoint;
  const std::string companion = text.substr(0, text.find("[coordinates]"));
  const std::string drive =
      "[drive]\noffset_bytes = 10\nwidth_bits = 16\ntype = \"signed\"\nunit = \"mN\"\n";
  const std::string emg =
      "[auxiliary.emg]\noffset_bytes = 12\nwidth_bits = 16\ntype = \"signed\"\nunit = \"uV\"\n";
  EXPECT_FALSE(parse(companion + drive).measures_position());
  EXPECT_FALSE(parse(companion + emg).measures_position());
  EXPECT_TRUE(parse(text + drive + emg).measures_position());
  EXPECT_THAT(problem_of(companion), HasSubstr("kind"));
  hal::DecodedReport report;
  const std::vector<std::uint8_t> bytes(20, 1);
  const hal::ReportDecoder decoder(hal::layout_of(parse(companion + drive)));
  ASSERT_EQ(decoder.decode(bytes, report), hal::ReportFault::none);
  EXPECT_FALSE(report.position_valid);
  EXPECT_TRUE(std::isnan(report.coordinates[0]));
  EXPECT_NEAR(report.drive_N, 0.257, 1e-12);
}

TEST(DeviceProfileFile, LoadsTheShippedProfile) {
  const hal::DeviceProfile p =
      load_device_profile(testing_support::source_path("/hal/profiles/condyle_facebow.toml"));
  EXPECT_EQ(p.name, "condyle fake facebow");
  EXPECT_EQ(p.vendor_id, 0x1209);
  EXPECT_EQ(p.product_id, 1);
  EXPECT_EQ(p.interface_number, 0);
  EXPECT_EQ(p.rate_Hz, 500);
  EXPECT_EQ(p.report_id, 1);
  EXPECT_EQ(p.minimum_size_bytes, 29U);
  EXPECT_FALSE(p.restarts_on_reconnect);
  ASSERT_EQ(p.coordinates.size(), 9U);
  for (std::uint32_t i = 0; i < 9; ++i) {
    EXPECT_EQ(p.coordinates[i].index, i);
    EXPECT_EQ(p.coordinates[i].field.offset_bits, 72 + 16 * i);
    EXPECT_EQ(p.coordinates[i].field.scale, 4e-6);
    EXPECT_EQ(p.coordinates[i].field.missing, -32768);
  }
  EXPECT_EQ(p.sequence->field.offset_bits, 8U);
  EXPECT_EQ(p.device_time->field.offset_bits, 40U);
  EXPECT_EQ(p.device_time->field.scale, 1e-6);
  EXPECT_EQ(p.checksum->field.offset_bits, 216U);
  EXPECT_EQ(p.checksum->polynomial, 0x1021U);
  EXPECT_EQ(p.checksum->end_byte, 27U);
}

// What the shipped file shows commented out is also part of the format.
TEST(DeviceProfileFile, LoadsTheShippedProfilesExamples) {
  const std::string path = testing_support::source_path("/hal/profiles/condyle_facebow.toml");
  std::string text = testing_support::read_file(path);
  const std::size_t drive = text.find("# [drive]");
  ASSERT_NE(drive, std::string::npos);
  for (std::size_t line = drive; (line = text.find("\n# ", line)) != std::string::npos;) {
    const std::string next = text.substr(line + 3, 9);
    const bool is_prose = next.starts_with("Optional") || next.starts_with("\"mV");
    if (!is_prose) text.erase(line + 1, 2);
    ++line;
  }
  text.erase(drive, 2);
  text.replace(text.find("minimum_size_bytes = 29"), 23, "minimum_size_bytes = 33");
  const hal::DeviceProfile p = parse(text);
  ASSERT_TRUE(p.drive_N);
  EXPECT_EQ(p.drive_N->scale, 1e-3);
  ASSERT_EQ(p.auxiliary.size(), 1U);
  EXPECT_EQ(p.auxiliary[0].name, "emg_masseter_left");
  EXPECT_EQ(p.auxiliary[0].unit, "V");
  EXPECT_EQ(p.auxiliary[0].field.scale, 0.5e-3);
  EXPECT_EQ(p.auxiliary[0].field.offset, -1.024);
}

TEST(DeviceProfileFile, LoadsTheGuidesExample) {
  const std::string guide =
      testing_support::read_file(testing_support::source_path("/hal/profiles/README.md"));
  const std::string fence = "```toml my_facebow.toml\n";
  const std::size_t start = guide.find(fence);
  ASSERT_NE(start, std::string::npos);
  const hal::DeviceProfile p = parse(
      guide.substr(start + fence.size(), guide.find("```", start + 1) - start - fence.size()));
  EXPECT_EQ(p.name, "my facebow");
  EXPECT_EQ(p.coordinates[2].index, 1U);
  EXPECT_EQ(p.coordinates[2].field.scale, -1e-3);
}

TEST(DeviceProfileFile, TurnsAxesAndOrdersCoordinates) {
  const hal::DeviceProfile p =
      parse(std::string(kPoint) +
            "axes = [\"y\", \"-z\", \"x\"]\norder = [\"z\", \"x\", \"y\"]\nvalue_offset = 2\n"
            "[coordinates.y]\noffset_bits = 100\nunit = \"um\"\nbyte_order = \"little\"\n");
  ASSERT_EQ(p.coordinates.size(), 3U);
  // The device's z comes first, and is condyle's y, reversed.
  EXPECT_EQ(p.coordinates[0].index, 1U);
  EXPECT_EQ(p.coordinates[0].field.offset_bits, 8U);
  EXPECT_EQ(p.coordinates[0].field.scale, -1e-6);
  EXPECT_EQ(p.coordinates[0].field.offset, -2e-3);
  EXPECT_EQ(p.coordinates[1].index, 2U);
  EXPECT_EQ(p.coordinates[1].field.offset_bits, 32U);
  EXPECT_EQ(p.coordinates[2].index, 0U);
  EXPECT_EQ(p.coordinates[2].field.offset_bits, 100U);
  EXPECT_EQ(p.coordinates[2].field.scale, 1e-9);
}

TEST(DeviceProfileFile, ReadsOneAxis) {
  const hal::DeviceProfile p = parse(changed("one_point", "one_axis"));
  ASSERT_EQ(p.coordinates.size(), 1U);
  EXPECT_EQ(p.coordinates[0].field.offset_bits, 8U);
  EXPECT_THAT(problem_of(changed("one_point", "one_axis") + "axes = [\"x\", \"y\", \"z\"]\n"),
              HasSubstr("unknown key 'axes'"));
}

// The rotation matrix of w, x, y, z.
std::array<std::array<double, 3>, 3> matrix_of(const std::array<double, 4>& q) {
  const auto [w, x, y, z] = q;
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
           {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
           {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
}

TEST(DeviceProfileFile, TurnsOrientationsAsItTurnsPoints) {
  const std::string pose = changed("one_point", "pose");
  const std::string quaternion =
      "[quaternion]\noffset_bytes = 10\nwidth_bits = 8\ntype = \"signed\"\ncounts_per_unit = 1\n";
  // Turned, and once mirrored.
  for (const char* axes :
       {"[\"y\", \"-z\", \"-x\"]", "[\"-x\", \"z\", \"-y\"]", "[\"x\", \"y\", \"-z\"]"}) {
    const hal::DeviceProfile p = parse(pose + "axes = " + axes + "\n" + quaternion);
    ASSERT_EQ(p.coordinates.size(), 7U);
    double turn[3][3] = {};  // condyle's axis, the device's axis
    std::array<double, 4> device = {0.5, 0.1, -0.7, 0.5}, condyle{};
    for (std::size_t i = 0; i < 3; ++i) {
      turn[p.coordinates[i].index][i] = p.coordinates[i].field.scale < 0 ? -1 : 1;
    }
    for (std::size_t i = 0; i < 4; ++i) {
      condyle[p.coordinates[3 + i].index - 3] = device[i] * p.coordinates[3 + i].field.scale;
    }
    const auto before = matrix_of(device), after = matrix_of(condyle);
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t column = 0; column < 3; ++column) {
        double expected = 0;  // turn * before * turn transposed
        for (std::size_t i = 0; i < 3; ++i) {
          for (std::size_t j = 0; j < 3; ++j) {
            expected += turn[row][i] * before[i][j] * turn[column][j];
          }
        }
        EXPECT_NEAR(after[row][column], expected, 1e-12) << axes;
      }
    }
  }
}

TEST(DeviceProfileFile, NamesPlaceProblemAndMendOfKeys) {
  EXPECT_EQ(problem_with(""), "no error");
  EXPECT_THAT(problem_of("vendor_id = 1", "vendor_id = 70000"),
              AllOf(HasSubstr("p.toml:2:13: vendor_id = 70000 is out of range"),
                    HasSubstr("give 0 to 65535")));
  EXPECT_THAT(problem_of("vendor_id = 1", "vendor_id = 1.5"), HasSubstr("takes a whole number"));
  EXPECT_THAT(problem_of("vendor_id = 1\n", ""),
              HasSubstr("p.toml: vendor_id is missing; run condyle"));
  EXPECT_THAT(problem_of("name = \"n\"", "name = \"\""), HasSubstr("name is missing"));
  EXPECT_THAT(problem_of("width_bits = 24", "widht_bits = 24"),
              HasSubstr("p.toml:10:1: unknown key 'widht_bits'; keys of [coordinates] are"))
      << "not that the width is missing";
  EXPECT_THAT(problem_of("width_bits = 24\n", ""),
              HasSubstr("p.toml:7:1: width_bits is missing in [coordinates]"));
  EXPECT_THAT(problem_of("unit = \"mm\"\n", ""), HasSubstr("unit is missing in [coordinates]"));
  EXPECT_THAT(problem_of("unit = \"mm\"", "unit = \"inch\""),
              HasSubstr("\"m\" or \"mm\" or \"um\""));
  EXPECT_THAT(problem_of("type = \"signed\"\n", ""), HasSubstr("type is missing"));
  EXPECT_THAT(problem_of("kind = \"one_point\"\n", ""), HasSubstr("kind is missing"));
  EXPECT_THAT(problem_of("offset_bytes = 1\n", ""), HasSubstr("offset_bytes is missing"));
  EXPECT_THAT(problem_of("minimum_size_bytes = 20\n", ""),
              HasSubstr("minimum_size_bytes is missing in [report]"));
  EXPECT_THAT(problem_of("scale = 0.001", "scale = 0"), HasSubstr("p.toml:13:9: scale is zero"));
  EXPECT_THAT(problem_of("scale = 0.001", "counts_per_unit = 0"), HasSubstr("is zero"));
  EXPECT_THAT(problem_of("scale = 0.001", "scale = nan"), HasSubstr("out of range"));
  EXPECT_THAT(problem_with("counts_per_unit = 5\n"), HasSubstr("the scale is given twice"));
  EXPECT_THAT(problem_with("offset_bits = 8\n"), HasSubstr("the offset is given twice"));
  EXPECT_THAT(problem_with("valid_from = 8\n"), HasSubstr("one end of the valid range"));
  EXPECT_THAT(problem_with("axes = [\"x\", \"-x\", \"z\"]\n"), HasSubstr("axes names x twice"));
  EXPECT_THAT(problem_with("axes = [\"x\", \"y\"]\n"), HasSubstr("an array of 3 strings"));
  EXPECT_THAT(problem_with("axes = \"xyz\"\n"), HasSubstr("an array of 3 strings"));
  EXPECT_THAT(problem_with("axes = [\"x\", \"y\", \"w\"]\n"),
              HasSubstr("p.toml:14:19: axes has an unknown value"));
  EXPECT_THAT(problem_with("order = [\"x\", \"x\", \"z\"]\n"), HasSubstr("a coordinate twice"));
  EXPECT_THAT(problem_with("x = 5\n"), HasSubstr("coordinates.x is a section"));
  EXPECT_THAT(problem_with("[coordinates.w]\n"), HasSubstr("unknown key 'w'"));
  EXPECT_THAT(problem_with("[\"coordinates.x\"]\nscale = 5\n"), HasSubstr("unknown key"));
  EXPECT_THAT(problem_with("[sequnce]\n"), HasSubstr("unknown key 'sequnce'"));
  EXPECT_TRUE(parse(changed("name = \"n\"", "name = \"n\"\nrestarts_on_reconnect = true"))
                  .restarts_on_reconnect);
  EXPECT_THAT(problem_of("name = \"n\"", "name = \"n\"\nrestarts_on_reconnect = 1"),
              HasSubstr("restarts_on_reconnect is neither true nor false"));
}

TEST(DeviceProfileFile, NamesPlaceProblemAndMendOfParts) {
  EXPECT_THAT(problem_with("[sequence]\noffset_bytes = 9\nwidth_bits = 16\n"),
              HasSubstr("p.toml:14:1: the sequence has bits in common with condyle's z"));
  EXPECT_THAT(problem_with("[sequence]\noffset_bytes = 19\nwidth_bits = 16\n"),
              HasSubstr("p.toml:14:1: the sequence reaches beyond the report's 20 bytes"));
  EXPECT_THAT(problem_with("[sequence]\nwidth_bits = 16\n"),
              HasSubstr("p.toml:14:1: offset_bytes is missing in [sequence]"));
  EXPECT_THAT(problem_with("[sequence]\ntype = \"signed\"\n"), HasSubstr("unknown key 'type'"));
  EXPECT_THAT(problem_with("[coordinates.y]\nmissing = 8388608\n"),
              HasSubstr("p.toml:14:1: condyle's y cannot hold the value 8388608"));
  EXPECT_THAT(problem_with("[device_time]\noffset_bytes = 11\nwidth_bits = 32\n"),
              HasSubstr("unit is missing in [device_time]"));
  EXPECT_THAT(problem_with("[checksum]\noffset_bytes = 18\nwidth_bits = 16\nlast_byte = 17\n"),
              HasSubstr("p.toml:14:1: polynomial is missing in [checksum]"));
  EXPECT_THAT(problem_with("[checksum]\noffset_bytes = 18\nwidth_bits = 16\npolynomial = 0x1021\n"),
              HasSubstr("last_byte is missing"));
  EXPECT_THAT(problem_with("[checksum]\noffset_bytes = 18\nwidth_bits = 16\npolynomial = 0x1021\n"
                           "last_byte = 18\n"),
              HasSubstr("the checksum covers its own bytes"));
  EXPECT_THAT(problem_with("[drive]\noffset_bytes = 12\nwidth_bits = 16\ntype = \"signed\"\n"),
              HasSubstr("unit is missing in [drive]"));
  EXPECT_THAT(problem_with("[auxiliary.EMG]\n"), HasSubstr("p.toml:14:1: name 'EMG'"));
  EXPECT_THAT(problem_with("[auxiliary.emg]\noffset_bytes = 30\nwidth_bits = 16\n"
                           "type = \"signed\"\nunit = \"V\"\n"),
              HasSubstr("p.toml:14:1: auxiliary emg reaches beyond"));
  EXPECT_THAT(problem_with("[auxiliary]\nemg = 5\n"), HasSubstr("unknown key"));
}

TEST(DeviceProfileFile, AsksTheDescriptorForOnePointOnly) {
  const std::string text =
      "name = \"n\"\nvendor_id = 1\nproduct_id = 2\n[coordinates]\nsource = \"descriptor\"\n";
  const hal::DeviceProfile p = parse(text + "axes = [\"x\", \"z\", \"-y\"]\n");
  ASSERT_TRUE(p.descriptor_axes);
  EXPECT_EQ((*p.descriptor_axes)[2].axis, Axis::y);
  EXPECT_TRUE((*p.descriptor_axes)[2].is_reversed);
  EXPECT_TRUE(p.coordinates.empty());
  EXPECT_THAT(problem_of(text + "kind = \"pose\"\n"), HasSubstr("a descriptor gives one point"));
  EXPECT_THAT(problem_of(text + "width_bits = 8\n"), HasSubstr("unknown key 'width_bits'"));
}

TEST(DeviceProfileFile, AnEmptyFileSaysWhatIsMissing) {
  EXPECT_EQ(problem_of(""), "p.toml: name is missing; name the device");
  EXPECT_THROW(load_device_profile("/nowhere/p.toml"), InputError);
}

}  // namespace
}  // namespace condyle::host
