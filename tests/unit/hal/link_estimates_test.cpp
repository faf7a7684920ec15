// SPDX-License-Identifier: Apache-2.0
#include <bit>

#include "support/rapidcheck_gtest.h"
#include "unit/hal/link_round_trip.h"

namespace condyle::hal {
namespace {

using namespace testing_support;

// Bits that no arithmetic would leave alone: NaNs with a payload, infinities, -0, subnormals.
template <class Scalar>
class AnyBits {
 public:
  using Bits = std::conditional_t<sizeof(Scalar) == 4, std::uint32_t, std::uint64_t>;

  void set(Scalar& number) { number = std::bit_cast<Scalar>(*rc::gen::arbitrary<Bits>()); }
  void set(Quantity<Scalar>& quantity) {
    set(quantity.value);
    set(quantity.standard_deviation);
    quantity.provenance = static_cast<Provenance>(*rc::gen::inRange(0, 4));
  }
  static EventSet events() {
    EventSet events;
    const auto bits = *rc::gen::arbitrary<std::uint32_t>();
    for (std::size_t i = 0; i < kEventCount; ++i) {
      events.add(static_cast<Event>(i), (bits >> i & 1U) != 0);
    }
    return events;
  }
  static SampleStamp stamp() {
    return {*rc::gen::arbitrary<std::uint64_t>(), *rc::gen::arbitrary<TimeNs>(),
            *rc::gen::arbitrary<bool>()};
  }
  static bool are_same(const Scalar& a, const Scalar& b) {
    return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
  }
  static bool are_same(const Quantity<Scalar>& a, const Quantity<Scalar>& b) {
    return are_same(a.value, b.value) && are_same(a.standard_deviation, b.standard_deviation) &&
           a.provenance == b.provenance;
  }
  static bool are_same(EventSet a, EventSet b) {
    for (std::size_t i = 0; i < kEventCount; ++i) {
      if (a.has(static_cast<Event>(i)) != b.has(static_cast<Event>(i))) return false;
    }
    return true;
  }
  static bool are_same(const SampleStamp& a, const SampleStamp& b) {
    return a.sequence == b.sequence && a.time_ns == b.time_ns && a.time_valid == b.time_valid;
  }
};

template <class Scalar>
void check_published() {
  using Any = AnyBits<Scalar>;
  Any any;
  PublishedEstimateMessage<Scalar> message;
  message.sample = Any::stamp();
  auto& e = message.estimate;
  for (auto* q : {&e.position_m, &e.velocity_m_s, &e.force_N, &e.friction_Ns_m, &e.mass_kg}) {
    any.set(*q);
  }
  for (auto* n : {&e.innovation_m, &e.motion_nis, &e.friction_nis, &e.mass_nis}) any.set(*n);
  e.events = Any::events();
  e.verdict = static_cast<Verdict>(*rc::gen::inRange(0, 3));
  const auto received = sent(message);
  const auto& r = received.estimate;
  RC_ASSERT(Any::are_same(message.sample, received.sample));
  RC_ASSERT(Any::are_same(e.position_m, r.position_m));
  RC_ASSERT(Any::are_same(e.velocity_m_s, r.velocity_m_s));
  RC_ASSERT(Any::are_same(e.force_N, r.force_N));
  RC_ASSERT(Any::are_same(e.friction_Ns_m, r.friction_Ns_m));
  RC_ASSERT(Any::are_same(e.mass_kg, r.mass_kg));
  RC_ASSERT(Any::are_same(e.innovation_m, r.innovation_m));
  RC_ASSERT(Any::are_same(e.motion_nis, r.motion_nis));
  RC_ASSERT(Any::are_same(e.friction_nis, r.friction_nis));
  RC_ASSERT(Any::are_same(e.mass_nis, r.mass_nis));
  RC_ASSERT(Any::are_same(e.events, r.events));
  RC_ASSERT(e.verdict == r.verdict);
}

template <class Scalar>
void check_recommended() {
  using Any = AnyBits<Scalar>;
  Any any;
  RecommendedEstimateMessage<Scalar> message;
  message.sample = Any::stamp();
  auto& e = message.estimate;
  e.is_ready = *rc::gen::arbitrary<bool>();
  e.time_ns = *rc::gen::arbitrary<TimeNs>();
  e.time_valid = *rc::gen::arbitrary<bool>();
  e.axis_count = *rc::gen::element(0, 1, 3);
  for (int i = 0; i < e.axis_count; ++i) {
    auto& a = e.axes[i];
    for (auto* q : {&a.position_m, &a.velocity_m_s, &a.acceleration_m_s2, &a.force_N}) any.set(*q);
    for (auto* n : {&a.measured_position_m, &a.innovation_m, &a.innovation_sd_m, &a.noise_sd_m,
                    &a.jerk_density_m2_s5, &a.velocity_learned, &a.acceleration_learned}) {
      any.set(*n);
    }
  }
  any.set(e.nis);
  e.events = Any::events();
  const auto received = sent(message);
  const auto& r = received.estimate;
  RC_ASSERT(Any::are_same(message.sample, received.sample));
  RC_ASSERT(e.is_ready == r.is_ready);
  RC_ASSERT(e.time_ns == r.time_ns);
  RC_ASSERT(e.time_valid == r.time_valid);
  RC_ASSERT(e.axis_count == r.axis_count);
  for (int i = 0; i < e.axis_count; ++i) {
    const auto &a = e.axes[i], &b = r.axes[i];
    RC_ASSERT(Any::are_same(a.position_m, b.position_m));
    RC_ASSERT(Any::are_same(a.velocity_m_s, b.velocity_m_s));
    RC_ASSERT(Any::are_same(a.acceleration_m_s2, b.acceleration_m_s2));
    RC_ASSERT(Any::are_same(a.force_N, b.force_N));
    RC_ASSERT(Any::are_same(a.measured_position_m, b.measured_position_m));
    RC_ASSERT(Any::are_same(a.innovation_m, b.innovation_m));
    RC_ASSERT(Any::are_same(a.innovation_sd_m, b.innovation_sd_m));
    RC_ASSERT(Any::are_same(a.noise_sd_m, b.noise_sd_m));
    RC_ASSERT(Any::are_same(a.jerk_density_m2_s5, b.jerk_density_m2_s5));
  }
  RC_ASSERT(Any::are_same(e.nis, r.nis));
  RC_ASSERT(Any::are_same(e.events, r.events));
}

RC_GTEST_PROP(LinkMessages, PublishedEstimatesArriveBitByBit, ()) {
  check_published<float>();
  check_published<double>();
}
RC_GTEST_PROP(LinkMessages, RecommendedEstimatesArriveBitByBit, ()) {
  check_recommended<float>();
  check_recommended<double>();
}

template <class Scalar>
void check_conclusion() {
  using Any = AnyBits<Scalar>;
  Any any;
  using Identified = ImpedanceEstimate<Scalar>;
  using Value = IdentifiedValue<Scalar>;
  constexpr Value Identified::*kValues[] = {&Identified::friction_Ns_m, &Identified::mass_kg,
                                            &Identified::stiffness_N_m, &Identified::offset_N,
                                            &Identified::coulomb_N,     &Identified::delay_s};
  constexpr Scalar Value::*kParts[] = {&Value::fitted, &Value::fitted_sd, &Value::sampling_sd,
                                       &Value::needed_s};
  constexpr Scalar Identified::*kNumbers[] = {&Identified::used_s,
                                              &Identified::drive_noise_sd_N,
                                              &Identified::position_noise_sd_m,
                                              &Identified::drive_rms_N,
                                              &Identified::drive_variation_rms_N,
                                              &Identified::velocity_rms_m_s,
                                              &Identified::position_rms_m,
                                              &Identified::residual_ratio};
  ConclusionMessage<Scalar> message;
  Identified& said = message.conclusion;
  for (const auto value : kValues) {
    any.set((said.*value).quantity);
    for (const auto part : kParts) any.set(said.*value.*part);
    (said.*value).limit =
        static_cast<ImpedanceLimit>(*rc::gen::inRange(0, static_cast<int>(kImpedanceLimits)));
  }
  for (const auto number : kNumbers) any.set(said.*number);
  any.set(said.plain.mass_kg);
  const Identified heard = sent(message).conclusion;
  for (const auto value : kValues) {
    RC_ASSERT(Any::are_same((said.*value).quantity, (heard.*value).quantity));
    for (const auto part : kParts) RC_ASSERT(Any::are_same(said.*value.*part, heard.*value.*part));
    RC_ASSERT((said.*value).limit == (heard.*value).limit);
  }
  for (const auto number : kNumbers) RC_ASSERT(Any::are_same(said.*number, heard.*number));
  RC_ASSERT(Any::are_same(said.plain.mass_kg, heard.plain.mass_kg));
}

RC_GTEST_PROP(LinkMessages, ConclusionsArriveBitByBit, ()) {
  check_conclusion<float>();
  check_conclusion<double>();
}

TEST(LinkMessages, RefusesEstimatesThatAreNone) {
  RecommendedEstimateMessage<float> message;
  for (const int axis_count : {2, 4}) {
    Bytes payload = written(message);
    payload[27] = static_cast<std::uint8_t>(axis_count);
    EXPECT_EQ(get(payload, message).reason, RefusalReason::out_of_range) << axis_count;
  }
  Bytes payload = written(RecommendedEstimateMessage<double>{});
  payload.back() = 0x80;  // an event that there is not
  RecommendedEstimateMessage<double> received;
  EXPECT_EQ(get(payload, received).reason, RefusalReason::unknown_value);
  PublishedEstimateMessage<double> published;
  published.estimate.mass_kg.provenance = static_cast<Provenance>(4);
  expect_refused(published, RefusalReason::unknown_value);
  EXPECT_NE(get(written(PublishedEstimateMessage<float>{}), published).reason, RefusalReason::none)
      << "of the other scalar";
}

}  // namespace
}  // namespace condyle::hal
