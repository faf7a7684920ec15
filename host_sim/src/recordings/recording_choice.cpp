// SPDX-License-Identifier: Apache-2.0
#include "recordings/recording_choice.h"

#include <sys/stat.h>

#include <set>
#include <utility>

#include "hosted/files/input_error.h"
#include "recordings/recording_files.h"

namespace condyle::host {

void refuse_repeated_recordings(const std::vector<std::string>& sources) {
  std::set<std::string> names;
  std::set<std::pair<dev_t, ino_t>> files;
  for (const std::string& source : sources) {
    bool is_known = !names.insert(source).second;
    for (const std::string& path : recording_files(source)) {
      struct stat file = {};
      const bool is_there = stat(path.c_str(), &file) == 0;
      if (is_there && !files.insert({file.st_dev, file.st_ino}).second) is_known = true;
    }
    if (is_known) throw InputError(source, "is given twice", "give each recording once");
  }
}

}  // namespace condyle::host
