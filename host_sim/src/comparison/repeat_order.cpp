// SPDX-License-Identifier: Apache-2.0
#include "comparison/repeat_order.h"

#include <algorithm>
#include <random>

namespace condyle::host {
namespace {

using Sessions = std::vector<std::vector<double>>;

double difference_square_sum(const Sessions& sessions) {
  double sum = 0;
  for (const auto& values : sessions) {
    for (std::size_t j = 1; j < values.size(); ++j) {
      sum += (values[j] - values[j - 1]) * (values[j] - values[j - 1]);
    }
  }
  return sum;
}

bool are_few(const Sessions& sessions) {
  double orders = 1;
  for (const auto& values : sessions) {
    for (std::size_t n = 2; n <= values.size(); ++n) orders *= static_cast<double>(n);
  }
  return orders <= static_cast<double>(kDrawnOrders);
}

// The next order of all sessions together; false after the last.
bool next_order(Sessions& sessions) {
  return std::any_of(sessions.begin(), sessions.end(), [](auto& values) {
    return std::next_permutation(values.begin(), values.end());
  });
}

}  // namespace

double probability_of_order(const std::vector<std::vector<double>>& sessions) {
  constexpr double kRounding = 1e-12;
  const double observed = difference_square_sum(sessions) * (1 + kRounding);
  Sessions orders = sessions;
  std::size_t count = 0, at_most = 0;
  const auto look = [&] {
    ++count;
    at_most += difference_square_sum(orders) <= observed ? 1U : 0U;
  };
  if (are_few(sessions)) {
    for (auto& values : orders) std::sort(values.begin(), values.end());
    do {
      look();
    } while (next_order(orders));
    return static_cast<double>(at_most) / static_cast<double>(count);
  }
  std::mt19937_64 random(1);
  for (std::size_t i = 0; i < kDrawnOrders; ++i) {
    for (auto& values : orders) {
      for (std::size_t k = values.size(); k > 1; --k)
        std::swap(values[k - 1], values[static_cast<std::size_t>(random() % k)]);
    }
    look();
  }
  // The order observed is one of them.
  return static_cast<double>(at_most + 1) / static_cast<double>(count + 1);
}

}  // namespace condyle::host
