// SPDX-License-Identifier: Apache-2.0
#include "recordings/file_units.h"

#include <fmt/format.h>

#include <algorithm>

#include "hosted/files/number_text.h"

namespace condyle::host {
namespace {

struct Spelling {
  std::string_view text, name;
  double value;
};

std::string lower_case(std::string_view text) {
  std::string lower(trim(text));
  std::transform(lower.begin(), lower.end(), lower.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return lower;
}

template <std::size_t kCount>
const Spelling* find(const Spelling (&spellings)[kCount], std::string_view text) {
  const auto* const found =
      std::find_if(std::begin(spellings), std::end(spellings),
                   [&](const Spelling& spelling) { return spelling.text == text; });
  return found == std::end(spellings) ? nullptr : found;
}

}  // namespace

void use_given_unit(std::optional<double> given_per_metre, RecordingInfo& info) {
  if (!given_per_metre) return;
  const auto stated = length_unit(info.stated.unit);
  const std::string given = *given_per_metre == 1000 ? "mm" : "m";
  if (stated && stated->per_metre != *given_per_metre) {
    info.notes.push_back(fmt::format("it states coordinates in {}: read in {}, as --unit says",
                                     stated->name, given));
  }
  info.stated.unit = given;
}

std::optional<LengthUnit> length_unit(std::string_view text) {
  // Fields of four characters cut the words.
  constexpr Spelling kLengths[] = {{"mm", "mm", 1e3},
                                   {"millimeters", "mm", 1e3},
                                   {"millimetres", "mm", 1e3},
                                   {"millimeter", "mm", 1e3},
                                   {"millimetre", "mm", 1e3},
                                   {"mill", "mm", 1e3},
                                   {"cm", "cm", 1e2},
                                   {"centimeters", "cm", 1e2},
                                   {"centimetres", "cm", 1e2},
                                   {"centimeter", "cm", 1e2},
                                   {"centimetre", "cm", 1e2},
                                   {"cent", "cm", 1e2},
                                   {"m", "m", 1},
                                   {"meters", "m", 1},
                                   {"metres", "m", 1},
                                   {"meter", "m", 1},
                                   {"metre", "m", 1},
                                   {"mete", "m", 1},
                                   {"metr", "m", 1},
                                   {"um", "um", 1e6},
                                   {"\xc2\xb5m", "um", 1e6},
                                   {"\xb5m", "um", 1e6},
                                   {"\xce\xbcm", "um", 1e6},
                                   {"in", "in", 1 / 0.0254},
                                   {"inch", "in", 1 / 0.0254},
                                   {"inches", "in", 1 / 0.0254}};
  const Spelling* const found = find(kLengths, lower_case(text));
  if (found == nullptr) return std::nullopt;
  return LengthUnit{std::string(found->name), found->value};
}

std::optional<double> newtons_in(std::string_view text) {
  const std::string_view exact = trim(text);
  // Only the case tells mN and MN apart.
  if (exact == "mN") return 1e-3;
  if (exact == "MN") return std::nullopt;
  constexpr Spelling kForces[] = {{"n", "N", 1},       {"nt", "N", 1},    {"newton", "N", 1},
                                  {"newtons", "N", 1}, {"newt", "N", 1},  {"kn", "kN", 1e3},
                                  {"knt", "kN", 1e3},  {"cn", "cN", 1e-2}};
  const Spelling* const found = find(kForces, lower_case(text));
  if (found == nullptr) return std::nullopt;
  return found->value;
}

}  // namespace condyle::host
