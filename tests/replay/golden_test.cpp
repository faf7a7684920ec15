// SPDX-License-Identifier: Apache-2.0
// The published cascade against estimates of an independent implementation of the same equations
// (replay/vectors). They are never regenerated from condyle's own output.
#include <gtest/gtest.h>

#include <cmath>

#include "condyle/estimator/published/published_cascade.h"
#include "hosted/config/parameter_file.h"
#include "support/command.h"
#include "support/paths.h"
#include "support/table.h"
#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

using testing_support::reference_data;
using testing_support::rms;
using testing_support::run_condyle;
using testing_support::Table;

class Golden : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const std::string name = GetParam();
    // Made from a real recording, so it is not part of the project.
    const bool is_real = name == "zebris_opening_50hz";
    const std::string folder = testing_support::source_path("/tests/replay/vectors/");
    const auto path = [&](const std::string& ending) {
      return is_real ? reference_data(name + ending) : folder + name + ending;
    };
    positions_ = path(".positions.csv");
    if (positions_.empty()) {
      GTEST_SKIP() << "set CONDYLE_REFERENCE_DATA to the folder of reference data";
    }
    parameters_ = path(".toml");
    expected_ = testing_support::read_table(path(".estimates.csv"));
    ASSERT_GT(expected_.rows, 100U);
  }

  std::string positions_, parameters_;
  Table expected_;
};

TEST_P(Golden, CommandReproducesEveryValue) {
  const testing_support::TemporaryFolder folder;
  const std::string out = folder / "estimates.csv";
  const auto result = run_condyle({"replay", positions_, "--estimator", "published", "--parameters",
                                   parameters_, "--out", out});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const Table actual = testing_support::read_table(out);
  ASSERT_EQ(actual.rows, expected_.rows);
  for (std::size_t c = 0; c < expected_.header.size(); ++c) {
    const std::string& column = expected_.header[c];
    ASSERT_TRUE(actual.columns.contains(column)) << column;
    const auto expected = expected_.numbers(column), values = actual.numbers(column);
    const double column_rms = rms(expected);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      ASSERT_LE(std::abs(values[i] - expected[i]),
                1e-9 * std::max(std::abs(expected[i]), column_rms))
          << column << " row " << i;
    }
  }
}

TEST_P(Golden, FloatStaysClose) {
  const auto positions = testing_support::read_table(positions_).numbers("position_m");
  PublishedCascade<float> cascade(load_parameters(parameters_).values);
  const auto p = expected_.numbers("position_m"), v = expected_.numbers("velocity_m_s"),
             F = expected_.numbers("force_N");
  const double p_rms = rms(p), v_rms = rms(v), F_rms = rms(F);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const auto estimate = cascade.step(static_cast<float>(positions[i]));
    ASSERT_NEAR(static_cast<double>(estimate.position_m.value), p[i], 1e-3 * p_rms) << i;
    ASSERT_NEAR(static_cast<double>(estimate.velocity_m_s.value), v[i], 1e-3 * v_rms) << i;
    ASSERT_NEAR(static_cast<double>(estimate.force_N.value), F[i], 1e-3 * F_rms) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Vectors, Golden,
                         testing::Values("chewing_60hz", "chewing_60hz_backward",
                                         "chewing_60hz_loose_prior", "zebris_opening_50hz"),
                         [](const auto& vector) { return std::string(vector.param); });

}  // namespace
}  // namespace condyle::host
