// SPDX-License-Identifier: Apache-2.0
#include "recordings/recording_choice.h"

#include <sys/stat.h>

#include <set>
#include <utility>

#include "hosted/files/input_error.h"

namespace condyle::host {

void refuse_repeated_recordings(const std::vector<std::string>& sources) {
  std::set<std::string> names;
  std::set<std::pair<dev_t, ino_t>> files;
  for (const std::string& source : sources) {
    struct stat file = {};
    const bool is_known =
        !names.insert(source).second || (stat(source_of(source).file.c_str(), &file) == 0 &&
                                         !files.insert({file.st_dev, file.st_ino}).second);
    if (is_known) throw InputError(source, "is given twice", "give each recording once");
  }
}

}  // namespace condyle::host
