// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "box/realtime/box_estimate.h"

namespace condyle::box {

/// An estimate as one line of JSON, without the line's end. Numbers are written so that reading
/// them gives the same bits; what is not known is null. Every value has its standard deviation and
/// says whether it is measured, derived or assumed. Of a microcontroller's it says how late it is;
/// that there is none is a line too.
std::string estimate_line(const BoxEstimate& estimate);

}  // namespace condyle::box
