// SPDX-License-Identifier: Apache-2.0
#include "hid/descriptor_unit.h"

#include <array>
#include <cmath>
#include <numbers>

namespace condyle::hal {
namespace {

// Nibbles of the unit item, from its least significant: the system, then the power of each
// quantity.
enum Quantity : std::uint8_t {
  length = 1,
  mass,
  time,
  temperature,
  current,
  luminous,
  kQuantities
};
enum System : std::uint8_t { si_linear = 1, si_rotation, english_linear, english_rotation };

int power_of(std::uint32_t code, int quantity) {
  const int nibble = static_cast<int>((code >> (4 * quantity)) & 0xFU);
  return nibble < 8 ? nibble : nibble - 16;
}

// Powers of ten are kept apart from other factors, so that decimal units convert without rounding
// twice.
struct Factor {
  int tens = 0;
  double other = 1;
};

void multiply(Factor& factor, int power, int tens, double other) {
  factor.tens += power * tens;
  factor.other *= std::pow(other, power);
}

Factor to_si(std::uint32_t code) {
  constexpr double kInch_m = 0.0254;
  constexpr double kSlug_kg = 14.59390294;  // NIST SP 811 (2008), appendix B.8
  constexpr double kDegree_rad = std::numbers::pi / 180;
  const auto system = code & 0xFU;
  const bool is_english = system == english_linear || system == english_rotation;
  Factor factor;
  if (system == si_linear) multiply(factor, power_of(code, length), -2, 1);  // centimetre
  if (system == english_linear) multiply(factor, power_of(code, length), 0, kInch_m);
  if (system == english_rotation) multiply(factor, power_of(code, length), 0, kDegree_rad);
  multiply(factor, power_of(code, mass), is_english ? 0 : -3, is_english ? kSlug_kg : 1);  // gram
  return factor;
}

std::string text_of(std::uint32_t code) {
  const auto system = code & 0xFU;
  const bool is_rotation = system == si_rotation || system == english_rotation;
  const std::array<const char*, kQuantities> names = {
      "", is_rotation ? "rad" : "m", "kg", "s", "K", "A", "cd"};
  std::string above, below;
  for (const int quantity :
       {int{mass}, int{length}, int{time}, int{temperature}, int{current}, int{luminous}}) {
    const int power = power_of(code, quantity);
    if (power == 0) continue;
    std::string& part = power > 0 ? above : below;
    if (!part.empty()) part += ' ';
    part += names[static_cast<std::size_t>(quantity)];
    if (std::abs(power) > 1) part += '^' + std::to_string(std::abs(power));
  }
  if (below.empty()) return above;
  const bool is_one = below.find(' ') == std::string::npos;
  return (above.empty() ? "1" : above) + '/' + (is_one ? below : '(' + below + ')');
}

double times_ten_to(double value, int exponent) {
  // Dividing by a positive power is exact; multiplying by its reciprocal is not.
  return exponent < 0 ? value / std::pow(10.0, -exponent) : value * std::pow(10.0, exponent);
}

}  // namespace

void complete_unit(DescriptorField& field) {
  const auto system = field.unit.code & 0xFU;
  const bool is_known = system >= si_linear && system <= english_rotation;
  const bool has_quantity = (field.unit.code & 0x0FFFFFF0U) != 0;
  if (!is_known || !has_quantity) return;
  field.unit.text = text_of(field.unit.code);
  const bool is_fahrenheit =
      system >= english_linear && power_of(field.unit.code, temperature) != 0;
  const double logical_span = static_cast<double>(field.logical_maximum - field.logical_minimum);
  const double physical_span = static_cast<double>(field.physical_maximum - field.physical_minimum);
  if (is_fahrenheit || logical_span == 0 || physical_span == 0) return;
  const Factor factor = to_si(field.unit.code);
  const int tens = field.unit.exponent + factor.tens;
  const auto in_si = [&](double physical) { return times_ten_to(physical, tens) * factor.other; };
  const double scale = in_si(physical_span / logical_span);
  // Value at logical zero: physical_minimum - logical_minimum * span ratio, one rounding.
  const double zero = (static_cast<double>(field.physical_minimum) * logical_span -
                       static_cast<double>(field.logical_minimum) * physical_span) /
                      logical_span;
  const double offset = in_si(zero);
  if (!std::isfinite(scale) || !std::isfinite(offset) || scale == 0) return;
  field.unit.scale = scale;
  field.unit.offset = offset;
}

}  // namespace condyle::hal
