// SPDX-License-Identifier: Apache-2.0
// The fields of an estimate: their names, order and units in files and messages.
#pragma once

#include <string>

#include "condyle/estimator/impedance/impedance_estimate.h"
#include "condyle/estimator/motion/recommended_estimate.h"

namespace condyle::host {

/// Name and unit of a quantity.
struct QuantityName {
  const char* name;
  const char* unit;

  /// "velocity_m_s", "velocity_sd_m_s", "velocity_provenance", "friction_limit".
  std::string value() const { return joined("_", unit); }
  std::string standard_deviation() const { return joined("_sd_", unit); }
  std::string provenance() const { return joined("_provenance", ""); }
  std::string limit() const { return joined("_limit", ""); }

 private:
  std::string joined(const char* middle, const char* end) const {
    return std::string(name) + middle + end;
  }
};

inline constexpr QuantityName kForceName{"force", "N"};
inline constexpr const char* kMeasuredPositionName = "measured_position_m";
inline constexpr const char* kInnovationName = "innovation_m";
inline constexpr const char* kNoiseName = "noise_sd_m";

/// Calls `visit(name, quantity)` for the motion along an axis. `Estimate`: AxisEstimate or another
/// type with these members.
template <class Estimate, class Visit>
void visit_motion(const Estimate& axis, Visit&& visit) {
  visit(QuantityName{"position", "m"}, axis.position_m);
  visit(QuantityName{"velocity", "m_s"}, axis.velocity_m_s);
  visit(QuantityName{"acceleration", "m_s2"}, axis.acceleration_m_s2);
}

/// The same for friction and mass, which may be Quantity or IdentifiedValue.
template <class Value, class Visit>
void visit_friction_and_mass(const Value& friction_Ns_m, const Value& mass_kg, Visit&& visit) {
  visit(QuantityName{"friction", "Ns_m"}, friction_Ns_m);
  visit(QuantityName{"mass", "kg"}, mass_kg);
}

/// The same for the other identified quantities.
template <class Scalar, class Visit>
void visit_identified_beside(const ImpedanceEstimate<Scalar>& impedance, Visit&& visit) {
  visit(QuantityName{"stiffness", "N_m"}, impedance.stiffness_N_m);
  visit(QuantityName{"offset", "N"}, impedance.offset_N);
  visit(QuantityName{"coulomb", "N"}, impedance.coulomb_N);
  visit(QuantityName{"drive_delay", "s"}, impedance.delay_s);
}

}  // namespace condyle::host
