// SPDX-License-Identifier: Apache-2.0
#include "hil/play.h"
#include "support/paths.h"

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <sstream>

namespace condyle::hil {
namespace {

std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? "'\\''" : std::string(1, c);
  return text + "'";
}

nlohmann::json parse(const std::string& line) {
  return nlohmann::json::parse(line, nullptr, false);
}

}  // namespace

bool has_umockdev() {
  return std::system("command -v umockdev-wrapper >/dev/null") == 0;
}

int repeats() {
  const char* const text = std::getenv("CONDYLE_HIL_REPEATS");
  return text != nullptr ? std::max(1, std::atoi(text)) : 1;
}

Played play(const std::string& personality, const std::vector<std::string>& options,
            const std::vector<std::string>& program) {
  // umockdev's library is loaded before the address sanitizer's, which minds.
  std::string command =
      "ASAN_OPTIONS=\"verify_asan_link_order=0:$ASAN_OPTIONS\" "
      "TSAN_OPTIONS=\"suppressions=" +
      testing_support::source_path("/tests/hil/thread_sanitizer.txt") +
      ":$TSAN_OPTIONS\" "
      "timeout -k 5 " +
      std::string(kGuard_s) + " umockdev-wrapper " +
      quoted(testing_support::program_path("umockdev_facebow")) + " " + personality;
  for (const std::string& option : options) command += " " + quoted(option);
  command += " --";
  for (const std::string& word : program) command += " " + quoted(word);
  command += " 2>&1";

  Played played;
  std::FILE* const pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return played;
  std::array<char, 4096> buffer;
  while (const std::size_t size = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    played.text.append(buffer.data(), size);
  }
  const int status = pclose(pipe);
  played.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  std::istringstream lines(played.text);
  for (std::string line; std::getline(lines, line);) {
    const nlohmann::json json = parse(line);
    if (!json.is_object()) continue;
    (json.contains("made") ? played.account : played.reader) = json;
  }
  return played;
}

}  // namespace condyle::hil
