#include "hal/pantilt/ptu_command.hpp"

#include <algorithm>
#include <charconv>

namespace slamsensor::hal {
namespace {

/// The second letter of a query or setting.
char letter_of(PtuQuantity quantity) noexcept {
  switch (quantity) {
    case PtuQuantity::Position:
      return 'P';
    case PtuQuantity::MinPosition:
      return 'N';
    case PtuQuantity::MaxPosition:
      return 'X';
    case PtuQuantity::Resolution:
      return 'R';
    case PtuQuantity::Speed:
      return 'S';
    case PtuQuantity::SpeedMin:
      return 'L';
    case PtuQuantity::SpeedMax:
      return 'U';
    case PtuQuantity::BaseSpeed:
      return 'B';
    case PtuQuantity::Acceleration:
      return 'A';
  }
  return 'P';
}

std::array<char, 2> verb_of(Axis axis, PtuQuantity quantity) noexcept {
  return {axis == Axis::Pan ? 'P' : 'T', letter_of(quantity)};
}

/// Whether `sentence` is about what `command` asks.
bool fits(const PtuSentence& sentence, const PtuCommand& command) noexcept {
  return sentence.quantity == command.quantity() && sentence.axis.value_or(command.axis()) == command.axis();
}

}  // namespace

PtuCommand::PtuCommand(std::string_view verb, PtuExpect expect) noexcept : expect_(expect) {
  append(verb);
}

PtuCommand::PtuCommand(std::string_view verb, std::int32_t argument, PtuExpect expect) noexcept
    : expect_(expect) {
  append(verb);
  append_number(argument);
}

PtuCommand PtuCommand::query(Axis axis, PtuQuantity quantity) noexcept {
  const std::array<char, 2> verb = verb_of(axis, quantity);
  PtuCommand command({verb.data(), verb.size()},
                     quantity == PtuQuantity::Position ? PtuExpect::Position : PtuExpect::Number);
  command.axis_ = axis;
  command.quantity_ = quantity;
  return command;
}

PtuCommand PtuCommand::target(Axis axis, std::int32_t position) noexcept {
  const std::array<char, 2> verb = verb_of(axis, PtuQuantity::Position);
  PtuCommand command({verb.data(), verb.size()}, position, PtuExpect::Done);
  command.axis_ = axis;
  return command;
}

PtuCommand PtuCommand::speed(Axis axis, std::int32_t positions_ps) noexcept {
  const std::array<char, 2> verb = verb_of(axis, PtuQuantity::Speed);
  PtuCommand command({verb.data(), verb.size()}, positions_ps, PtuExpect::Done);
  command.axis_ = axis;
  command.quantity_ = PtuQuantity::Speed;
  return command;
}

PtuCommand PtuCommand::baud(std::uint32_t rate) noexcept {
  PtuCommand command("@(", PtuExpect::Setting);
  command.append_number(rate);
  command.append(",0,F)");
  return command;
}

std::size_t PtuCommand::write(std::span<std::uint8_t> into) const noexcept {
  if (into.size() < size_ + 1) {
    return 0;
  }
  std::transform(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(size_), into.begin(),
                 [](char c) { return static_cast<std::uint8_t>(c); });
  into[size_] = ' ';  // every known firmware takes a space as the end of a command
  return size_ + 1;
}

void PtuCommand::append(std::string_view more) noexcept {
  const std::size_t count = std::min(more.size(), text_.size() - size_);
  std::copy_n(more.begin(), count, text_.begin() + static_cast<std::ptrdiff_t>(size_));
  size_ += count;
}

void PtuCommand::append_number(std::int64_t number) noexcept {
  std::array<char, 20> digits{};
  const std::to_chars_result end = std::to_chars(digits.data(), digits.data() + digits.size(), number);
  append({digits.data(), static_cast<std::size_t>(end.ptr - digits.data())});
}

std::optional<PtuMatch> ptu_match(const PtuCommand& command, std::string_view payload) noexcept {
  const std::optional<double> number = ptu_number(payload);
  switch (command.expect()) {
    case PtuExpect::Done:
      return payload.empty() ? std::optional(PtuMatch{}) : std::nullopt;
    case PtuExpect::Setting:
      return number ? std::nullopt : std::optional(PtuMatch{});
    case PtuExpect::Version:
      return payload.empty() || ptu_position(payload) ? std::nullopt : std::optional(PtuMatch{});
    case PtuExpect::Position:
      if (const std::optional<std::int32_t> position = ptu_position(payload)) {
        return PtuMatch{static_cast<double>(*position), false};
      }
      break;
    case PtuExpect::Number:
      if (number) {
        return PtuMatch{*number, false};
      }
      break;
  }
  const std::optional<PtuSentence> sentence = ptu_sentence(payload);
  if (!sentence || !fits(*sentence, command)) {
    return std::nullopt;
  }
  return PtuMatch{sentence->value, true};
}

}  // namespace slamsensor::hal
