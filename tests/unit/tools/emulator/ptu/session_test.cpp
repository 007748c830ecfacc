#include "tests/unit/tools/emulator/ptu/ptu_bench.hpp"
#include "tests/unit/tools/emulator/ptu/ptu_sessions.hpp"

#include <gtest/gtest.h>

#include <iostream>

namespace slamsensor::tools {
namespace {

// Every line that a manual prints or somebody captured comes out byte by byte; the output of this test is the
// transcript beside its source.
TEST(PtuSessions, AnswerAsInManualsAndCaptures) {
  for (const PtuSession& session : ptu_sessions()) {
    SCOPED_TRACE(session.title);
    PtuBench bench(session.settings);
    for (const PtuExchange& exchange : session.prelude) {
      bench.ask(exchange.host, exchange.span);
    }
    std::cout << "# " << session.title << " (" << session.source << ")\n";
    for (const PtuExchange& exchange : session.exchanges) {
      const std::string unit = bench.ask(exchange.host, exchange.span);
      EXPECT_EQ(ptu_text(unit), ptu_text(exchange.unit)) << "after " << ptu_text(exchange.host);
      std::cout << "host   > " << ptu_text(exchange.host) << "\nunit   < " << ptu_text(unit) << "\nsource < "
                << ptu_text(exchange.unit) << '\n';
    }
  }
}

}  // namespace
}  // namespace slamsensor::tools
