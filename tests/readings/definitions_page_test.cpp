// SPDX-License-Identifier: Apache-2.0
// The page of definitions against the list of readings that the program has.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "readings/reading.h"
#include "support/paths.h"

namespace condyle::host {
namespace {

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(' ');
  return first == std::string::npos ? ""
                                    : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

std::vector<std::string> parts(const std::string& text, char separator) {
  std::vector<std::string> all;
  std::istringstream in(text);
  for (std::string one; std::getline(in, one, separator);) all.push_back(trimmed(one));
  return all;
}

struct StatedLimit {
  std::string limit, why;
};

struct Page {
  std::map<std::string, StatedLimit> limits;  // of each reading, or pattern of names
  std::map<std::string, std::string> reasons;
};

Page read_page() {
  Page page;
  std::ifstream file(testing_support::source_path("/host_sim/docs/definitions.md"));
  EXPECT_TRUE(file.is_open());
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("| ")) continue;
    const std::vector<std::string> cells = parts(line.substr(1), '|');
    if (cells.size() == 2) page.reasons[cells[0]] = cells[1];
    if (cells.size() < 4 || !cells[0].starts_with("`")) continue;
    std::vector<std::string> names;
    for (const std::string& name : parts(cells[0], ',')) {
      names.push_back(name.substr(1, name.size() - 2));
    }
    const auto limits = parts(cells[2], ';'), why = parts(cells[3], ';');
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto of = [i](const std::vector<std::string>& all) {
        return all.at(all.size() == 1 ? 0 : i);
      };
      EXPECT_TRUE(page.limits.emplace(names[i], StatedLimit{of(limits), of(why)}).second)
          << names[i] << " stands twice";
    }
  }
  return page;
}

// The page's words for the limit of `reading`.
std::string limit_of(const ReadingDefinition& reading) {
  return reading.unit == "1" ? fmt::format("{:g}", reading.largest_half_interval)
                             : fmt::format("{:g} {}", reading.largest_half_interval, reading.unit);
}

// The reading whose `what`, sd or change, this one is.
const ReadingDefinition& mean_of(const ReadingDefinition& reading, const std::string& what) {
  std::string name(reading.name);
  return definition_of(name.erase(name.find(what), what.size()));
}

TEST(DefinitionsPage, HasTheLimitOfEachReadingWithItsReason) {
  Page page = read_page();
  std::set<std::string> used;
  const auto is_explained = [&](const std::string& name) {
    const std::string& why = page.limits.at(name).why;
    used.insert(why);
    return !page.reasons[why].empty();
  };
  std::set<std::string> named;
  for (const ReadingDefinition& reading : reading_definitions()) {
    const std::string name(reading.name);
    double expected = reading.largest_half_interval;
    if (name.find("_sd_") != std::string::npos) {
      expected = mean_of(reading, "_sd").largest_half_interval;
    } else if (name.find("_change_") != std::string::npos) {
      expected = 2 * mean_of(reading, "_change").largest_half_interval;
    } else if (name.ends_with("_cv_percent")) {
      expected = name == "cycle_width_cv_percent" ? 20 : 10;
    } else {
      ASSERT_EQ(page.limits.count(name), 1U) << name;
      EXPECT_EQ(page.limits.at(name).limit, limit_of(reading)) << name;
      EXPECT_TRUE(is_explained(name)) << name;
      named.insert(name);
    }
    EXPECT_EQ(reading.largest_half_interval, expected) << name;
  }
  for (const auto& [pattern, limit] :
       {std::pair("..._sd_...", "as the mean"), std::pair("..._cv_percent", "10 %, width 20 %"),
        std::pair("..._change_...", "twice the mean's")}) {
    EXPECT_EQ(page.limits.at(pattern).limit, limit);
    EXPECT_TRUE(is_explained(pattern)) << pattern;
    named.insert(pattern);
  }
  EXPECT_EQ(named.size(), page.limits.size()) << "the page has readings that the program lacks";
  for (const auto& [why, reason] : page.reasons) {
    if (why.size() == 1) {
      EXPECT_EQ(used.count(why), 1U) << why << " explains nothing";
    }
  }
}

}  // namespace
}  // namespace condyle::host
