// SPDX-License-Identifier: Apache-2.0
#include "output/estimates_file.h"

#include "hosted/files/number_text.h"
#include "output/estimate_columns.h"
#include "output/event_text.h"

namespace condyle::host {
namespace {

// Collects the names.
struct Header {
  const TableForm& form;
  std::string line = "time_s";

  template <class Name>
  void number(const Name& name, double) {
    (line += form.separator()) += name();
  }
  template <class Name>
  void provenance(const Name& name, Provenance) {
    (line += form.separator()) += name();
  }
  template <class Name>
  void limit(const Name& name, ImpedanceLimit) {
    (line += form.separator()) += name();
  }
  template <class Name>
  void events(const Name& name, EventSet) {
    (line += form.separator()) += name();
  }
};

// Appends the values of the columns.
struct RowText {
  const TableForm& form;
  std::string& line;

  template <class Name>
  void number(const Name&, double value) {
    const std::size_t begin = line.size();
    append_number(line += form.separator(), value);
    form.localise(line, begin);
  }
  template <class Name>
  void provenance(const Name&, Provenance provenance) {
    (line += form.separator()) += provenance_name(provenance);
  }
  template <class Name>
  void limit(const Name&, ImpedanceLimit limit) {
    (line += form.separator()) += limit_name(limit);
  }
  template <class Name>
  void events(const Name&, EventSet events) {
    append_events(line += form.separator(), events);
  }
};

}  // namespace

EstimatesFile::EstimatesFile(const std::string& path, int axis_count, bool has_impedance,
                             const TableForm& form, bool has_learning)
    : file_(path),
      axis_count_(axis_count),
      has_impedance_(has_impedance),
      has_learning_(has_learning),
      form_(form) {
  if (form.resample_Hz) resampled_.emplace(*form.resample_Hz);
  Header header{form_};
  EstimateColumns<Header>(header, form_).visit({}, axis_count, has_impedance, has_learning);
  file_.write(header.line + '\n');
}

void EstimatesFile::write_row(const EstimateRow& row) {
  if (resampled_) {
    resampled_->add(row, [this](const EstimateRow& instant) { write(instant); });
  } else {
    write(row);
  }
}

void EstimatesFile::write(const EstimateRow& row) {
  row_.clear();
  if (row.time_ns) append_time_s(row_, *row.time_ns);
  form_.localise(row_, 0);
  RowText fields{form_, row_};
  EstimateColumns<RowText>(fields, form_).visit(row, axis_count_, has_impedance_, has_learning_);
  row_ += '\n';
  file_.write(row_);
}

}  // namespace condyle::host
