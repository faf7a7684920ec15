// SPDX-License-Identifier: Apache-2.0
// Messages of the link, to the other side and back.
#pragma once

#include <gtest/gtest.h>

#include <limits>
#include <span>

#include "condyle/hal/link/link_messages.h"
#include "support/tier.h"
#include "unit/hal/link_bytes.h"

namespace condyle::testing_support {

using hal::get;
using hal::put;
using hal::Refusal;
using hal::RefusalReason;

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// `message` as it is sent.
template <class Message>
Bytes written(const Message& message) {
  Bytes payload(hal::kMaxPayload);
  const auto size = put(message, payload);
  if (!size) {
    ADD_FAILURE() << "does not fit";
    return {};
  }
  payload.resize(*size);
  return payload;
}

/// What becomes of `message` on the other side. Writing that again gives the same bytes; a byte
/// less or more is refused.
template <class Message>
Message sent(const Message& message) {
  const Bytes payload = written(message);
  Message received;
  EXPECT_EQ(get(payload, received).reason, RefusalReason::none);
  EXPECT_EQ(written(received), payload);
  Message other;
  Bytes longer = payload;
  longer.push_back(0);
  EXPECT_EQ(get(longer, other).reason, RefusalReason::wrong_size);
  for (std::size_t size = 0; size < payload.size(); ++size) {
    // Copied, so that the sanitizer sees a byte too far.
    EXPECT_EQ(
        get(Bytes(payload.begin(), payload.begin() + static_cast<std::ptrdiff_t>(size)), other)
            .reason,
        RefusalReason::wrong_size)
        << size;
  }
  Bytes tight(payload.size());
  EXPECT_EQ(put(message, tight), payload.size());
  if (!payload.empty()) {
    EXPECT_FALSE(put(message, std::span(tight).first(tight.size() - 1)));
  }
  return received;
}

/// Where every byte of `message` takes every value: each either is refused, or is a message that is
/// written with this byte. So no byte is passed over, and none is read as something else.
template <class Message>
void expect_each_byte_counts(const Message& message) {
  const Bytes payload = written(message);
  const unsigned step = runs(5U, 1U, 1U);  // a sanitizer slows this most of all
  for (std::size_t i = 0; i < payload.size(); ++i) {
    for (unsigned value = 0; value < 256; value += step) {
      Bytes changed = payload;
      changed[i] = static_cast<std::uint8_t>(value);
      Message received;
      if (get(changed, received).reason != RefusalReason::none) continue;
      ASSERT_EQ(written(received), changed) << "byte " << i << " as " << value;
    }
  }
}

/// `message` is refused for `reason`, and where `index` is given, for that value.
template <class Message>
void expect_refused(const Message& message, RefusalReason reason, int index = -1) {
  const Bytes payload = written(message);
  Message received;
  const Refusal refusal = get(payload, received);
  EXPECT_EQ(refusal.reason, reason);
  if (index >= 0) {
    EXPECT_EQ(refusal.index, index);
  }
}

}  // namespace condyle::testing_support
