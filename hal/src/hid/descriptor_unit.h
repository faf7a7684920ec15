// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "condyle/hal/hid/report_descriptor.h"

namespace condyle::hal {

/// Text and conversion to SI of a field whose ranges, unit code and exponent are set.
/// Source: HID 1.11, sections 5.8 (resolution) and 6.2.2.7 (unit, unit exponent).
void complete_unit(DescriptorField& field);

}  // namespace condyle::hal
