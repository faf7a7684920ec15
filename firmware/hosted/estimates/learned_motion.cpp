// SPDX-License-Identifier: Apache-2.0
#include "hosted/estimates/learned_motion.h"

#include <nlohmann/json.hpp>

namespace condyle::host {

std::string learned_text(const LearnedMotion& learned) {
  nlohmann::ordered_json json = {{"format", kLearnedFormat},
                                 {"condyle", CONDYLE_VERSION},
                                 {"rate_Hz", learned.rate_Hz},
                                 {"lag", learned.lag}};
  nlohmann::ordered_json& axes = json["axes"] = nlohmann::ordered_json::array();
  for (const LearnedAxis& axis : learned.axes) {
    nlohmann::ordered_json one = {{"kernels", axis.kernels}};
    for (const auto& [name, values] : axis.values) one[name] = values;
    axes.push_back(std::move(one));
  }
  return json.dump() + "\n";
}

}  // namespace condyle::host
