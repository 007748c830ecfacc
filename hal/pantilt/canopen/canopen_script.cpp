#include "hal/pantilt/canopen/canopen_script.hpp"

#include "hal/fixed_text.hpp"

#include <array>

namespace slamsensor::hal {
namespace {

struct Abort {
  std::uint32_t code;
  std::string_view name;
};

constexpr std::array kAborts{
    Abort{0, "unknown abort code"},  // stands for every other
    Abort{0x05030000, "toggle bit not alternated"},
    Abort{0x05040000, "transfer timed out"},
    Abort{0x05040001, "command specifier not valid"},
    Abort{0x05040005, "out of memory"},
    Abort{0x06010000, "access not supported"},
    Abort{0x06010001, "read of a write-only object"},
    Abort{0x06010002, "write to a read-only object"},
    Abort{0x06020000, "object does not exist"},
    Abort{0x06040041, "object cannot be mapped"},
    Abort{0x06040042, "mapped objects are longer than a PDO"},
    Abort{0x06040043, "parameters not compatible"},
    Abort{0x06040047, "device not compatible inside"},
    Abort{0x06060000, "hardware error"},
    Abort{0x06070010, "length does not match"},
    Abort{0x06070012, "value too long"},
    Abort{0x06070013, "value too short"},
    Abort{0x06090011, "sub-index does not exist"},
    Abort{0x06090030, "value out of range"},
    Abort{0x06090031, "value too high"},
    Abort{0x06090032, "value too low"},
    Abort{0x06090036, "maximum below minimum"},
    Abort{0x08000000, "general error"},
    Abort{0x08000020, "cannot be stored"},
    Abort{0x08000021, "cannot be stored: local control"},
    Abort{0x08000022, "cannot be stored in this state"},
    Abort{0x08000023, "no object dictionary"},
    Abort{0x08000024, "no data"},
};

constexpr auto kFirstAbort = static_cast<std::size_t>(CanopenProblem::FirstAbort);

constexpr std::array<std::string_view, kFirstAbort> kTexts{
    "",
    "is being started up",
    "does not answer; check power, bit rate, node number and termination",
    "is not a CiA 402 drive; check the node number",
    "its drive lacks a mode of operation that the configuration needs",
    "its limits leave no range of motion; check its software limits and min_rad, max_rad",
    "its encoder and gear figures (608F, 6091) give no scale; configure counts_per_rad",
    "none of its PDOs has both statusword and position; choose another feedback",
    "its drive does not reach the state asked for; check its power stage and enable input",
    "its drive is in the fault state",
    "is not homed; set homing_method, or homing to never for an absolute encoder",
    "lost its zero, which methods 35 and 37 do not find again; use a reference, or an absolute encoder",
    "homing failed; check the reference switch and the homing method",
    "homing did not end in time",
    "heartbeat lost; check power and cable",
    "started anew by itself; check its power",
    "left the operational state",
    "its drive left the enabled state",
    "its positions stay away",
    "reports a generic error",
    "reports a current error (EMCY 2xxx)",
    "reports a voltage error (EMCY 3xxx); check its supply",
    "reports a temperature error (EMCY 4xxx)",
    "reports a hardware error (EMCY 5xxx)",
    "reports a software error (EMCY 6xxx)",
    "reports an error of a module such as its encoder or brake (EMCY 7xxx)",
    "reports a monitoring or communication error (EMCY 8xxx)",
    "reports a positioning error such as a following error (EMCY 86xx)",
    "reports an external error (EMCY 9xxx)",
    "reports an error of its maker's own (EMCY Fxxx)",
};

constexpr std::size_t kRoom = 128;
constexpr std::size_t kCount = kFirstAbort + kAborts.size();
using Text = FixedText<kRoom>;

constexpr Text joined(std::string_view head, std::string_view tail) noexcept {
  std::array<char, kRoom> text{};
  std::size_t size = 0;
  for (const std::string_view part : {head, tail}) {
    for (const char c : part) {
      text[size++] = c;  // too long a text does not compile
    }
  }
  return Text(std::string_view(text.data(), size));
}

constexpr std::array<Text, kCount> all_texts(std::string_view fact, std::string_view refusal) noexcept {
  std::array<Text, kCount> texts{};
  for (std::size_t i = 1; i < kCount; ++i) {
    texts[i] = i < kFirstAbort ? joined(fact, kTexts[i]) : joined(refusal, kAborts[i - kFirstAbort].name);
  }
  return texts;
}

constexpr std::array<Text, kCount> kPanTexts =
    all_texts("CANopen pan axis: ", "CANopen pan axis: refused a request: ");
constexpr std::array<Text, kCount> kTiltTexts =
    all_texts("CANopen tilt axis: ", "CANopen tilt axis: refused a request: ");

std::size_t abort_index(std::uint32_t code) noexcept {
  for (std::size_t i = 0; i < kAborts.size(); ++i) {
    if (kAborts[i].code == code) {
      return i;
    }
  }
  return 0;
}

}  // namespace

CanopenProblem abort_problem(std::uint32_t code) noexcept {
  return static_cast<CanopenProblem>(kFirstAbort + abort_index(code));
}

std::string_view sdo_abort_name(std::uint32_t code) noexcept {
  return kAborts[abort_index(code)].name;
}

CanopenProblem emergency_problem(std::uint16_t code) noexcept {
  if ((code & 0xFF00) == 0x8600) {
    return CanopenProblem::EmergencyPositioning;
  }
  switch (code >> 12) {
    case 2:
      return CanopenProblem::EmergencyCurrent;
    case 3:
      return CanopenProblem::EmergencyVoltage;
    case 4:
      return CanopenProblem::EmergencyTemperature;
    case 5:
      return CanopenProblem::EmergencyHardware;
    case 6:
      return CanopenProblem::EmergencySoftware;
    case 7:
      return CanopenProblem::EmergencyModules;
    case 8:
      return CanopenProblem::EmergencyCommunication;
    case 9:
      return CanopenProblem::EmergencyExternal;
    case 0xF:
      return CanopenProblem::EmergencyVendor;
    default:
      return CanopenProblem::EmergencyGeneric;
  }
}

std::string_view problem_text(Axis axis, CanopenProblem problem) noexcept {
  const auto index = static_cast<std::size_t>(problem);
  return index < kCount ? (axis == Axis::Pan ? kPanTexts : kTiltTexts)[index].view() : std::string_view();
}

}  // namespace slamsensor::hal
