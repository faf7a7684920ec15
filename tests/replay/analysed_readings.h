// SPDX-License-Identifier: Apache-2.0
// What `condyle analyse --json` prints, for its tests.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace condyle::testing_support {

// Readings printed as JSON, of the first recording.
class Readings {
 public:
  explicit Readings(const std::string& json)
      : recording_(nlohmann::json::parse(json).at("recordings").at(0)) {}

  // A mean over strokes; null if it is withheld.
  nlohmann::json value(const std::string& task, const std::string& reading,
                       const std::string& side = "") const {
    for (const auto& one : recording_.at("readings")) {
      if (one.at("task") == task && one.at("reading") == reading && one.at("side") == side &&
          one.at("stroke").is_null()) {
        return one;
      }
    }
    return nullptr;
  }
  bool all_are_withheld() const {
    for (const auto& one : recording_.at("readings")) {
      if (one.at("provenance") != "withheld" || one.at("reason") == "") return false;
    }
    return !recording_.at("readings").empty();
  }
  const nlohmann::json& recording() const { return recording_; }

 private:
  nlohmann::json recording_;
};

}  // namespace condyle::testing_support
