// SPDX-License-Identifier: Apache-2.0
// A report of the simulated session, for the tests of `condyle report`.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/command.h"
#include "support/paths.h"
#include "support/temporary_folder.h"

namespace condyle::testing_support {

// The content of the element that begins with `opening`.
inline std::string element(const std::string& page, const std::string& opening,
                           const std::string& end) {
  const std::size_t begin = page.find(opening);
  if (begin == std::string::npos) return {};
  const std::size_t content = begin + opening.size();
  return page.substr(content, page.find(end, content) - content);
}

inline nlohmann::json data_of(const std::string& page) {
  return nlohmann::json::parse(
      element(page, "<script type=\"application/json\" id=\"condyle-report-1\">", "</script>"));
}

class ReportTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto result =
        run_condyle({"simulate", source_path("/host_sim/scenarios/clinical_session.toml"), "--out",
                     folder_ / "session.csv"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
  }
  std::string path(const std::string& name) const { return folder_ / name; }
  std::vector<std::string> with_files(const std::string& command,
                                      const std::string& recording) const {
    return {command,   path(recording),          "--landmarks", path("session.landmarks.toml"),
            "--tasks", path("session.tasks.csv")};
  }

  TemporaryFolder folder_;
};

}  // namespace condyle::testing_support
