// SPDX-License-Identifier: Apache-2.0
#include "output/estimates_file.h"

#include <array>

#include "hosted/estimates/estimate_fields.h"
#include "hosted/files/number_text.h"
#include "output/event_text.h"

namespace condyle::host {
namespace {

// Columns after the time, with the values of `row`: `number(name, value)` or `word(name, text)`.
// `name()` makes the name, which a row does not need.
template <class Visitor>
class Columns {
 public:
  explicit Columns(Visitor& visitor) : visitor_(visitor) {}

  void visit(const EstimateRow& row, int axis_count, bool has_impedance, bool has_learning) {
    visit_leading(row);
    visitor_.events([] { return "events"; }, row.events);
    if (axis_count > 0) visit_followed(row);
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

  void value(const Named& of, const std::string& prefix = "") {
    visitor_.number([&] { return prefix + of.name.value(); }, of.quantity->value);
  }
  void deviation(const Named& of, const std::string& prefix = "") {
    visitor_.number([&] { return prefix + of.name.standard_deviation(); },
                    of.quantity->standard_deviation);
  }
  void provenance(const Named& of, const std::string& prefix = "") {
    visitor_.word([&] { return prefix + of.name.provenance(); },
                  provenance_name(of.quantity->provenance));
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

  void visit_learning(const std::string& prefix, const AxisEstimate<double>& axis) {
    visitor_.number([&] { return prefix + "velocity_learned"; }, axis.velocity_learned);
    visitor_.number([&] { return prefix + "acceleration_learned"; }, axis.acceleration_learned);
  }

  void visit_impedance(const ImpedanceEstimate<double>& impedance) {
    visit_friction_and_mass(impedance.friction_Ns_m, impedance.mass_kg,
                            [&](QuantityName name, const IdentifiedValue<double>& identified) {
                              visitor_.word([&] { return name.limit(); },
                                            limit_name(identified.limit));
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

// Collects the names.
struct Header {
  std::string line = "time_s";

  template <class Name>
  void number(const Name& name, double) {
    (line += ',') += name();
  }
  template <class Name>
  void word(const Name& name, const char*) {
    (line += ',') += name();
  }
  template <class Name>
  void events(const Name& name, EventSet) {
    (line += ',') += name();
  }
};

// Appends the values of the columns.
struct RowText {
  std::string& line;

  template <class Name>
  void number(const Name&, double value) {
    append_number(line += ',', value);
  }
  template <class Name>
  void word(const Name&, const char* text) {
    (line += ',') += text;
  }
  template <class Name>
  void events(const Name&, EventSet events) {
    append_events(line += ',', events);
  }
};

}  // namespace

EstimatesFile::EstimatesFile(const std::string& path, int axis_count, bool has_impedance,
                             bool has_learning)
    : file_(path),
      axis_count_(axis_count),
      has_impedance_(has_impedance),
      has_learning_(has_learning) {
  Header header;
  Columns<Header>(header).visit({}, axis_count, has_impedance, has_learning);
  file_.write(header.line + '\n');
}

void EstimatesFile::write_row(const EstimateRow& row) {
  row_.clear();
  if (row.time_ns) append_time_s(row_, *row.time_ns);
  RowText fields{row_};
  Columns<RowText>(fields).visit(row, axis_count_, has_impedance_, has_learning_);
  row_ += '\n';
  file_.write(row_);
}

}  // namespace condyle::host
