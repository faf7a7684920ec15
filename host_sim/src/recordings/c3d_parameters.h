// SPDX-License-Identifier: Apache-2.0
// Numbers and the parameter section of C3D files, as the C3D file format's user guide describes
// them (https://www.c3d.org/docs/C3D_User_Guide.pdf).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace condyle::host {

/// The byte order and the floating-point numbers of a C3D file, by its parameter section.
enum class C3dProcessor : std::uint8_t { intel = 84, dec = 85, mips = 86 };

/// The 16-bit word at `bytes`, without sign.
std::uint16_t c3d_word(C3dProcessor processor, const char* bytes);
/// The signed 16-bit number at `bytes`.
std::int16_t c3d_integer(C3dProcessor processor, const char* bytes);
/// The 32-bit floating-point number at `bytes`: IEEE 754, of DEC the F format of a VAX.
double c3d_float(C3dProcessor processor, const char* bytes);

/// The parameters of a C3D file, by "GROUP:NAME" in capitals.
class C3dParameters {
 public:
  /// Reads `section`, which begins with the four bytes before the first record. A note in `notes`
  /// says where the section is damaged; what is read before that stays.
  C3dParameters(std::string_view section, C3dProcessor processor, std::vector<std::string>& notes);

  bool has(const std::string& name) const { return parameters_.contains(name); }
  /// The number `index` of the parameter `name`; integers with their sign. None if it has fewer.
  std::optional<double> number(const std::string& name, std::size_t index = 0) const;
  /// The same for what counts or numbers: 16-bit integers without sign.
  std::optional<double> count(const std::string& name, std::size_t index = 0) const;
  /// The texts of the parameter `name`, without blanks at their ends; empty if there is none.
  std::vector<std::string> texts(const std::string& name) const;
  /// The same, and those of NAME2, NAME3 and so on, which continue a list of more than 255.
  std::vector<std::string> all_texts(const std::string& name) const;

 private:
  struct Parameter {
    int size = 0;                    // of an element; -1: text
    std::vector<std::size_t> shape;  // the first changes fastest
    std::string bytes;
  };
  std::optional<double> number_of(const std::string& name, std::size_t index, bool has_sign) const;

  C3dProcessor processor_;
  std::map<std::string, Parameter> parameters_;
};

}  // namespace condyle::host
