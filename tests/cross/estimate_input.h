// SPDX-License-Identifier: Apache-2.0
// What estimate_bytes reads: the published cascade's parameters and the samples of a recording, as
// numbers of byte_stream.h one after the other, which any machine can read without libraries.
//
//   parameters   visit_fields' doubles; discretisation uint8; nominal step (ns) int64
//   each sample  time (ns) int64; kind, time_valid, position_valid uint8; the kind's coordinates
#pragma once

#include "byte_stream.h"
#include "condyle/estimator/published/parameters.h"
#include "condyle/estimator/sample.h"

namespace condyle::cross {

struct EstimateHeader {
  PublishedParameters parameters;
  TimeNs nominal_step_ns = 0;
};

template <class Sink>
void put_header(EstimateHeader header, Sink&& sink) {
  visit_fields(header.parameters, [&](const char*, const char*, const double* values,
                                      std::size_t count, const char*, Range) {
    for (std::size_t i = 0; i < count; ++i) put_number(values[i], sink);
  });
  put_number(static_cast<std::uint8_t>(header.parameters.motion.discretisation), sink);
  put_number(static_cast<std::uint64_t>(header.nominal_step_ns), sink);
}

template <class Source>
EstimateHeader take_header(Source&& source) {
  EstimateHeader header;
  visit_fields(header.parameters, [&](const char*, const char*, double* values, std::size_t count,
                                      const char*, Range) {
    for (std::size_t i = 0; i < count; ++i) values[i] = take_number<double>(source);
  });
  header.parameters.motion.discretisation =
      static_cast<Discretisation>(take_number<std::uint8_t>(source));
  header.nominal_step_ns = take_number<TimeNs>(source);
  return header;
}

template <class Sink>
void put_sample(const Sample& sample, Sink&& sink) {
  put_number(static_cast<std::uint64_t>(sample.time_ns), sink);
  put_number(static_cast<std::uint8_t>(sample.kind), sink);
  put_number(static_cast<std::uint8_t>(sample.time_valid), sink);
  put_number(static_cast<std::uint8_t>(sample.position_valid), sink);
  for (std::size_t i = 0; i < coordinate_count(sample.kind); ++i) {
    put_number(sample.coordinates[i], sink);
  }
}

template <class Source>
Sample take_sample(Source&& source) {
  Sample sample;
  sample.time_ns = take_number<TimeNs>(source);
  sample.kind = static_cast<SampleKind>(take_number<std::uint8_t>(source));
  sample.time_valid = take_number<std::uint8_t>(source) != 0;
  sample.position_valid = take_number<std::uint8_t>(source) != 0;
  for (std::size_t i = 0; i < coordinate_count(sample.kind); ++i) {
    sample.coordinates[i] = take_number<double>(source);
  }
  return sample;
}

}  // namespace condyle::cross
