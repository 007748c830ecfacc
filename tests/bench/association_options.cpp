#include "tests/bench/association_options.hpp"

#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <span>
#include <string_view>

namespace slamsensor::bench {
namespace {

[[noreturn]] void refuse(std::string_view argument) {
  std::fprintf(stderr,
               "bench_association: '%.*s' does not give the number (or five, as A,B,C,D,E) it should\n",
               static_cast<int>(argument.size()), argument.data());
  std::exit(64);  // EX_USAGE
}

/// Reads just values.size() positive whole numbers.
void read_numbers(std::string_view argument, std::string_view text, std::span<std::size_t> values) {
  const char* next = text.data();
  const char* const end = next + text.size();
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0 && (next == end || *next++ != ',')) {
      refuse(argument);
    }
    const auto [stop, error] = std::from_chars(next, end, values[i]);
    if (error != std::errc() || values[i] == 0) {
      refuse(argument);
    }
    next = stop;
  }
  if (next != end) {
    refuse(argument);
  }
}

std::optional<std::string_view> value_of(std::string_view argument, std::string_view name) {
  return argument.starts_with(name) ? std::optional(argument.substr(name.size())) : std::nullopt;
}

bool take(std::string_view argument, AssociationOptions& options) {
  if (const auto value = value_of(argument, "--queries=")) {
    read_numbers(argument, *value, options.queries);
  } else if (const auto paper = value_of(argument, "--paper-queries=")) {
    read_numbers(argument, *paper, {&options.paper_queries, 1});
  } else if (const auto peer = value_of(argument, "--peer-queries=")) {
    read_numbers(argument, *peer, {&options.peer_queries, 1});
  } else if (const auto seconds = value_of(argument, "--peer-seconds=")) {
    std::size_t whole = 0;
    read_numbers(argument, *seconds, {&whole, 1});
    options.peer_seconds = static_cast<double>(whole);
  } else {
    return false;
  }
  return true;
}

}  // namespace

AssociationOptions take_options(int& argc, char** argv) {
  AssociationOptions options;
  int kept = 1;
  for (int i = 1; i < argc; ++i) {
    if (!take(argv[i], options)) {
      argv[kept++] = argv[i];
    }
  }
  argc = kept;
  return options;
}

}  // namespace slamsensor::bench
