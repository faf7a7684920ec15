// SPDX-License-Identifier: Apache-2.0
#include "output/estimates_file.h"

#include "hosted/files/number_text.h"
#include "output/estimate_columns.h"
#include "output/event_text.h"

namespace condyle::host {
namespace {

// Collects the names.
struct Header {
  std::string line = "time_s";

  template <class Name>
  void number(const Name& name, double) {
    (line += ',') += name();
  }
  template <class Name>
  void provenance(const Name& name, Provenance) {
    (line += ',') += name();
  }
  template <class Name>
  void limit(const Name& name, ImpedanceLimit) {
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
  void provenance(const Name&, Provenance provenance) {
    (line += ',') += provenance_name(provenance);
  }
  template <class Name>
  void limit(const Name&, ImpedanceLimit limit) {
    (line += ',') += limit_name(limit);
  }
  template <class Name>
  void events(const Name&, EventSet events) {
    append_events(line += ',', events);
  }
};

}  // namespace

EstimatesFile::EstimatesFile(const std::string& path, int axis_count, bool has_impedance)
    : file_(path), axis_count_(axis_count), has_impedance_(has_impedance) {
  Header header;
  EstimateColumns<Header>(header).visit({}, axis_count, has_impedance);
  file_.write(header.line + '\n');
}

void EstimatesFile::write_row(const EstimateRow& row) {
  row_.clear();
  if (row.time_ns) append_time_s(row_, *row.time_ns);
  RowText fields{row_};
  EstimateColumns<RowText>(fields).visit(row, axis_count_, has_impedance_);
  row_ += '\n';
  file_.write(row_);
}

}  // namespace condyle::host
