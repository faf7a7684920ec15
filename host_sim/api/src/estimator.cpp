// SPDX-License-Identifier: Apache-2.0
// Estimators: sample by sample, and over whole arrays.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <memory>
#include <vector>

#include "call.h"
#include "estimator_run.h"
#include "hosted/files/number_text.h"
#include "options/analysis_options.h"
#include "output/estimate_columns.h"
#include "recordings/csv_units.h"
#include "recordings/replay_facebow.h"
#include "sample_gate.h"

using namespace condyle;
using namespace condyle::host;

struct condyle_estimator {
  explicit condyle_estimator(const RunChoice& chosen)
      : choice(chosen),
        gate(chosen.kind, chosen.has_drive, chosen.reading.faults),
        run(make_estimator_run(chosen)) {}

  RunChoice choice;
  SampleGate gate;
  std::unique_ptr<EstimatorRun> run;
  std::vector<std::string> columns;
  std::deque<EstimateRow> ready;  // at most one before the end
  std::optional<TimeNs> last_ns;
  bool is_new = true, has_ended = false;
};

namespace {

const TableForm kForm;  // as the file is without options
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Exact for times of a decimal text, as they are read back.
double time_in_s(TimeNs time_ns) {
  return static_cast<double>(time_ns) / 1e9;
}

// The columns that the file of these estimates has.
int axis_count_of(const RunChoice& choice) {
  if (choice.estimator.is_published()) return 0;
  return choice.kind == SampleKind::one_axis ? 1 : 3;
}
bool has_impedance(const RunChoice& choice) {
  return choice.has_drive && !choice.estimator.is_published();
}

struct ColumnNames {
  std::vector<std::string>& names;

  template <class Name, class Value>
  void number(const Name& name, Value) {
    names.push_back(name());
  }
  template <class Name, class Value>
  void provenance(const Name& name, Value) {
    names.push_back(name());
  }
  template <class Name, class Value>
  void limit(const Name& name, Value) {
    names.push_back(name());
  }
  template <class Name, class Value>
  void events(const Name& name, Value) {
    names.push_back(name());
  }
};

std::uint32_t bits_of(EventSet events) {
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < kEventCount; ++i) {
    if (events.has(static_cast<Event>(i))) bits |= std::uint32_t{1} << i;
  }
  return bits;
}

// Writes the values of a row, those that are wanted.
class ColumnValues {
 public:
  ColumnValues(double* const* columns, std::size_t row) : columns_(columns), row_(row) {}

  void write(double value) {
    if (double* const column = *columns_++) column[row_] = value;
  }
  template <class Name>
  void number(const Name&, double value) {
    write(value);
  }
  template <class Name>
  void provenance(const Name&, Provenance provenance) {
    write(static_cast<double>(provenance));
  }
  template <class Name>
  void limit(const Name&, ImpedanceLimit limit) {
    write(static_cast<double>(limit));
  }
  template <class Name>
  void events(const Name&, EventSet events) {
    if (double* const column = *columns_++) column[row_] = bits_of(events);
  }

 private:
  double* const* columns_;
  std::size_t row_;
};

condyle_value value_of(const Quantity<double>& quantity, ImpedanceLimit limit) {
  const double half = kNormalQuantile95 * quantity.standard_deviation;
  return {.value = quantity.value,
          .sd = quantity.standard_deviation,
          .low = quantity.value - half,
          .high = quantity.value + half,
          .provenance = static_cast<std::int32_t>(quantity.provenance),
          .limit = static_cast<std::int32_t>(limit)};
}

condyle_axis_estimate axis_of(const AxisEstimate<double>& axis) {
  return {.position_m = value_of(axis.position_m, ImpedanceLimit::none),
          .velocity_m_s = value_of(axis.velocity_m_s, ImpedanceLimit::none),
          .acceleration_m_s2 = value_of(axis.acceleration_m_s2, ImpedanceLimit::none),
          .noise_sd_m = axis.noise_sd_m};
}

condyle_estimate estimate_of(const EstimateRow& row, std::optional<TimeNs> last_ns) {
  condyle_estimate estimate{};
  estimate.time_ns = row.time_ns.value_or(CONDYLE_NO_TIME);
  estimate.time_s = row.time_ns ? time_in_s(*row.time_ns) : kNone;
  estimate.lag_s = row.time_ns && last_ns ? difference_s<double>(*last_ns, *row.time_ns) : kNone;
  estimate.events = bits_of(row.events);
  estimate.axis_count = row.axis_count == 3 ? 3 : 1;
  estimate.followed = axis_of(row.followed);
  estimate.followed.position_m = value_of(row.position_m, ImpedanceLimit::none);
  estimate.followed.velocity_m_s = value_of(row.velocity_m_s, ImpedanceLimit::none);
  for (int axis = 0; axis < 3; ++axis) {
    estimate.axes[axis] =
        row.axis_count == 0 && axis == 0 ? estimate.followed : axis_of(row.axes[axis]);
  }
  estimate.force_N = value_of(row.force_N, ImpedanceLimit::none);
  const bool identifies = row.has_impedance;
  const ImpedanceLimit none = ImpedanceLimit::none;
  estimate.friction_Ns_m =
      value_of(row.friction_Ns_m, identifies ? row.impedance.friction_Ns_m.limit : none);
  estimate.mass_kg = value_of(row.mass_kg, identifies ? row.impedance.mass_kg.limit : none);
  return estimate;
}

condyle_status push(condyle_estimator* estimator, const GivenSample& given,
                    std::size_t coordinate_count_given) {
  demand(estimator != nullptr, "estimator is NULL; give what condyle_estimator_create made");
  demand(given.position != nullptr, "position is NULL; give the coordinates of the sample");
  demand(coordinate_count_given == coordinate_count(estimator->choice.kind),
         "coordinate_count is not that of the estimator's kind; see condyle_coordinate_count");
  demand(!estimator->has_ended, "the estimator has finished; make a new one");
  const Sample sample = estimator->gate.next(given);
  estimator->is_new = false;
  estimator->ready.clear();
  if (sample.time_valid) estimator->last_ns = sample.time_ns;
  if (const EstimateRow* row = estimator->run->process(sample)) estimator->ready.push_back(*row);
  return CONDYLE_OK;
}

// Refuses times and places in other units, as far as the first samples show them.
void refuse_other_units(std::size_t count, const double* time_s, const double* position,
                        SampleKind kind) {
  const std::size_t looked_at = std::min(count, ReplayFacebow::kLookAhead);
  if (time_s != nullptr) {
    const std::string problem = doubt_of_times({time_s, time_s + looked_at}, 1).problem;
    if (!problem.empty()) throw InputError("time_s", problem, "give the times in seconds");
  }
  const std::size_t width = coordinate_count(kind);
  std::vector<std::vector<double>> columns(kind == SampleKind::pose ? 3 : width);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    for (std::size_t row = 0; row < looked_at; ++row) {
      columns[i].push_back(position[row * width + i]);
    }
  }
  const std::string problem = problem_of_places(columns);
  if (!problem.empty()) throw InputError("position", problem, "give the positions in metres");
}

void run_all(condyle_estimator& estimator, std::size_t count, const double* time_s,
             const std::int64_t* time_ns, const double* position, const double* drive_N,
             double* const* columns) {
  const std::size_t width = coordinate_count(estimator.choice.kind);
  const int axes = axis_count_of(estimator.choice);
  const bool has_drive = has_impedance(estimator.choice), learns = estimator.run->learns();
  std::size_t rows = 0;
  const auto write = [&](const EstimateRow& row) {
    ColumnValues values(columns, rows++);
    values.write(row.time_ns ? time_in_s(*row.time_ns) : kNone);
    EstimateColumns<ColumnValues>(values, kForm).visit(row, axes, has_drive, learns);
  };
  for (std::size_t i = 0; i < count; ++i) {
    GivenSample given;
    if (time_s != nullptr) {
      given.time_s = time_s[i];
    } else {
      given.time_ns = time_ns[i];
    }
    given.position = position + i * width;
    given.drive_N = drive_N != nullptr ? drive_N[i] : kNone;
    if (const EstimateRow* row = estimator.run->process(estimator.gate.next(given))) write(*row);
  }
  while (rows < count) {
    const EstimateRow* const row = estimator.run->drain();
    if (row == nullptr) throw std::logic_error("a sample has no estimate");
    write(*row);
  }
}

std::vector<TimeNs> known_times_ns(std::size_t count, const double* time_s,
                                   const std::int64_t* time_ns) {
  std::vector<TimeNs> known;
  for (std::size_t i = 0; i < count && known.size() < ReplayFacebow::kLookAhead; ++i) {
    if (time_s == nullptr && time_ns[i] != CONDYLE_NO_TIME) known.push_back(time_ns[i]);
    if (time_s != nullptr && std::abs(time_s[i]) <= kFurthestTime_s) {
      known.push_back(nanoseconds(time_s[i]));
    }
  }
  return known;
}

}  // namespace

condyle_status condyle_estimator_create(int kind, int has_drive, double step_s,
                                        const char* parameters_toml, const char* const* options,
                                        size_t option_count, condyle_estimator** estimator) {
  return guarded(__func__, [&] {
    demand(estimator != nullptr, "estimator is NULL; give the address of a pointer");
    *estimator = nullptr;
    demand(condyle_coordinate_count(kind) > 0, "kind is not one of condyle_kind");
    demand(step_s >= 0 && step_s <= kFurthestTime_s,
           "step_s is not a time; give seconds, or 0 if it is not known");
    RunChoice choice;
    choice.kind = static_cast<SampleKind>(kind);
    choice.has_drive = has_drive != 0;
    choice.step_s = step_s;
    if (parameters_toml != nullptr) choice.estimator.parameters_toml = parameters_toml;
    parse_options("condyle_estimator_create", options, option_count, [&](CommandLine line) {
      add_estimator_options(line, choice.estimator);
      add_followed_options(line, choice);
      add_faults_option(line, choice.reading);
      add_drive_options(line, choice.drive);
    });
    if (!choice.estimator.parameters.empty() && !choice.estimator.parameters_toml.empty()) {
      throw InputError("--parameters", "is given beside the text of parameters",
                       "give one of the two");
    }
    auto made = std::make_unique<condyle_estimator>(choice);
    made->columns = {"time_s"};
    ColumnNames names{made->columns};
    EstimateColumns<ColumnNames>(names, kForm)
        .visit({}, axis_count_of(choice), has_impedance(choice), made->run->learns());
    *estimator = made.release();
    return CONDYLE_OK;
  });
}

void condyle_estimator_free(condyle_estimator* estimator) {
  delete estimator;
}

condyle_status condyle_estimator_push(condyle_estimator* estimator, double time_s,
                                      const double* position, size_t coordinate_count,
                                      double drive_N) {
  return guarded(__func__, [&] {
    return push(estimator, {.time_s = time_s, .position = position, .drive_N = drive_N},
                coordinate_count);
  });
}

condyle_status condyle_estimator_push_ns(condyle_estimator* estimator, int64_t time_ns,
                                         const double* position, size_t coordinate_count,
                                         double drive_N) {
  return guarded(__func__, [&] {
    return push(estimator, {.time_ns = time_ns, .position = position, .drive_N = drive_N},
                coordinate_count);
  });
}

condyle_status condyle_estimator_finish(condyle_estimator* estimator) {
  return guarded(__func__, [&] {
    demand(estimator != nullptr, "estimator is NULL; give what condyle_estimator_create made");
    demand(!estimator->has_ended, "the estimator has finished; make a new one");
    estimator->has_ended = true;
    while (const EstimateRow* row = estimator->run->drain()) estimator->ready.push_back(*row);
    return CONDYLE_OK;
  });
}

condyle_status condyle_estimator_take(condyle_estimator* estimator, condyle_estimate* estimate,
                                      size_t size) {
  return guarded(__func__, [&] {
    demand(estimator != nullptr, "estimator is NULL; give what condyle_estimator_create made");
    demand(estimate != nullptr, "estimate is NULL; give the address of a condyle_estimate");
    demand(size == sizeof *estimate, "size is not that of this library's condyle_estimate");
    if (estimator->ready.empty()) return CONDYLE_NONE;
    *estimate = estimate_of(estimator->ready.front(), estimator->last_ns);
    estimator->ready.pop_front();
    return CONDYLE_OK;
  });
}

condyle_status condyle_estimator_conclude(condyle_estimator* estimator,
                                          condyle_value* friction_Ns_m, condyle_value* mass_kg) {
  return guarded(__func__, [&] {
    demand(estimator != nullptr, "estimator is NULL; give what condyle_estimator_create made");
    demand(friction_Ns_m != nullptr && mass_kg != nullptr,
           "friction_Ns_m or mass_kg is NULL; give the address of a condyle_value");
    const ImpedanceEstimate<double>* const conclusion = estimator->run->conclude();
    demand(conclusion != nullptr,
           "the estimator identifies neither friction nor mass; make it with a drive");
    *friction_Ns_m = value_of(conclusion->friction_Ns_m.quantity, conclusion->friction_Ns_m.limit);
    *mass_kg = value_of(conclusion->mass_kg.quantity, conclusion->mass_kg.limit);
    return CONDYLE_OK;
  });
}

size_t condyle_estimator_column_count(const condyle_estimator* estimator) {
  return estimator != nullptr ? estimator->columns.size() : 0;
}

const char* condyle_estimator_column_name(const condyle_estimator* estimator, size_t index) {
  return index < condyle_estimator_column_count(estimator) ? estimator->columns[index].c_str() : "";
}

condyle_status condyle_estimator_run(condyle_estimator* estimator, size_t count,
                                     const double* time_s, const int64_t* time_ns,
                                     const double* position, size_t coordinate_count,
                                     const double* drive_N, double* const* columns,
                                     size_t column_count) {
  return guarded(__func__, [&] {
    demand(estimator != nullptr, "estimator is NULL; give what condyle_estimator_create made");
    demand(estimator->is_new && !estimator->has_ended,
           "the estimator has been given samples; make a new one");
    demand((time_s != nullptr) != (time_ns != nullptr),
           "give either time_s or time_ns, and NULL for the other");
    demand(position != nullptr && columns != nullptr, "position or columns is NULL; give arrays");
    demand(coordinate_count == condyle::coordinate_count(estimator->choice.kind),
           "coordinate_count is not that of the estimator's kind; see condyle_coordinate_count");
    demand(column_count == estimator->columns.size(),
           "column_count is not condyle_estimator_column_count()");
    demand(!estimator->choice.has_drive || drive_N != nullptr,
           "drive_N is NULL, but the estimator was made with a drive");
    refuse_other_units(count, time_s, position, estimator->choice.kind);
    estimator->is_new = false;
    estimator->has_ended = true;
    run_all(*estimator, count, time_s, time_ns, position, drive_N, columns);
    return CONDYLE_OK;
  });
}

condyle_status condyle_median_step(size_t count, const double* time_s, const int64_t* time_ns,
                                   double* step_s) {
  return guarded(__func__, [&] {
    demand((time_s != nullptr) != (time_ns != nullptr),
           "give either time_s or time_ns, and NULL for the other");
    demand(step_s != nullptr, "step_s is NULL; give the address of a number");
    *step_s = seconds(median_step_ns(known_times_ns(count, time_s, time_ns)).value_or(0));
    return CONDYLE_OK;
  });
}
