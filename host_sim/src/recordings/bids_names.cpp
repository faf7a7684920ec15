// SPDX-License-Identifier: Apache-2.0
#include "recordings/bids_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "hosted/files/input_error.h"
#include "hosted/files/number_text.h"

namespace condyle::host {

BidsLabels bids_labels_in(const std::string& name) {
  BidsLabels labels;
  std::string stem = std::filesystem::path(name).filename().string();
  stem = stem.substr(0, stem.find('.'));
  if (!stem.starts_with("sub-")) return labels;
  for (std::size_t begin = 0; begin < stem.size();) {
    const std::size_t end = std::min(stem.find('_', begin), stem.size());
    const std::string part = stem.substr(begin, end - begin);
    const auto take = [&](std::string_view key, std::string& label) {
      if (label.empty() && part.starts_with(key)) label = part.substr(key.size());
    };
    take("sub-", labels.subject);
    take("ses-", labels.session);
    take("task-", labels.task);
    take("run-", labels.run);
    begin = end + 1;
  }
  return labels;
}

void check_bids_label(const std::string& place, const char* what, const std::string& label) {
  const bool is_good = !label.empty() && std::all_of(label.begin(), label.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
  });
  if (is_good) return;
  throw InputError(place, fmt::format("{} {} is not a label", what, quote(label)),
                   "use letters and digits only, as in 01 or pre");
}

}  // namespace condyle::host
