// SPDX-License-Identifier: Apache-2.0
// Readings of a recording.
#include <map>
#include <memory>
#include <vector>

#include "call.h"
#include "hosted/files/number_text.h"
#include "options/reading_options.h"
#include "output/report_text.h"
#include "readings/analysis.h"
#include "readings/readings_files.h"

using namespace condyle::host;

struct condyle_readings {
  std::vector<Analysis> analyses;  // one
  struct Words {
    std::string name, unit, definition;
  };
  std::vector<Words> words;                  // of each reading
  std::map<std::string, std::string> files;  // as far as they were asked for

  const Analysis& analysis() const { return analyses.front(); }
};

namespace {

std::string text_of(const std::string& name, const std::vector<Analysis>& analyses) {
  if (name == "readings.csv") return readings_csv(analyses);
  if (name == "readings.json") return readings_json(analyses);
  if (name == "cycles.csv") return cycles_csv(analyses);
  if (name == "average_cycle.csv") return average_cycle_csv(analyses);
  if (name == "summary.txt") return banner() + analysis_text(analyses.front());
  throw Misuse(quote(name) +
               " is not a file of readings; give readings.csv, readings.json, cycles.csv, "
               "average_cycle.csv or summary.txt");
}

}  // namespace

condyle_status condyle_analyse(const char* source, const char* const* options, size_t option_count,
                               condyle_readings** readings) {
  return guarded(__func__, [&] {
    demand(readings != nullptr, "readings is NULL; give the address of a pointer");
    *readings = nullptr;
    const std::string path = given_text(source, "source");
    ReadingOptions given;
    parse_options("condyle_analyse", options, option_count,
                  [&](CommandLine line) { add_readings_options(line, given); });
    auto made = std::make_unique<condyle_readings>();
    made->analyses.push_back(analyse(path, given.choice()));
    for (const JawReading& reading : made->analysis().readings) {
      const ReadingDefinition& of = *reading.definition;
      made->words.push_back(
          {std::string(of.name), std::string(of.unit), std::string(of.definition)});
    }
    *readings = made.release();
    return CONDYLE_OK;
  });
}

void condyle_readings_free(condyle_readings* readings) {
  delete readings;
}

size_t condyle_readings_count(const condyle_readings* readings) {
  return readings != nullptr ? readings->analysis().readings.size() : 0;
}

condyle_status condyle_readings_get(const condyle_readings* readings, size_t index,
                                    condyle_reading* reading, size_t size) {
  return guarded(__func__, [&] {
    demand(readings != nullptr, "readings is NULL; give what condyle_analyse made");
    demand(reading != nullptr, "reading is NULL; give the address of a condyle_reading");
    demand(size == sizeof *reading, "size is not that of this library's condyle_reading");
    demand(index < condyle_readings_count(readings),
           "index is beyond the readings; ask condyle_readings_count");
    const condyle_readings::Words& words = readings->words[index];
    const JawReading& from = readings->analysis().readings[index];
    *reading = {.task = name_of(from.task),
                .side = name_of(from.side),
                .stroke = from.stroke,
                .name = words.name.c_str(),
                .value = from.value,
                .low = from.low,
                .high = from.high,
                .unit = words.unit.c_str(),
                .definition = words.definition.c_str(),
                .provenance = name_of(from.provenance),
                .reason = from.reason.c_str()};
    return CONDYLE_OK;
  });
}

const char* condyle_readings_unusable(const condyle_readings* readings) {
  return readings != nullptr ? readings->analysis().unusable.c_str() : "";
}

const char* condyle_readings_file(condyle_readings* readings, const char* name) {
  const char* text = nullptr;
  guarded(__func__, [&] {
    demand(readings != nullptr, "readings is NULL; give what condyle_analyse made");
    const std::string file = given_text(name, "name");
    std::string& kept = readings->files[file];
    try {
      if (kept.empty()) kept = text_of(file, readings->analyses);
    } catch (...) {
      readings->files.erase(file);
      throw;
    }
    text = kept.c_str();
    return CONDYLE_OK;
  });
  return text;
}
