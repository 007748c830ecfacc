#include "tests/support/results.hpp"

#include "tests/support/source_tree.hpp"

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iomanip>

namespace slamsensor::tests {

void keep_results(const std::string& name, const std::vector<std::pair<std::string, double>>& figures) {
  const std::filesystem::path folder = source_tree() / "build" / "results";
  std::error_code ignored;  // what is wrong shows in the next step
  std::filesystem::create_directories(folder, ignored);
  std::ofstream file(folder / (name + ".csv"));
  file << "figure,value\n" << std::setprecision(9);
  for (const auto& [figure, value] : figures) {
    file << figure << ',' << value << '\n';
  }
  if (!file.flush()) {
    std::fprintf(stderr, "%s: the figures cannot be kept\n", (folder / (name + ".csv")).c_str());
  }
}

}  // namespace slamsensor::tests
