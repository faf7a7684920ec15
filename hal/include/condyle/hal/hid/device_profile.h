// SPDX-License-Identifier: Apache-2.0
// A device profile: which device it is and what the bits of its reports mean.
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

/// Which axis of the device an axis of condyle's frame is.
struct DeviceAxis {
  Axis axis = Axis::x;  ///< the device's
  bool is_reversed = false;
};

/// The device's axes for condyle's x, y and z, each once.
using AxisConvention = std::array<DeviceAxis, 3>;

/// The axes of device and condyle agree.
inline constexpr AxisConvention kSameAxes = {{{Axis::x}, {Axis::y}, {Axis::z}}};

/// The content of a profile file, of a facebow or of a companion. find_problem (profile_check.h)
/// checks that it is usable.
struct DeviceProfile : ReportContent {
  std::string name;
  std::uint16_t vendor_id = 0;
  std::uint16_t product_id = 0;
  int interface_number = -1;  ///< -1: the first HID interface
  /// Set if the coordinates come from the device's report descriptor (descriptor_profile.h).
  std::optional<AxisConvention> descriptor_axes;
  std::vector<AuxiliaryField> auxiliary;  ///< at most kMaxAuxiliary

  /// Time between reports; none if the profile does not state the rate.
  std::optional<TimeNs> nominal_step_ns() const {
    return rate_Hz > 0 ? std::optional(nanoseconds(1 / rate_Hz)) : std::nullopt;
  }
  /// False for a companion, such as a force sensor or an EMG amplifier.
  bool measures_position() const { return descriptor_axes || !coordinates.empty(); }
};

}  // namespace condyle::hal
