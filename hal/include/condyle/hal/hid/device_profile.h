// SPDX-License-Identifier: Apache-2.0
// What is known of a facebow: which device it is and what the bits of its reports mean.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "condyle/hal/report/report_layout.h"

namespace condyle::hal {

/// A further measured value of a report.
struct AuxiliaryField {
  std::string name;  ///< "emg_masseter_left"
  std::string unit;  ///< of the value after scaling: "V"
  ReportField field;
};

/// Where an axis of condyle's frame lies in the device's.
struct DeviceAxis {
  Axis axis = Axis::x;  ///< the device's
  bool is_reversed = false;
};

/// The device's axes behind condyle's x, y and z. Each stands once.
using AxisConvention = std::array<DeviceAxis, 3>;

/// Device and condyle agree.
inline constexpr AxisConvention kSameAxes = {{{Axis::x}, {Axis::y}, {Axis::z}}};

/// What a profile file says, of a facebow or of an instrument beside it. find_problem
/// (profile_check.h) holds what makes it usable.
struct DeviceProfile : ReportContent {
  std::string name;
  std::uint16_t vendor_id = 0;
  std::uint16_t product_id = 0;
  int interface_number = -1;  ///< -1: the first HID interface
  /// Set: the coordinates are to be found in the device's report descriptor (descriptor_profile.h).
  std::optional<AxisConvention> descriptor_axes;
  std::vector<AuxiliaryField> auxiliary;  ///< at most kMaxAuxiliary

  /// Time between reports; none where the profile does not say how many come in a second.
  std::optional<TimeNs> nominal_step_ns() const {
    return rate_Hz > 0 ? std::optional(nanoseconds(1 / rate_Hz)) : std::nullopt;
  }
  /// False of a facebow's companions: force sensors, EMG amplifiers.
  bool measures_position() const { return descriptor_axes || !coordinates.empty(); }
};

}  // namespace condyle::hal
