// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
// rapidcheck's own header needs gtest's before it.
#include <rapidcheck/gtest.h>

namespace condyle::testing_support {

/// A number from `lowest` to `highest`.
inline rc::Gen<double> number_between(double lowest, double highest) {
  return rc::gen::map(rc::gen::inRange<std::int64_t>(0, (std::int64_t{1} << 52) + 1),
                      [=](std::int64_t share) {
                        return lowest + (highest - lowest) * static_cast<double>(share) * 0x1p-52;
                      });
}

}  // namespace condyle::testing_support
