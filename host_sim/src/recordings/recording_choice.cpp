// SPDX-License-Identifier: Apache-2.0
#include "recordings/recording_choice.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "hosted/files/input_error.h"
#include "recordings/recording_files.h"

namespace condyle::host {

void refuse_repeated_recordings(const std::vector<std::string>& sources) {
  std::set<std::string> names;
  std::vector<std::string> files;
  for (const std::string& source : sources) {
    bool is_known = !names.insert(source).second;
    for (const std::string& path : recording_files(source)) {
      const auto is_same = [&path](const std::string& file) {
        std::error_code missing;
        return std::filesystem::equivalent(file, path, missing);
      };
      if (std::any_of(files.begin(), files.end(), is_same)) is_known = true;
      files.push_back(path);
    }
    if (is_known) throw InputError(source, "is given twice", "give each recording once");
  }
}

}  // namespace condyle::host
