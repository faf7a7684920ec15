// SPDX-License-Identifier: Apache-2.0
#include "bridge/node_rows.h"

#include "hosted/node/to_double.h"

namespace condyle::host {

template <class Scalar>
std::optional<EstimateRow> NodeRows::row_in(const hal::LinkFrame& frame) {
  const auto is_read = [&](auto& message) {
    return frame.type == static_cast<std::uint8_t>(message.kType) &&
           hal::get(frame.payload, message).reason == hal::RefusalReason::none;
  };
  if (axis_count_ == 0) {
    hal::PublishedEstimateMessage<Scalar> message;
    if (is_read(message)) {
      Sample sample;
      sample.time_ns = message.sample.time_ns;
      sample.time_valid = message.sample.time_valid;
      sample.position_valid = false;
      return host::row_of(sample, followed_, to_double(message.estimate));
    }
  } else {
    hal::RecommendedEstimateMessage<Scalar> message;
    if (is_read(message) &&
        (message.estimate.axis_count == axis_count_ || !message.estimate.is_ready)) {
      if (!message.estimate.is_ready) return std::nullopt;
      if (!has_impedance_) return host::row_of(to_double(message.estimate), followed_.axis);
      return host::row_of(DrivenEstimate<double>{to_double(message.estimate), conclusion_},
                          followed_.axis);
    }
  }
  ++unreadable_;
  return std::nullopt;
}

template <class Scalar>
void NodeRows::take_in(const hal::LinkFrame& frame) {
  hal::ConclusionMessage<Scalar> message;
  if (hal::get(frame.payload, message).reason != hal::RefusalReason::none) {
    ++unreadable_;
    return;
  }
  conclusion_ = to_double(message.conclusion);
}

void NodeRows::take_conclusion(const hal::LinkFrame& frame) {
  scalar_size_ == sizeof(float) ? take_in<float>(frame) : take_in<double>(frame);
}

std::optional<EstimateRow> NodeRows::row_of(const hal::LinkFrame& frame) {
  return scalar_size_ == sizeof(float) ? row_in<float>(frame) : row_in<double>(frame);
}

}  // namespace condyle::host
