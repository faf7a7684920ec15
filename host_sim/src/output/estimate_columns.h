// SPDX-License-Identifier: Apache-2.0
// The columns of the estimates' file: for the file itself, and for other programs.
#pragma once

#include <array>
#include <string>

#include "estimation/estimate_row.h"
#include "hosted/estimates/estimate_fields.h"

namespace condyle::host {

/// Columns after the time, with the values of a row. A visitor has `number(name, value)`,
/// `provenance(name, provenance)`, `limit(name, limit)` and `events(name, events)`. `name()` makes
/// the name, which a row does not need.
template <class Visitor>
class EstimateColumns {
 public:
  explicit EstimateColumns(Visitor& visitor) : visitor_(visitor) {}

  /// `axis_count`: 1 or 3; 0 for the published cascade.
  void visit(const EstimateRow& row, int axis_count, bool has_impedance) {
    visit_leading(row);
    visitor_.events([] { return "events"; }, row.events);
    if (axis_count > 0) visit_followed(row);
    for (int axis = 0; axis_count == 3 && axis < 3; ++axis) {
      visit_axis("xyz"[axis], row.axes[axis]);
    }
    if (has_impedance) visit_impedance(row.impedance);
  }

 private:
  struct Named {
    QuantityName name;
    const Quantity<double>* quantity;
  };
  using List = std::array<Named, 3>;

  void value(const Named& of, const std::string& prefix = "") {
    visitor_.number([&] { return prefix + of.name.value(); }, of.quantity->value);
  }
  void deviation(const Named& of, const std::string& prefix = "") {
    visitor_.number([&] { return prefix + of.name.standard_deviation(); },
                    of.quantity->standard_deviation);
  }
  void provenance(const Named& of, const std::string& prefix = "") {
    visitor_.provenance([&] { return prefix + of.name.provenance(); }, of.quantity->provenance);
  }
  static List motion_of(const AxisEstimate<double>& axis) {
    List list{};
    std::size_t count = 0;
    visit_motion(axis, [&](QuantityName name, const Quantity<double>& quantity) {
      list[count++] = {name, &quantity};
    });
    return list;
  }

  void visit_leading(const EstimateRow& row) {
    // Position and velocity of any estimator; the acceleration comes later.
    const List motion = motion_of(row.followed);
    Named leading[] = {{motion[0].name, &row.position_m},
                       {motion[1].name, &row.velocity_m_s},
                       {kForceName, &row.force_N},
                       {},
                       {}};
    std::size_t count = 3;
    visit_friction_and_mass(row.friction_Ns_m, row.mass_kg,
                            [&](QuantityName name, const Quantity<double>& quantity) {
                              leading[count++] = {name, &quantity};
                            });
    for (const Named& of : leading) value(of);
    for (const Named& of : leading) deviation(of);
    visitor_.number([] { return "motion_nis"; }, row.motion_nis);
    visitor_.number([] { return "friction_nis"; }, row.friction_nis);
    visitor_.number([] { return "mass_nis"; }, row.mass_nis);
    for (std::size_t i = 2; i < count; ++i) provenance(leading[i]);
  }

  void visit_followed(const EstimateRow& row) {
    List motion = motion_of(row.followed);
    motion[0].quantity = &row.position_m;
    motion[1].quantity = &row.velocity_m_s;
    for (const Named& of : motion) provenance(of);
    value(motion[2]);
    deviation(motion[2]);
    visitor_.number([] { return kInnovationName; }, row.followed.innovation_m);
    visitor_.number([] { return "innovation_sd_m"; }, row.followed.innovation_sd_m);
    visitor_.number([] { return kNoiseName; }, row.followed.noise_sd_m);
    visitor_.number([] { return "jerk_density_m2_s5"; }, row.followed.jerk_density_m2_s5);
  }

  void visit_axis(char letter, const AxisEstimate<double>& axis) {
    const std::string prefix = {letter, '_'};
    const List motion = motion_of(axis);
    for (const Named& of : motion) value(of, prefix);
    for (const Named& of : motion) deviation(of, prefix);
    for (const Named& of : motion) provenance(of, prefix);
  }

  void visit_impedance(const ImpedanceEstimate<double>& impedance) {
    visit_friction_and_mass(impedance.friction_Ns_m, impedance.mass_kg,
                            [&](QuantityName name, const IdentifiedValue<double>& identified) {
                              visitor_.limit([&] { return name.limit(); }, identified.limit);
                            });
    visit_identified_beside(impedance,
                            [&](QuantityName name, const IdentifiedValue<double>& identified) {
                              const Named of{name, &identified.quantity};
                              value(of);
                              deviation(of);
                              provenance(of);
                            });
  }

  Visitor& visitor_;
};

}  // namespace condyle::host
