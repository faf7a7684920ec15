// SPDX-License-Identifier: Apache-2.0
#include "node_rows.h"

#include <utility>

namespace condyle::host {
namespace {

template <class Scalar>
Quantity<double> widened(const Quantity<Scalar>& quantity) {
  return {quantity.value, quantity.standard_deviation, quantity.provenance};
}

template <class Scalar>
PublishedEstimate<double> widened(const PublishedEstimate<Scalar>& estimate) {
  PublishedEstimate<double> wide;
  wide.position_m = widened(estimate.position_m);
  wide.velocity_m_s = widened(estimate.velocity_m_s);
  wide.force_N = widened(estimate.force_N);
  wide.friction_Ns_m = widened(estimate.friction_Ns_m);
  wide.mass_kg = widened(estimate.mass_kg);
  wide.innovation_m = estimate.innovation_m;
  wide.motion_nis = estimate.motion_nis;
  wide.friction_nis = estimate.friction_nis;
  wide.mass_nis = estimate.mass_nis;
  wide.events = estimate.events;
  wide.verdict = estimate.verdict;
  return wide;
}

template <class Scalar>
RecommendedEstimate<double> widened(const RecommendedEstimate<Scalar>& estimate) {
  RecommendedEstimate<double> wide;
  wide.is_ready = estimate.is_ready;
  wide.time_ns = estimate.time_ns;
  wide.time_valid = estimate.time_valid;
  wide.axis_count = estimate.axis_count;
  wide.nis = estimate.nis;
  wide.events = estimate.events;
  for (int i = 0; i < estimate.axis_count; ++i) {
    const AxisEstimate<Scalar>& axis = estimate.axes[i];
    wide.axes[i] = {.position_m = widened(axis.position_m),
                    .velocity_m_s = widened(axis.velocity_m_s),
                    .acceleration_m_s2 = widened(axis.acceleration_m_s2),
                    .force_N = widened(axis.force_N),
                    .measured_position_m = axis.measured_position_m,
                    .innovation_m = axis.innovation_m,
                    .innovation_sd_m = axis.innovation_sd_m,
                    .noise_sd_m = axis.noise_sd_m,
                    .jerk_density_m2_s5 = axis.jerk_density_m2_s5};
  }
  return wide;
}

}  // namespace

NodeRows::NodeRows(const hal::ReportLayout& layout, FollowedCoordinate followed, bool is_published,
                   unsigned scalar_size)
    : followed_(followed),
      is_published_(is_published),
      scalar_size_(scalar_size),
      facebow_(source_, layout) {}

hal::Status NodeRows::OneReport::read(TimeNs, hal::RawReport& report) {
  if (report_ == nullptr) return hal::Status::timeout;
  report = *std::exchange(report_, nullptr);
  return hal::Status::ok;
}

void NodeRows::add(const hal::RawReport& report) {
  if (!is_published_) return;
  source_.set(report);
  Sample sample;
  if (facebow_.read(hal::kNoDeadline, sample) == hal::Status::ok) samples_.push_back(sample);
}

// The sample that the target made the estimate after; those before it got none.
Sample NodeRows::sample_of(const hal::SampleStamp& stamp) {
  while (!samples_.empty() && samples_.front().sequence != stamp.sequence) samples_.pop_front();
  Sample sample;
  sample.position_valid = false;
  if (!samples_.empty()) {
    sample = samples_.front();
    samples_.pop_front();
  }
  sample.time_ns = stamp.time_ns;
  sample.time_valid = stamp.time_valid;
  return sample;
}

template <class Scalar>
std::optional<EstimateRow> NodeRows::row_in(const hal::LinkFrame& frame) {
  const auto is_read = [&](auto& message) {
    const bool is_good = hal::get(frame.payload, message).reason == hal::RefusalReason::none;
    if (!is_good) ++unreadable_;
    return is_good;
  };
  if (frame.type == static_cast<std::uint8_t>(hal::MessageType::published_estimate)) {
    hal::PublishedEstimateMessage<Scalar> message;
    if (!is_read(message)) return std::nullopt;
    return host::row_of(sample_of(message.sample), followed_, widened(message.estimate));
  }
  hal::RecommendedEstimateMessage<Scalar> message;
  if (!is_read(message) || !message.estimate.is_ready) return std::nullopt;
  return host::row_of(widened(message.estimate), followed_.axis);
}

std::optional<EstimateRow> NodeRows::row_of(const hal::LinkFrame& frame) {
  return scalar_size_ == sizeof(float) ? row_in<float>(frame) : row_in<double>(frame);
}

}  // namespace condyle::host
