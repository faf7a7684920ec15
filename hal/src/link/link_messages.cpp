// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/link/link_messages.h"

#include "link/link_archive.h"

namespace condyle::hal {
namespace {

// Reads or writes the values of a message, in order. `Archive` is LinkReader or LinkWriter.

template <class Archive>
void exchange(Archive& archive, Exchanged<Archive, ReportField>& field) {
  archive.template integer<std::uint32_t>(field.offset_bits);
  archive.template integer<std::uint8_t>(field.width_bits);
  archive.enumeration(field.type, FieldType::floating_point);
  archive.enumeration(field.byte_order, ByteOrder::big);
  archive.finite(field.scale);
  archive.finite(field.offset);
  archive.optional(field.missing,
                   [&](auto& missing) { archive.template integer<std::int64_t>(missing); });
  archive.optional(field.range, [&](auto& range) {
    archive.template integer<std::int64_t>(range.lowest);
    archive.template integer<std::int64_t>(range.highest);
  });
}

template <class Archive>
void exchange(Archive& archive, Exchanged<Archive, CountingField>& counting) {
  exchange(archive, counting.field);
  archive.template integer<std::uint64_t>(counting.wraps_at);
}

template <class Archive>
void exchange(Archive& archive, Exchanged<Archive, Checksum>& checksum) {
  exchange(archive, checksum.field);
  archive.template integer<std::uint8_t>(checksum.width_bits);
  archive.template integer<std::uint32_t>(checksum.polynomial);
  archive.template integer<std::uint32_t>(checksum.initial);
  archive.boolean(checksum.reflects_input);
  archive.boolean(checksum.reflects_output);
  archive.template integer<std::uint32_t>(checksum.final_xor);
  archive.template integer<std::uint16_t>(checksum.first_byte);
  archive.template integer<std::uint16_t>(checksum.end_byte);
}

template <class Archive>
void exchange(Archive& archive, Exchanged<Archive, HelloMessage>& message) {
  archive.template integer<std::uint16_t>(message.version);
}

template <class Archive>
void exchange(Archive& archive, Exchanged<Archive, LayoutMessage>& message) {
  auto& layout = message.layout;
  const auto part = [&archive](auto& value) { exchange(archive, value); };
  archive.finite(layout.rate_Hz);
  archive.optional(layout.report_id, [&](auto& id) { archive.template integer<std::uint8_t>(id); });
  archive.template integer<std::uint16_t>(layout.minimum_size_bytes);
  archive.enumeration(layout.kind, SampleKind::pose);
  archive.list(layout.coordinates, [&](auto& coordinate) {
    part(coordinate.field);
    archive.template integer<std::uint8_t>(coordinate.index);
  });
  archive.optional(layout.device_time, part);
  archive.optional(layout.sequence, part);
  archive.optional(layout.checksum, part);
  archive.optional(layout.drive_N, part);
  archive.boolean(layout.restarts_on_reconnect);
  archive.list(layout.auxiliary, part);
}

// Called by visit_fields, visit_motion_fields, visit_learning_fields and visit_impedance_fields.
template <class Archive>
auto field_exchange(Archive& archive) {
  return [&archive](const char*, const char*, auto* values, std::size_t count, const char*,
                    Range range) {
    for (std::size_t i = 0; i < count; ++i) archive.within(values[i], range);
  };
}

template <class Archive>
void exchange(Archive& archive, Exchanged<Archive, PublishedParameters>& parameters) {
  archive.enumeration(parameters.motion.discretisation, Discretisation::backward);
  visit_fields(parameters, field_exchange(archive));
  archive.require(is_valid(parameters), RefusalReason::parameters_do_not_fit);
}

template <class Archive>
void exchange(Archive& archive, Exchanged<Archive, MotionEstimatorParameters>& parameters) {
  archive.enumeration(parameters.noise.adaptation, Adaptation::on);
  visit_motion_fields(parameters, field_exchange(archive));
  archive.require(is_valid(parameters), RefusalReason::parameters_do_not_fit);
}

template <class Archive>
void exchange(Archive& archive, Exchanged<Archive, ImpedanceParameters>& parameters) {
  archive.enumeration(parameters.delay, DelayModel::fitted);
  visit_impedance_fields(parameters, field_exchange(archive));
}

template <class Archive>
void exchange(Archive& archive, Exchanged<Archive, StartMessage>& message) {
  archive.enumeration(message.estimator, EstimatorChoice::recommended);
  archive.template integer<std::uint8_t>(message.lag);
  archive.require(message.lag <= kMaxLinkLag, RefusalReason::out_of_range);
  archive.template integer<std::uint8_t>(message.followed.point);
  archive.require(message.followed.point >= 1 && message.followed.point <= 3,
                  RefusalReason::out_of_range);
  archive.enumeration(message.followed.axis, Axis::z);
  archive.template integer<std::int64_t>(message.nominal_step_ns);
  archive.require(message.nominal_step_ns >= 0 && message.nominal_step_ns <= kMaxNominalStepNs,
                  RefusalReason::out_of_range);
  archive.boolean(message.expects_drive);
  archive.boolean(message.identifies);
  if (message.estimator == EstimatorChoice::published) {
    exchange(archive, message.published);
  } else {
    Exchanged<Archive, MotionEstimatorParameters>& motion = message.recommended;
    exchange(archive, motion);
    visit_learning_fields(message.recommended.learning, field_exchange(archive));
    if (message.identifies) exchange(archive, message.recommended.impedance);
  }
}

template <class Archive>
void exchange(Archive& archive, Exchanged<Archive, ReportMessage>& message) {
  archive.template integer<std::int64_t>(message.host_time_ns);
  archive.rest(message.bytes, kMaxReportSize);
}

template <class Archive>
void exchange(Archive&, Exchanged<Archive, FinishMessage>&) {}

template <class Archive>
void exchange(Archive&, Exchanged<Archive, AskHealthMessage>&) {}

template <class Archive>
void exchange(Archive&, Exchanged<Archive, ReconnectedMessage>&) {}

template <class Archive>
void exchange(Archive& archive, Exchanged<Archive, GreetingMessage>& message) {
  archive.template integer<std::uint16_t>(message.version);
  archive.text(message.software_version);
  archive.text(message.core_name);
  archive.template integer<std::uint8_t>(message.scalar_size);
  archive.require(message.scalar_size == 4 || message.scalar_size == 8,
                  RefusalReason::unknown_value);
  archive.boolean(message.identifies);
  archive.template integer<std::uint8_t>(message.longest_lag);
  archive.template integer<std::uint8_t>(message.most_kernels);
  archive.template integer<std::uint32_t>(message.boot_count);
  archive.enumeration(message.reset_cause, ResetCause::fault);
  archive.boolean(message.has_fault);
}

template <class Archive>
void exchange(Archive& archive, Exchanged<Archive, AcceptedMessage>& message) {
  archive.message_type(message.message);
}

template <class Archive>
void exchange(Archive& archive, Exchanged<Archive, RefusedMessage>& message) {
  archive.template integer<std::uint8_t>(message.message);
  archive.enumeration(message.refusal.reason, RefusalReason::too_many_kernels);
  archive.template integer<std::uint16_t>(message.refusal.index);
}

template <class Archive>
void exchange(Archive& archive, Exchanged<Archive, SampleStamp>& sample) {
  archive.template integer<std::uint64_t>(sample.sequence);
  archive.template integer<std::int64_t>(sample.time_ns);
  archive.boolean(sample.time_valid);
}

template <class Archive, class Quantity>
void exchange_quantity(Archive& archive, Quantity& quantity) {
  archive.number(quantity.value);
  archive.number(quantity.standard_deviation);
  archive.enumeration(quantity.provenance, Provenance::measured);
}

template <class Archive, class Estimate>
void exchange_published(Archive& archive, Estimate& estimate) {
  for (auto* quantity : {&estimate.position_m, &estimate.velocity_m_s, &estimate.force_N,
                         &estimate.friction_Ns_m, &estimate.mass_kg}) {
    exchange_quantity(archive, *quantity);
  }
  for (auto* number :
       {&estimate.innovation_m, &estimate.motion_nis, &estimate.friction_nis, &estimate.mass_nis}) {
    archive.number(*number);
  }
  archive.events(estimate.events);
  archive.enumeration(estimate.verdict, Verdict::diverged);
}

template <class Archive, class Axis>
void exchange_axis(Archive& archive, Axis& axis) {
  for (auto* quantity :
       {&axis.position_m, &axis.velocity_m_s, &axis.acceleration_m_s2, &axis.force_N}) {
    exchange_quantity(archive, *quantity);
  }
  for (auto* number :
       {&axis.measured_position_m, &axis.innovation_m, &axis.innovation_sd_m, &axis.noise_sd_m,
        &axis.jerk_density_m2_s5, &axis.velocity_learned, &axis.acceleration_learned}) {
    archive.number(*number);
  }
}

// 0 before the first estimate.
constexpr bool is_axis_count(int count) {
  return count == 0 || count == 1 || count == 3;
}

template <class Archive, class Estimate>
void exchange_recommended(Archive& archive, Estimate& estimate) {
  archive.boolean(estimate.is_ready);
  archive.template integer<std::int64_t>(estimate.time_ns);
  archive.boolean(estimate.time_valid);
  archive.template integer<std::uint8_t>(estimate.axis_count);
  archive.require(is_axis_count(estimate.axis_count), RefusalReason::out_of_range);
  for (int axis = 0; archive.ok() && axis < estimate.axis_count; ++axis) {
    exchange_axis(archive, estimate.axes[axis]);
  }
  archive.number(estimate.nis);
  archive.events(estimate.events);
}

template <class Archive, class Value>
void exchange_identified(Archive& archive, Value& value) {
  exchange_quantity(archive, value.quantity);
  for (auto* number : {&value.fitted, &value.fitted_sd, &value.sampling_sd, &value.needed_s}) {
    archive.number(*number);
  }
  archive.enumeration(value.limit, ImpedanceLimit::smoothing);
}

template <class Archive, class Estimate>
void exchange_conclusion(Archive& archive, Estimate& estimate) {
  for (auto* value : {&estimate.friction_Ns_m, &estimate.mass_kg, &estimate.stiffness_N_m,
                      &estimate.offset_N, &estimate.coulomb_N, &estimate.delay_s}) {
    exchange_identified(archive, *value);
  }
  auto& plain = estimate.plain;
  for (auto* number :
       {&plain.friction_Ns_m, &plain.mass_kg, &plain.stiffness_N_m, &plain.offset_N, &plain.delay_s,
        &estimate.used_s, &estimate.drive_noise_sd_N, &estimate.position_noise_sd_m,
        &estimate.drive_rms_N, &estimate.drive_variation_rms_N, &estimate.velocity_rms_m_s,
        &estimate.position_rms_m, &estimate.residual_ratio}) {
    archive.number(*number);
  }
}

template <class Archive>
void exchange(Archive& archive, Exchanged<Archive, HealthMessage>& message) {
  const auto count = [&archive](auto& number) { archive.template integer<std::uint64_t>(number); };
  auto& frames = message.frames;
  for (auto* number : {&frames.accepted, &frames.wrong_checksum, &frames.bad_stuffing,
                       &frames.too_short, &frames.too_long, &frames.lost, &frames.restarts}) {
    count(*number);
  }
  auto& reports = message.reports;
  for (auto* number :
       {&reports.received, &reports.lost, &reports.duplicated, &reports.sequence_restarts,
        &reports.unknown_losses, &reports.unknown_reconnections, &reports.clock_jumps,
        &reports.other_reports, &reports.too_short, &reports.wrong_checksum,
        &reports.counter_out_of_range, &reports.unusable_profile}) {
    count(*number);
  }
  auto& transport = message.transport;
  for (auto* number : {&transport.stalls, &transport.transfer_errors, &transport.oversized,
                       &transport.disconnections}) {
    count(*number);
  }
  for (auto* number :
       {&message.samples, &message.timeouts, &message.bad_reports, &message.disconnections}) {
    count(*number);
  }
  for (auto& number : message.events) count(number);
  count(message.uart_overruns);
  count(message.dropped_bytes);
  archive.template integer<std::uint32_t>(message.stack_used_bytes);
  archive.template integer<std::uint32_t>(message.stack_size_bytes);
  archive.template integer<std::int64_t>(message.uptime_ns);
}

template <class Archive>
void exchange(Archive& archive, Exchanged<Archive, FaultMessage>& message) {
  archive.enumeration(message.kind, FaultKind::assertion);
  for (auto* number : {&message.pc, &message.lr, &message.cfsr, &message.hfsr, &message.bfar}) {
    archive.template integer<std::uint32_t>(*number);
  }
}

template <class Archive, class Message>
void exchange_message(Archive& archive, Message& message) {
  if constexpr (Message::kType == MessageType::published_estimate) {
    exchange(archive, message.sample);
    exchange_published(archive, message.estimate);
  } else if constexpr (Message::kType == MessageType::recommended_estimate) {
    exchange(archive, message.sample);
    exchange_recommended(archive, message.estimate);
  } else if constexpr (Message::kType == MessageType::conclusion) {
    exchange_conclusion(archive, message.conclusion);
  } else {
    exchange(archive, message);
  }
}

}  // namespace

template <class Message>
std::optional<std::size_t> put(const Message& message, std::span<std::uint8_t> payload) {
  LinkWriter writer(payload);
  exchange_message(writer, message);
  return writer.finish();
}

template <class Message>
Refusal get(std::span<const std::uint8_t> payload, Message& message) {
  LinkReader reader(payload);
  exchange_message(reader, message);
  return reader.finish();
}

#define CONDYLE_MESSAGE(Message)                                                    \
  template std::optional<std::size_t> put(const Message&, std::span<std::uint8_t>); \
  template Refusal get(std::span<const std::uint8_t>, Message&)
CONDYLE_MESSAGE(HelloMessage);
CONDYLE_MESSAGE(LayoutMessage);
CONDYLE_MESSAGE(StartMessage);
CONDYLE_MESSAGE(ReportMessage);
CONDYLE_MESSAGE(FinishMessage);
CONDYLE_MESSAGE(AskHealthMessage);
CONDYLE_MESSAGE(ReconnectedMessage);
CONDYLE_MESSAGE(GreetingMessage);
CONDYLE_MESSAGE(AcceptedMessage);
CONDYLE_MESSAGE(RefusedMessage);
CONDYLE_MESSAGE(PublishedEstimateMessage<float>);
CONDYLE_MESSAGE(PublishedEstimateMessage<double>);
CONDYLE_MESSAGE(RecommendedEstimateMessage<float>);
CONDYLE_MESSAGE(RecommendedEstimateMessage<double>);
CONDYLE_MESSAGE(ConclusionMessage<float>);
CONDYLE_MESSAGE(ConclusionMessage<double>);
CONDYLE_MESSAGE(HealthMessage);
CONDYLE_MESSAGE(FaultMessage);
#undef CONDYLE_MESSAGE

}  // namespace condyle::hal
