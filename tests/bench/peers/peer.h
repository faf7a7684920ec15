// SPDX-License-Identifier: Apache-2.0
// What every peer written in C++ shares: it reads the input that compare.py wrote, and answers
// compare.py's commands on standard input.
//
//   time FILTER            ->  CPU time of one sample (ns)
//   write FILTER PATH      ->  "written"; a row of estimates and their variances per sample
//
// FILTER is "stage_1" (estimates p, v, F) or "cascade" (p, v, F, kv, m), a class with
//   explicit Filter(const PublishedParameters&);
//   Estimates step(double position_m);      // std::array: what the sample's estimates are
//   Estimates variances() const;
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "condyle/estimator/published/parameters.h"

namespace condyle::peers {

using MotionEstimates = std::array<double, 3>;   ///< p (m), v (m/s), F (N)
using CascadeEstimates = std::array<double, 5>;  ///< p, v, F, kv (Ns/m), m (kg)

/// What the filters are given.
struct Input {
  PublishedParameters parameters;
  std::vector<double> positions_m;
};

/// Reads lines of a name and its numbers.
inline Input read_input(const std::string& path) {
  std::map<std::string, std::vector<double>> lines;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string name;
    words >> name;
    for (double value = 0; words >> value;) lines[name].push_back(value);
  }
  const auto numbers = [&](const std::string& name, std::size_t count) {
    const std::vector<double>& found = lines[name];
    if (found.empty() || (count != 0 && found.size() != count)) {
      throw std::runtime_error("the parameters must give " + name +
                               ", numbers: " + std::to_string(count));
    }
    return found;
  };
  Input input;
  input.positions_m = numbers("position_m", 0);
  PublishedParameters& parameters = input.parameters;
  parameters.motion.discretisation =
      numbers("motion.is_backward", 1)[0] != 0 ? Discretisation::backward : Discretisation::forward;
  visit_fields(parameters, [&](const char* section, const char* key, double* values,
                               std::size_t count, const char*, Range) {
    const std::string name = *section == '\0' ? key : std::string(section) + "." + key;
    const std::vector<double> found = numbers(name, count);
    for (std::size_t i = 0; i < count; ++i) values[i] = found[i];
  });
  if (!is_valid(parameters)) throw std::runtime_error("a parameter is out of its range");
  return input;
}

/// CPU time of this process: what other programs take does not count.
inline double cpu_time_ns() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e9 + static_cast<double>(now.tv_nsec);
}

/// Steps new filters through the recording for at least 10 ms. Each sample's estimates are kept, as
/// a program that uses them does.
template <class Filter>
double ns_per_sample(const Input& input) {
  constexpr double kShortest_ns = 10e6;
  const std::size_t samples = input.positions_m.size();
  std::vector<decltype(std::declval<Filter&>().step(0.0))> estimates(samples);
  const double start_ns = cpu_time_ns();
  double elapsed_ns = 0;
  double steps = 0;
  while (elapsed_ns < kShortest_ns) {
    Filter filter(input.parameters);
    for (std::size_t i = 0; i < samples; ++i) estimates[i] = filter.step(input.positions_m[i]);
    asm volatile("" : : "g"(estimates.data()) : "memory");  // they are used
    steps += static_cast<double>(samples);
    elapsed_ns = cpu_time_ns() - start_ns;
  }
  return elapsed_ns / steps;
}

/// Writes estimates and variances of each sample, with all their digits.
template <class Filter>
void write_estimates(const Input& input, const std::string& path) {
  std::ofstream file(path);
  file.precision(17);
  Filter filter(input.parameters);
  for (const double position_m : input.positions_m) {
    for (const double value : filter.step(position_m)) file << value << ' ';
    for (const double value : filter.variances()) file << value << ' ';
    file << '\n';
  }
  file.flush();
  if (!file) throw std::runtime_error(path + ": cannot be written");
}

/// A filter, and the name that the commands use.
struct NamedFilter {
  std::string name;
  std::function<double(const Input&)> time;
  std::function<void(const Input&, const std::string&)> write;
};
template <class Filter>
NamedFilter named(std::string name) {
  return {std::move(name), ns_per_sample<Filter>, write_estimates<Filter>};
}

/// The program: answers commands until standard input ends.
inline int serve(int argc, char** argv, const std::vector<NamedFilter>& filters) {
  if (argc != 2) {
    std::cerr << "usage: " << argv[0] << " INPUT     (compare.py writes it and the commands)\n";
    return 2;
  }
  try {
    const Input input = read_input(argv[1]);
    for (std::string command, name; std::cin >> command >> name;) {
      bool found = false;
      for (const NamedFilter& filter : filters) {
        if (filter.name != name) continue;
        found = true;
        if (command == "time") {
          std::cout << filter.time(input) << std::endl;
        } else {
          std::string path;
          std::cin >> path;
          filter.write(input, path);
          std::cout << "written" << std::endl;
        }
      }
      if (!found) throw std::runtime_error("there is no filter " + name);
    }
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << error.what() << '\n';
    return 2;
  }
  return 0;
}

}  // namespace condyle::peers
