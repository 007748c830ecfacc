#pragma once

#include <string>
#include <utility>
#include <vector>

namespace slamsensor::tests {

/// Keeps the figures of this run as build/results/NAME.csv, which tests/readme holds the README's numbers
/// against. Says so on standard error when that file cannot be written.
void keep_results(const std::string& name, const std::vector<std::pair<std::string, double>>& figures);

}  // namespace slamsensor::tests
