// SPDX-License-Identifier: Apache-2.0
#include "hosted/config/profile_coordinates.h"

#include <fmt/format.h>

#include <algorithm>

namespace condyle::host {
namespace {

const std::vector<ProfileUnit> kLengthUnits = {{"m", "m", 1}, {"mm", "m", 1e3}, {"um", "m", 1e6}};
const std::vector<std::string_view> kPointNames = {"x", "y", "z"};
const std::vector<std::string_view> kThreePointNames = {"x1", "y1", "z1", "x2", "y2",
                                                        "z2", "x3", "y3", "z3"};
const std::vector<std::string_view> kQuaternionNames = {"w", "x", "y", "z"};

// Index and sign of the device's coordinate that is a coordinate of condyle's.
struct Target {
  std::size_t index = 0;
  double sign = 1;
};

hal::AxisConvention read_axes(TomlReader& file) {
  std::vector<std::size_t> choices;
  if (!file.choices("coordinates", "axes", choices, 3, {"x", "-x", "y", "-y", "z", "-z"})) {
    return hal::kSameAxes;
  }
  hal::AxisConvention axes;
  bool is_taken[3] = {};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t axis = choices[i] / 2;
    if (is_taken[axis]) {
      throw InputError(file.place("coordinates", "axes"),
                       fmt::format("axes names {} twice", kPointNames[axis]),
                       "name the device's axes for condyle's x, y and z, each once");
    }
    is_taken[axis] = true;
    axes[i] = {static_cast<Axis>(axis), choices[i] % 2 == 1};
  }
  return axes;
}

// Condyle's coordinate for the device's `axis` of a point.
Target target_of(const hal::AxisConvention& axes, std::size_t axis) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (static_cast<std::size_t>(axes[i].axis) == axis)
      return {i, axes[i].is_reversed ? -1.0 : 1.0};
  }
  return {};
}

// Determinant of the matrix of the convention: -1 if it turns a right hand into a left one.
double determinant(const hal::AxisConvention& axes) {
  double result = 1;
  for (std::size_t i = 0; i < 3; ++i) {
    if (axes[i].is_reversed) result = -result;
    for (std::size_t j = i + 1; j < 3; ++j) {
      if (axes[j].axis < axes[i].axis) result = -result;
    }
  }
  return result;
}

class CoordinateReader {
 public:
  CoordinateReader(TomlReader& file, ProfileFieldReader& fields, hal::DeviceProfile& profile)
      : file_(file), fields_(fields), profile_(profile) {}

  // Reads the device's coordinates `names`; those without their own place follow each other.
  template <class TargetOf>
  void read(const std::string& section, const std::vector<std::string_view>& names,
            const FieldText& plain, const std::vector<ProfileUnit>& units, TargetOf target_of) {
    FieldText common = plain;
    read_field(section, common, units);
    fields_.read_stride(section, common);
    std::vector<std::size_t> order;
    if (!file_.choices(section, "order", order, names.size(), names)) {
      for (std::size_t i = 0; i < names.size(); ++i) order.push_back(i);
    }
    if (std::vector<bool> seen(names.size()); !is_permutation(order, seen)) {
      throw InputError(file_.place(section, "order"), "order names a coordinate twice",
                       "name each once, in the order of the report");
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
      const std::string own = fmt::format("{}.{}", section, names[order[i]]);
      FieldText text = common;
      // Bounded by the reader: 9 strides of 8192 bits.
      const std::uint32_t stride =
          common.stride_bits != 0 ? common.stride_bits : common.field.width_bits;
      text.field.offset_bits += static_cast<std::uint32_t>(i) * stride;
      read_field(own, text, units);
      const bool has_own = fields_.is_there(own);
      fields_.require_field(has_own ? own : section, text, !units.empty());
      const Target target = target_of(order[i]);
      hal::ReportField field = text.in_si();
      field.scale *= target.sign;
      field.offset *= target.sign;
      profile_.coordinates.push_back({field, target.index});
      sections_.push_back(has_own ? own : section);
    }
  }

  CoordinateSections sections() const { return sections_; }

 private:
  void read_field(const std::string& section, FieldText& text,
                  const std::vector<ProfileUnit>& units) {
    fields_.read_place(section, text);
    fields_.read_scale(section, text, units);
    fields_.read_value(section, text);
  }

  static bool is_permutation(const std::vector<std::size_t>& order, std::vector<bool>& seen) {
    for (const std::size_t i : order) seen[i] = true;
    return std::all_of(seen.begin(), seen.end(), [](bool is_seen) { return is_seen; });
  }

  TomlReader& file_;
  ProfileFieldReader& fields_;
  hal::DeviceProfile& profile_;
  CoordinateSections sections_;
};

}  // namespace

CoordinateSections read_coordinates(TomlReader& file, ProfileFieldReader& fields,
                                    const FieldText& plain, hal::DeviceProfile& profile) {
  std::size_t source = 0, kind = 0;
  file.choice("coordinates", "source", source, {"profile", "descriptor"});
  const bool has_kind =
      file.choice("coordinates", "kind", kind, {"one_axis", "one_point", "three_points", "pose"});
  profile.kind = static_cast<SampleKind>(kind);
  if (source == 1) {
    profile.descriptor_axes = read_axes(file);
    if (has_kind && profile.kind != SampleKind::one_point) {
      throw InputError(file.place("coordinates", "kind"), "a descriptor gives one point",
                       "set kind = \"one_point\", or leave it out");
    }
    profile.kind = SampleKind::one_point;
    return {};
  }
  fields.require(has_kind, "coordinates", "kind",
                 "give \"one_axis\", \"one_point\", \"three_points\" or \"pose\"");
  CoordinateReader reader(file, fields, profile);
  if (profile.kind == SampleKind::one_axis) {
    reader.read("coordinates", {"position"}, plain, kLengthUnits,
                [](std::size_t) { return Target{}; });
    return reader.sections();
  }
  const hal::AxisConvention axes = read_axes(file);
  reader.read("coordinates",
              profile.kind == SampleKind::three_points ? kThreePointNames : kPointNames, plain,
              kLengthUnits, [&](std::size_t i) {
                const Target target = target_of(axes, i % 3);
                return Target{i - i % 3 + target.index, target.sign};
              });
  if (profile.kind != SampleKind::pose) return reader.sections();
  // With both frames turned by M, the rotation R becomes M R M^T: the quaternion's vector turns
  // with M, and once more its sign where M mirrors.
  reader.read("quaternion", kQuaternionNames, plain, {}, [&](std::size_t i) {
    if (i == 0) return Target{3, 1};
    const Target target = target_of(axes, i - 1);
    return Target{4 + target.index, target.sign * determinant(axes)};
  });
  return reader.sections();
}

}  // namespace condyle::host
