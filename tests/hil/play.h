// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>
#include <vector>

#include "support/paths.h"

namespace condyle::hil {

/// What a run of a program over the fake facebow left.
struct Played {
  int exit_code = -1;              ///< the program's; 127: not started; 124: it hung
  std::string text;                ///< all that was printed
  nlohmann::json reader, account;  ///< the lines of JSON they printed

  /// A number of either; 0 where there is none.
  std::int64_t reader_count(const char* name) const { return reader.value(name, std::int64_t{0}); }
  std::int64_t account_count(const char* name) const {
    return account.value(name, std::int64_t{0});
  }
  /// How often a fault was done.
  std::int64_t fault_count(const char* name) const {
    return account.value("faults", nlohmann::json::object()).value(name, std::int64_t{0});
  }
};

/// A script with every fault of the fake facebow.
inline const std::string kAllFaults = testing_support::source_path("/tests/hil/all_faults.toml");

/// A time limit, in seconds, that only a program that hangs reaches.
inline constexpr const char* kGuard_s = "1000";

/// True where umockdev's programs are installed.
bool has_umockdev();

/// Runs `program` (with its arguments) over the fake facebow with `personality` "hidraw" or
/// "libusb" and the options of umockdev_facebow. Ends it where it hangs.
Played play(const std::string& personality, const std::vector<std::string>& options,
            const std::vector<std::string>& program);

/// How often tests of what chance may change are to be repeated: CONDYLE_HIL_REPEATS, or 1.
int repeats();

}  // namespace condyle::hil
