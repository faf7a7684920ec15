// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "support/command.h"
#include "support/temporary_folder.h"

namespace condyle::testing_support {
namespace {

using testing::HasSubstr;

// X, Y and Z in 16 bits, logical +-350, physical +-1400 in 1e-4 cm.
constexpr const char* kThreeAxes =
    "05 01 09 08 a1 01 85 01 16 a2 fe 26 5e 01 36 88 fa 46 78 05 55 0c 65 11\n"
    "09 30 09 31 09 32 75 10 95 03 81 06 c0\n";

CommandResult inspect(const std::string& path) {
  return run_condyle({"inspect", "--descriptor", path, "--json"});
}

TEST(InspectCommand, GivesTheFieldsAsJson) {
  const TemporaryFolder folder;
  const CommandResult result = inspect(folder.write("three_axes.txt", kThreeAxes));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const auto report = nlohmann::json::parse(result.output).at("reports").at(0);
  EXPECT_EQ(report.at("id"), 1);
  EXPECT_EQ(report.at("direction"), "input");
  EXPECT_EQ(report.at("size_bits"), 56);
  const auto field = report.at("fields").at(0);
  EXPECT_EQ(field.at("bit_offset"), 8);
  EXPECT_EQ(field.at("bit_width"), 16);
  EXPECT_EQ(field.at("count"), 3);
  EXPECT_EQ(field.at("usages").at(2).at("id"), 0x32);
  EXPECT_EQ(field.at("logical_minimum"), -350);
  EXPECT_EQ(field.at("physical_maximum"), 1400);
  EXPECT_EQ(field.at("unit_SI"), "m");
  EXPECT_EQ(field.at("scale_SI"), 4e-6);
}

TEST(InspectCommand, ReadsHexadecimalTextHoweverItIsWritten) {
  const TemporaryFolder folder;
  const std::string bytes("\x06\x00\xff\xa1\x01\x75\x08\x95\x01\x81\x02\xc0", 12);
  const CommandResult expected = inspect(folder.write("bytes", bytes));
  ASSERT_EQ(expected.exit_code, 0) << expected.errors;
  for (const char* text : {"06 00 ff a1 01 75 08 95 01 81 02 c0",
                           "0x06, 0x00, 0xff,\n0xA1, 0x1, 0x75,0x8 0x95 0x1 0x81 0x2 0xC0\n",
                           "0600FFA101750895018102C0", "6 0 ff a1 1 75 8 95 1 81 2 c0"}) {
    EXPECT_EQ(inspect(folder.write("other", text)).output, expected.output) << text;
  }
  for (const char* text : {"", "zz\n", "06 00 ff a1 01 c0"}) {
    const CommandResult none = inspect(folder.write("none", text));
    EXPECT_EQ(none.exit_code, 3) << text;
    EXPECT_THAT(none.errors, HasSubstr("describes no reports")) << text;
  }
  const CommandResult odd = inspect(folder.write("odd.txt", "05 01\n060 00\n"));
  EXPECT_EQ(odd.exit_code, 2);
  EXPECT_THAT(odd.errors, HasSubstr("odd.txt:2: \"060\" is not a hexadecimal byte"));
}

TEST(InspectCommand, RefusesWithTheByte) {
  const TemporaryFolder folder;
  const CommandResult result = inspect(folder.write("cut", std::string("\x05\x01\xa1\x01\x26", 5)));
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.errors, HasSubstr("cut: byte 4: its last item is cut off"));
  EXPECT_EQ(result.output, "");
  EXPECT_EQ(inspect(folder / "missing").exit_code, 2);
}

}  // namespace
}  // namespace condyle::testing_support
