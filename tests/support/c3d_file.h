// SPDX-License-Identifier: Apache-2.0
// Writes C3D files of any processor, with integers or floating-point numbers.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "recordings/c3d_parameters.h"

namespace condyle::testing_support {

using host::C3dProcessor;

/// A point of a frame, in the file's unit.
struct C3dPlace {
  double x = 0, y = 0, z = 0;
  bool is_missing = false;
};

/// A C3D file to be written.
struct C3dContent {
  C3dProcessor processor = C3dProcessor::intel;
  bool has_floats = true;
  double scale = 0.05, rate_Hz = 100;
  std::string unit = "mm";
  std::vector<std::string> names, channels, channel_units;
  std::vector<double> channel_scale, channel_offset;
  std::size_t samples = 1;                         ///< of each channel in a frame
  std::vector<std::vector<C3dPlace>> frames;       ///< of each frame its points
  std::vector<std::vector<double>> analog;         ///< of each frame its stored numbers
  bool states_trial = false, states_long = false;  ///< the number of frames in parameters
  bool has_parameters = true;

  std::string bytes() const;

 private:
  struct Writer;
};

struct C3dContent::Writer {
  const C3dContent& file;
  std::string bytes;

  void byte(int value) { bytes += static_cast<char>(value); }
  void word(std::int64_t value) {
    const auto bits = static_cast<std::uint16_t>(value);
    const bool big = file.processor == C3dProcessor::mips;
    byte(big ? bits >> 8U : bits & 0xffU);
    byte(big ? bits & 0xffU : bits >> 8U);
  }
  // The F format of a VAX has its exponent two higher, and the word with it first.
  void real(double value) {
    const bool is_dec = file.processor == C3dProcessor::dec;
    const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(is_dec ? 4 * value : value));
    const bool high_first = file.processor != C3dProcessor::intel;
    word(high_first ? bits >> 16U : bits & 0xffffU);
    word(high_first ? bits & 0xffffU : bits >> 16U);
  }
  void number(double value) {
    if (file.has_floats) {
      real(value);
    } else {
      word(std::llround(value));
    }
  }
  void fill_block() { bytes.resize((bytes.size() + 511) / 512 * 512, '\0'); }

  void start(int group, const std::string& name, std::size_t body) {
    byte(static_cast<int>(name.size()));
    byte(group);
    bytes += name;
    word(static_cast<std::int64_t>(body) + 2);
  }
  void group(int number, const std::string& name) {
    start(-number, name, 1);
    byte(0);
  }
  // Its type and shape follow, then `size` bytes of values and no description.
  void parameter(int group, const std::string& name, int type, const std::vector<int>& shape,
                 std::size_t size) {
    start(group, name, 2 + shape.size() + size + 1);
    byte(type);
    byte(static_cast<int>(shape.size()));
    for (const int length : shape) byte(length);
  }
  void integer(int group, const std::string& name, const std::vector<std::int64_t>& values) {
    const bool is_list = values.size() != 1;
    parameter(group, name, 2,
              is_list ? std::vector<int>{static_cast<int>(values.size())} : std::vector<int>{},
              2 * values.size());
    for (const std::int64_t value : values) word(value);
    byte(0);
  }
  void reals(int group, const std::string& name, const std::vector<double>& values) {
    parameter(group, name, 4, {static_cast<int>(values.size())}, 4 * values.size());
    for (const double value : values) real(value);
    byte(0);
  }
  void texts(int group, const std::string& name, const std::vector<std::string>& values) {
    std::size_t length = 16;
    for (const std::string& value : values) length = std::max(length, value.size());
    parameter(group, name, -1, {static_cast<int>(length), static_cast<int>(values.size())},
              length * values.size());
    for (std::string value : values) {
      value.resize(length, ' ');
      bytes += value;
    }
    byte(0);
  }
};

inline std::string C3dContent::bytes() const {
  const auto points = static_cast<std::int64_t>(names.size()),
             count = static_cast<std::int64_t>(frames.size());
  const double signed_scale = has_floats ? -scale : scale;
  Writer parameters{*this, {}};
  for (const int value : {1, 0x50, 0, static_cast<int>(processor)}) parameters.byte(value);
  if (has_parameters) {
    parameters.group(1, "POINT");
    parameters.integer(1, "USED", {points});
    parameters.integer(1, "FRAMES", {std::min<std::int64_t>(count, 65535)});
    parameters.reals(1, "SCALE", {signed_scale});
    parameters.reals(1, "RATE", {rate_Hz});
    if (!unit.empty()) parameters.texts(1, "UNITS", {unit});
    parameters.texts(1, "LABELS", names);
    if (states_long) parameters.reals(1, "LONG_FRAMES", {static_cast<double>(count)});
    if (states_trial) {
      parameters.group(3, "TRIAL");
      parameters.integer(3, "ACTUAL_START_FIELD", {1, 0});
      parameters.integer(3, "ACTUAL_END_FIELD", {count % 65536, count / 65536});
    }
    parameters.group(2, "ANALOG");
    parameters.integer(2, "USED", {static_cast<std::int64_t>(channels.size())});
    parameters.texts(2, "LABELS", channels);
    parameters.texts(2, "UNITS", channel_units);
    parameters.reals(2, "SCALE", channel_scale);
    parameters.reals(2, "GEN_SCALE", {1});
    std::vector<std::int64_t> offsets;
    for (const double offset : channel_offset) offsets.push_back(std::llround(offset));
    parameters.integer(2, "OFFSET", offsets);
  }
  parameters.byte(0);
  parameters.fill_block();
  parameters.bytes[2] = static_cast<char>(parameters.bytes.size() / 512);

  Writer whole{*this, {}};
  whole.byte(2);
  whole.byte(0x50);
  whole.word(points);
  whole.word(static_cast<std::int64_t>(channels.size() * samples));
  whole.word(1);
  whole.word(std::min<std::int64_t>(count, 65535));
  whole.word(0);
  whole.real(signed_scale);
  whole.word(static_cast<std::int64_t>(2 + parameters.bytes.size() / 512));
  whole.word(static_cast<std::int64_t>(samples));
  whole.real(rate_Hz);
  whole.fill_block();
  whole.bytes += parameters.bytes;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    for (const C3dPlace& place : frames[k]) {
      const double divisor = has_floats ? 1 : scale;
      for (const double value : {place.x, place.y, place.z}) {
        whole.number(place.is_missing ? 0 : value / divisor);
      }
      whole.number(place.is_missing ? -1 : 0);
    }
    if (k < analog.size()) {
      for (const double value : analog[k]) whole.number(value);
    }
  }
  whole.fill_block();
  return whole.bytes;
}

}  // namespace condyle::testing_support
