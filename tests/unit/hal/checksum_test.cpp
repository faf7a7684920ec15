// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/report/checksum.h"

#include <boost/crc.hpp>
#include <string_view>

#include "support/rapidcheck_gtest.h"

namespace condyle::hal {
namespace {

// A model of the catalogue of CRC algorithms (reveng.sourceforge.io/crc-catalogue), and its check
// value: the checksum of "123456789".
struct Model {
  const char* name;
  unsigned width_bits;
  std::uint32_t polynomial, initial;
  bool reflects;
  std::uint32_t final_xor, check;
};
constexpr Model kCatalogue[] = {
    {"CRC-8/SMBUS", 8, 0x07, 0x00, false, 0x00, 0xF4},
    {"CRC-8/I-432-1", 8, 0x07, 0x00, false, 0x55, 0xA1},
    {"CRC-8/ROHC", 8, 0x07, 0xFF, true, 0x00, 0xD0},
    {"CRC-8/MAXIM-DOW", 8, 0x31, 0x00, true, 0x00, 0xA1},
    {"CRC-8/I-CODE", 8, 0x1D, 0xFD, false, 0x00, 0x7E},
    {"CRC-8/WCDMA", 8, 0x9B, 0x00, true, 0x00, 0x25},
    {"CRC-16/IBM-3740", 16, 0x1021, 0xFFFF, false, 0x0000, 0x29B1},
    {"CRC-16/XMODEM", 16, 0x1021, 0x0000, false, 0x0000, 0x31C3},
    {"CRC-16/KERMIT", 16, 0x1021, 0x0000, true, 0x0000, 0x2189},
    {"CRC-16/IBM-SDLC", 16, 0x1021, 0xFFFF, true, 0xFFFF, 0x906E},
    {"CRC-16/ARC", 16, 0x8005, 0x0000, true, 0x0000, 0xBB3D},
    {"CRC-16/MODBUS", 16, 0x8005, 0xFFFF, true, 0x0000, 0x4B37},
    {"CRC-16/USB", 16, 0x8005, 0xFFFF, true, 0xFFFF, 0xB4C8},
};

TEST(Checksum, GivesTheCheckValuesOfTheCatalogue) {
  constexpr std::string_view text = "123456789";
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  for (const Model& model : kCatalogue) {
    Checksum checksum;
    checksum.width_bits = model.width_bits;
    checksum.polynomial = model.polynomial;
    checksum.initial = model.initial;
    checksum.reflects_input = checksum.reflects_output = model.reflects;
    checksum.final_xor = model.final_xor;
    EXPECT_EQ(checksum_of(checksum, bytes), model.check) << model.name;
  }
}

template <unsigned kWidth>
void agree_with_boost() {
  const auto any = [] { return *rc::gen::inRange<std::uint32_t>(0, 1U << kWidth); };
  Checksum checksum;
  checksum.width_bits = kWidth;
  checksum.polynomial = any();
  checksum.initial = any();
  checksum.final_xor = any();
  checksum.reflects_input = *rc::gen::arbitrary<bool>();
  checksum.reflects_output = *rc::gen::arbitrary<bool>();
  const auto bytes = *rc::gen::arbitrary<std::vector<std::uint8_t>>();
  using Register = typename boost::crc_basic<kWidth>::value_type;
  boost::crc_basic<kWidth> reference(
      static_cast<Register>(checksum.polynomial), static_cast<Register>(checksum.initial),
      static_cast<Register>(checksum.final_xor), checksum.reflects_input, checksum.reflects_output);
  reference.process_bytes(bytes.data(), bytes.size());
  RC_ASSERT(checksum_of(checksum, bytes) == reference.checksum());
}

RC_GTEST_PROP(Checksum, AgreesWithBoostOn8Bits, ()) {
  agree_with_boost<8>();
}
RC_GTEST_PROP(Checksum, AgreesWithBoostOn16Bits, ()) {
  agree_with_boost<16>();
}

}  // namespace
}  // namespace condyle::hal
