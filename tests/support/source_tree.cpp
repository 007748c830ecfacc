#include "tests/support/source_tree.hpp"

namespace slamsensor::tests {

std::filesystem::path source_tree() {
  return SLAMSENSOR_SOURCE_TREE;
}

}  // namespace slamsensor::tests
