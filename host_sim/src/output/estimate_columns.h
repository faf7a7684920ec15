// SPDX-License-Identifier: Apache-2.0
// The columns of the estimates' file: for the file itself, and for other programs.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "estimation/estimate_row.h"
#include "hosted/estimates/estimate_fields.h"
#include "output/table_form.h"

namespace condyle::host {

/// Name and factor of a quantity whose unit may contain a length.
struct ShownQuantity {
  QuantityName name;
  double factor = 1;
};

/// `name` as a table of this form shows it.
inline ShownQuantity shown(const QuantityName& name, const TableForm& form) {
  constexpr struct {
    std::string_view in_m;
    const char* in_mm;
  } kLengths[] = {{"m", "mm"}, {"m_s", "mm_s"}, {"m_s2", "mm_s2"}};
  for (const auto& length : kLengths) {
    if (form.is_in_mm && length.in_m == name.unit) {
      return {{name.name, length.in_mm}, form.lengths_per_m()};
    }
  }
  return {name};
}

/// Columns after the time, with the values of a row. A visitor has `number(name, value)`,
/// `provenance(name, provenance)`, `limit(name, limit)` and `events(name, events)`. `name()` makes
/// the name, which a row does not need.
template <class Visitor>
class EstimateColumns {
 public:
  EstimateColumns(Visitor& visitor, const TableForm& form) : visitor_(visitor), form_(form) {}

  /// `axis_count`: 1 or 3; 0 for the published cascade.
  void visit(const EstimateRow& row, int axis_count, bool has_impedance,
             bool has_learning = false) {
    const bool is_published = axis_count == 0;
    visit_measured(row.measured_position_m);
    visit_leading(row, is_published, is_published || has_impedance);
    visitor_.events([] { return "events"; }, row.events);
    if (!is_published) visit_followed(row);
    for (int axis = 0; axis_count == 3 && axis < 3; ++axis) {
      visit_axis("xyz"[axis], row.axes[axis]);
    }
    if (has_impedance) visit_impedance(row.impedance);
    if (!has_learning) return;
    visit_learning("", row.followed);
    for (int axis = 0; axis_count == 3 && axis < 3; ++axis) {
      visit_learning(std::string{"xyz"[axis], '_'}, row.axes[axis]);
    }
  }

 private:
  struct Named {
    QuantityName name;
    const Quantity<double>* quantity;
  };
  using List = std::array<Named, 3>;

  void length(const char* name, double value_m, const std::string& prefix = "") {
    const ShownQuantity as = shown({name, "m"}, form_);
    visitor_.number([&] { return prefix + as.name.value(); }, as.factor * value_m);
  }
  // What belongs to one sample: there is none between samples.
  void visit_measured(double position_m, const std::string& prefix = "") {
    if (!form_.resample_Hz) length("measured_position", position_m, prefix);
  }
  void value(const Named& of, const std::string& prefix = "") {
    const ShownQuantity as = shown(of.name, form_);
    visitor_.number([&] { return prefix + as.name.value(); }, as.factor * of.quantity->value);
  }
  void deviation(const Named& of, const std::string& prefix = "") {
    const ShownQuantity as = shown(of.name, form_);
    visitor_.number([&] { return prefix + as.name.standard_deviation(); },
                    as.factor * of.quantity->standard_deviation);
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

  void visit_leading(const EstimateRow& row, bool is_published, bool has_friction_and_mass) {
    // Position and velocity of any estimator; the acceleration comes later.
    const List motion = motion_of(row.followed);
    Named leading[] = {{motion[0].name, &row.position_m},
                       {motion[1].name, &row.velocity_m_s},
                       {kForceName, &row.force_N},
                       {},
                       {}};
    std::size_t count = 3;
    if (has_friction_and_mass) {
      visit_friction_and_mass(row.friction_Ns_m, row.mass_kg,
                              [&](QuantityName name, const Quantity<double>& quantity) {
                                leading[count++] = {name, &quantity};
                              });
    }
    for (std::size_t i = 0; i < count; ++i) value(leading[i]);
    for (std::size_t i = 0; i < count; ++i) deviation(leading[i]);
    if (!form_.resample_Hz) visitor_.number([] { return "motion_nis"; }, row.motion_nis);
    if (is_published) {
      visitor_.number([] { return "friction_nis"; }, row.friction_nis);
      visitor_.number([] { return "mass_nis"; }, row.mass_nis);
    }
    for (std::size_t i = 2; i < count; ++i) provenance(leading[i]);
  }

  void visit_followed(const EstimateRow& row) {
    List motion = motion_of(row.followed);
    motion[0].quantity = &row.position_m;
    motion[1].quantity = &row.velocity_m_s;
    for (const Named& of : motion) provenance(of);
    value(motion[2]);
    deviation(motion[2]);
    if (!form_.resample_Hz) {
      length("innovation", row.followed.innovation_m);
      length("innovation_sd", row.followed.innovation_sd_m);
    }
    length("noise_sd", row.followed.noise_sd_m);
    visitor_.number(
        [&] { return form_.is_in_mm ? "jerk_density_mm2_s5" : "jerk_density_m2_s5"; },
        form_.lengths_per_m() * form_.lengths_per_m() * row.followed.jerk_density_m2_s5);
  }

  void visit_axis(char letter, const AxisEstimate<double>& axis) {
    const std::string prefix = {letter, '_'};
    const List motion = motion_of(axis);
    visit_measured(axis.measured_position_m, prefix);
    for (const Named& of : motion) value(of, prefix);
    for (const Named& of : motion) deviation(of, prefix);
    for (const Named& of : motion) provenance(of, prefix);
  }

  void visit_learning(const std::string& prefix, const AxisEstimate<double>& axis) {
    visitor_.number([&] { return prefix + "velocity_learned"; }, axis.velocity_learned);
    visitor_.number([&] { return prefix + "acceleration_learned"; }, axis.acceleration_learned);
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
  const TableForm& form_;
};

}  // namespace condyle::host
