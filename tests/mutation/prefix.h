// SPDX-License-Identifier: Apache-2.0
// Precompiled before every file of the mutated build.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <Eigen/Dense>

#include "mutant_switch.h"
