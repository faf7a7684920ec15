// SPDX-License-Identifier: Apache-2.0
// libxdf, which keeps values in 32 bits, finds in an XDF file the points of a wide CSV file.
// usage: read_xdf FILE.xdf FILE.csv
#include <xdf.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>

int fail(const char* problem) {
  std::fprintf(stderr, "read_xdf: %s\n", problem);
  return 1;
}

int main(int count, char** arguments) {
  if (count != 3) return fail("usage: read_xdf FILE.xdf FILE.csv");
  Xdf xdf;
  if (xdf.load_xdf(arguments[1]) != 0) return fail("libxdf does not load it");
  if (xdf.streams.empty() || xdf.streams[0].info.name != "condyle")
    return fail("no stream condyle");
  const Xdf::Stream& stream = xdf.streams[0];
  std::ifstream table(arguments[2]);
  std::string line, field;
  std::getline(table, line);
  std::vector<std::string> names;
  for (std::istringstream fields(line); std::getline(fields, field, ',');) names.push_back(field);
  const auto& channels = stream.info.channels;
  if (channels.size() != static_cast<std::size_t>(stream.info.channel_count)) {
    return fail("the channels are not all described");
  }
  std::size_t row = 0, compared = 0;
  for (; std::getline(table, line); ++row) {
    std::istringstream fields(line);
    std::getline(fields, field, ',');
    if (row >= stream.time_stamps.size()) return fail("samples are missing");
    if (std::abs(stream.time_stamps[row] - std::atof(field.c_str())) > 1e-9) {
      return fail("a time differs");
    }
    for (std::size_t i = 0; i < channels.size(); ++i) {
      if (row == 0 && channels[i].at("label") + "_" + channels[i].at("unit") != names[i + 1]) {
        return fail("a label or a unit differs");
      }
      field.clear();
      std::getline(fields, field, ',');
      const float value = stream.time_series[i][row];
      if (field.empty() != std::isnan(value)) return fail("a missing value differs");
      if (field.empty()) continue;
      const double expected = std::atof(field.c_str());
      if (std::abs(static_cast<double>(value) - expected) > std::abs(expected) * 1e-7) {
        return fail("a value differs");
      }
      ++compared;
    }
  }
  if (row != stream.time_stamps.size()) return fail("there are more samples");
  std::printf("libxdf: %zu values of %zu samples are the same\n", compared, row);
}
