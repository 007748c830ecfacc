#include "tests/unit/tools/emulator/ptu/ptu_bench.hpp"

#include <gtest/gtest.h>

#include <iostream>
#include <string>
#include <vector>

namespace slamsensor::tools {
namespace {

/// What the host types and what its source shows to come back, line ends included.
struct PtuExchange {
  std::string host;
  std::string unit;
  Stamp span = std::chrono::milliseconds(300);  ///< in which the answer comes
};

/// A session as a manual prints it or somebody captured it.
struct PtuSession {
  std::string title;
  std::string source;
  PtuSettings settings;
  std::vector<PtuExchange> prelude;  ///< brings the unit into the state that the source begins with
  std::vector<PtuExchange> exchanges;
};

constexpr auto kManual = "PTU-D46 User's Manual 2.14";

PtuSettings quick_reset(PtuKind kind) {
  PtuSettings settings = exact_settings(kind);
  settings.reset_time = 2s;
  return settings;
}

PtuSettings e_series(PtuLeadingLf leading_lf) {
  PtuSettings settings = quick_reset(PtuKind::D300E);
  settings.leading_lf = leading_lf;
  return settings;
}

PtuSettings unit_at(PtuBegin begin, PtuKind kind) {
  PtuSettings settings = quick_reset(kind);
  settings.begin = begin;
  return settings;
}

std::vector<PtuSession> position_sessions() {
  return {
      {"Absolute position",
       std::string(kManual) + ", 4.3.1",
       exact_settings(),
       {},
       {{"PP22 ", "PP22 *\r\n"},
        {"PP ", "PP * Current Pan position is 22\r\n"},
        {"PP1000 ", "PP1000 *\r\n"}}},
      {"Offset position",
       std::string(kManual) + ", 4.3.2",
       exact_settings(),
       {},
       {{"PP-500 ", "PP-500 *\r\n"},
        {"A ", "A *\r\n", 2s},
        {"PO ", "PO * Current Pan position is -500\r\n"},
        {"PO1500 ", "PO1500 *\r\n"},
        {"A ", "A *\r\n", 2s},
        {"PP ", "PP * Current Pan position is 1000\r\n"}}},
      {"Resolution",
       std::string(kManual) + ", 4.3.3",
       exact_settings(),
       {},
       {{"PR ", "PR * 185.1428 seconds arc per Pan position\r\n"}}},
      {"Limits found at reset",
       std::string(kManual) + ", 4.3.4",
       quick_reset(PtuKind::D46_17_5),
       {},
       {{"R ", "R !T!T!P!P*\r\n", 3s},
        {"PN ", "PN * Minimum Pan position is -3090\r\n"},
        {"PX ", "PX * Maximum Pan position is 3090\r\n"},
        {"TN ", "TN * Minimum Tilt position is -907\r\n"},
        {"TX ", "TX * Maximum Tilt position is 604\r\n"},
        {"LE ", "LE *\r\n"},
        {"PP3200 ", "PP3200 ! Maximum allowable Pan position is 3090\r\n"}}},
      {"Limits enforced and not",
       std::string(kManual) + ", 4.3.5",
       exact_settings(),
       {},
       {{"L ", "L * Limit bounds are ENABLED (soft limits enabled)\r\n"},
        {"PX ", "PX * Maximum Pan position is 3090\r\n"},
        {"PP3200 ", "PP3200 ! Maximum allowable Pan position is 3090\r\n"},
        {"LD ", "LD *\r\n"},
        {"PP3200 ", "PP3200 *\r\n"},
        {"A ", "A *\r\n", 5s},
        {"PP ", "PP * Current Pan position is 3200\r\n"},
        {"L ", "L * Limit bounds are DISABLED (hard limits only: use care)\r\n"}}},
  };
}

std::vector<PtuSession> speed_sessions() {
  return {
      {"Speed",
       std::string(kManual) + ", 4.4",
       exact_settings(),
       {},
       {{"PS2000 ", "PS2000 *\r\n"},
        {"PS ", "PS * Desired Pan speed is 2000 positions/sec\r\n"},
        {"PA ", "PA * Pan acceleration is 2000 positions/sec^2\r\n"},
        {"PB ", "PB * Current Pan base speed is 1000 positions/sec\r\n"}}},
      {"Current speed",
       std::string(kManual) + ", 4.4.3",
       exact_settings(),
       {{"PS450 PP1000 ", ""}},
       {{"PD ", "PD * Current Pan speed is 450 positions/sec\r\n"}}},
      {"Speed bounds",
       std::string(kManual) + ", 4.4.6",
       exact_settings(),
       {},
       {{"PU ", "PU * Maximum Pan speed is 2902 positions/sec\r\n"},
        {"PS3300 ", "PS3300 ! Pan speed cannot exceed 2902 positions/sec\r\n"},
        {"PS2900 ", "PS2900 *\r\n"},
        {"PL ", "PL * Minimum Pan speed is 31 positions/sec\r\n"},
        {"PL20 ", "PL20 ! Motor speed cannot be less than 31 pos/sec\r\n"},
        {"PL40 ", "PL40 *\r\n"}}},
  };
}

std::vector<PtuSession> unit_sessions() {
  return {
      {"Echo",
       std::string(kManual) + ", 4.5.3",
       exact_settings(),
       {{"PP22 FT ", ""}},
       {{"PP ", "PP * 22\r\n"}, {"ED ", "ED *\r\n"}, {"PP ", "* 22\r\n"}}},
      {"Feedback",
       std::string(kManual) + ", 4.5.4",
       exact_settings(),
       {},
       {{"FV ", "FV *\r\n"},
        {"PP ", "PP * Current Pan position is 0\r\n"},
        {"FT ", "FT *\r\n"},
        {"PP ", "PP * 0\r\n"},
        {"F ", "F * ASCII terse mode\r\n"}}},
      {"Version and supply",
       std::string(kManual) + ", 4.5.5 and 4.5.6",
       exact_settings(),
       {},
       {{"V ",
         "V * Pan-Tilt Controller v2.12.1d1(C14/E), (C)2003 Directed Perception, Inc., All Rights "
         "Reserved\r\n"},
        {"O ", "O * Input 30 VDC @ 86 degF\r\n"}}},
      {"Unit number",
       std::string(kManual) + ", 7.3.1",
       exact_settings(),
       {},
       {{"U ", "U * Unit ID is 0\r\n"},
        {"U1 ", "U1 *\r\n"},
        {"U ", "U * Unit ID is 1\r\n"},
        {"DS ", "DS *\r\n"}}},
      {"Unit selection",
       std::string(kManual) + ", 7.3.2",
       exact_settings(),
       {{"U1 _9 ", ""}},
       {{"_1 ", ""}, {"pp300 ", "pp300 *\r\n"}, {"_0 ", "_0 "}, {"pp300 ", ""}, {"_1 ", "*\r\n"}}},
  };
}

std::vector<PtuSession> captured_sessions() {
  const std::string banner =
      "\r\n\r\n### PAN-TILT CONTROLLER\r\n### v3.3.0, (C)2010-2011 FLIR Commercial Systems, Inc., All Rights "
      "Reserved\r\nInitializing...*\r\n";
  return {
      {"Set-up of several commands",
       "INDI FlirPTU, E-series",
       e_series(PtuLeadingLf::Never),
       {},
       {{"ED FT I CI ", "ED *\r\n*\r\n*\r\n*\r\n"}}},
      {"Two queries on a line",
       "INDI FlirPTU, E-series",
       e_series(PtuLeadingLf::Never),
       {{"FT PP100 TP600 A ", "", 2s}},
       {{"PP TP\r\n", "PP * 100\r\nTP\r\n* 600\r\n"}, {"PP\r", "PP\r\n* 100\r\n"}}},
      {"Banner",
       "INDI FlirPTU, E-series",
       unit_at(PtuBegin::PowerUp, PtuKind::D300E),
       {},
       {{"", banner, 3s}}},
      {"Lines without echo",
       "INDI FlirPTU and Python drivers, E-series",
       e_series(PtuLeadingLf::AfterLine),
       {{"ED FT ", ""}},
       {{"PP100\r\n", "\n*\r\n"},
        {"PR\r\n", "\n* 23.142857\r\n"},
        {"XYZ\r\n", "\n! Illegal Command Entered\r\n"},
        {"RT\r\n", "\n!T!T*\r\n", 3s},
        {"RP\r\n", "\n!P!P*\r\n", 3s},
        {"RE\r\n", "\n!T!T!P!P*\r\n", 3s}}},
      {"Set-up by ROS flir_ptu",
       "ros-drivers/flir_ptu",
       quick_reset(PtuKind::D46_17_5),
       {},
       {{" r ", " r !T!T!P!P*\r\n", 3s},
        {"ft ", "ft *\r\n"},
        {"ed ", "ed *\r\n"},
        {"ci ", "*\r\n"},
        {"pr ", "* 185.1428\r\n"},
        {"tr ", "* 185.1428\r\n"},
        {"pn ", "* -3090\r\n"},
        {"px ", "* 3090\r\n"},
        {"pl ", "* 31\r\n"},
        {"pu ", "* 2902\r\n"},
        {"pb ", "* 1000\r\n"},
        {"c ", "* independent (default) speed control mode\r\n"},
        {"pp-2500 a ", "*\r\n*\r\n", 4s},
        {"pp ", "* -2500\r\n"}}},
      {"A wrong word",
       "user's wiki, PTU-46-17.5",
       exact_settings(),
       {},
       {{"POS\r", "POS\r\n! Illegal argument\r\n"}}},
  };
}

std::vector<PtuSession> ptu_sessions() {
  std::vector<PtuSession> all = position_sessions();
  for (auto part : {speed_sessions(), unit_sessions(), captured_sessions()}) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

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
