// SPDX-License-Identifier: Apache-2.0
// Greatest values whose top is short. The instant of a greatest value is the top of means, so that
// noise does not decide on it. Means pass over a top that is shorter than they are: a tremor, a
// tooth that guides the jaw aside. How far the value lies below the highest sample is read like a
// value of its own, and what of it is not noise is in the interval. So is how far readings at that
// instant differ at the other samples that may be the top.
#pragma once

#include <string_view>
#include <vector>

#include "readings/reading.h"

namespace condyle::host {

/// Takes the shortfalls of the greatest values and of what is read at them among `names` from the
/// end of `values`, which has them in this order, and widens these values by them.
void take_shortfalls(const std::vector<std::string_view>& names,
                     std::vector<UncertainValue>& values);

}  // namespace condyle::host
