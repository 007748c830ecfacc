#pragma once

#include <filesystem>

namespace slamsensor::tests {

/// The folder of the project's sources. Not found through __FILE__, which is relative under ccache's
/// base_dir.
std::filesystem::path source_tree();

}  // namespace slamsensor::tests
