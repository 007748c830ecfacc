#include "tools/recording/playback.hpp"

#include "firmware/recording/recording_links.hpp"
#include "tools/output/text_output.hpp"

#include <algorithm>
#include <limits>
#include <string_view>
#include <utility>

namespace slamsensor::tools {
namespace {

using firmware::TapeOp;

constexpr std::uint64_t kNumberMax = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint64_t kNumber32Max = std::numeric_limits<std::uint32_t>::max();

// Times stay far from where their sums overflow: 73 years since boot.
constexpr std::int64_t kTimeMax_ns = std::int64_t{1} << 61;

constexpr bool is_time(std::int64_t ns) noexcept {
  return ns >= -kTimeMax_ns && ns <= kTimeMax_ns;
}

}  // namespace

void TapeReader::load(std::span<const std::uint8_t> chunk) noexcept {
  rest_ = chunk;
  is_first_step_ = true;
  is_broken_ = false;
}

std::optional<std::uint64_t> TapeReader::number(std::uint64_t max) noexcept {
  std::uint64_t value = 0;
  for (unsigned shift = 0; shift < 64 && !rest_.empty(); shift += 7) {
    const std::uint8_t byte = rest_.front();
    rest_ = rest_.subspan(1);
    const std::uint64_t bits = byte & 0x7FU;
    if (shift == 63 && bits > 1) {
      return std::nullopt;
    }
    value |= bits << shift;
    if (byte < 0x80U) {
      return value <= max ? std::optional(value) : std::nullopt;
    }
  }
  return std::nullopt;
}

std::optional<std::int64_t> TapeReader::signed_number() noexcept {
  const auto value = number(kNumberMax);
  if (!value) {
    return std::nullopt;
  }
  return static_cast<std::int64_t>((*value >> 1U) ^ (~(*value & 1U) + 1U));
}

std::optional<TapeOperation> TapeReader::next() noexcept {
  if (rest_.empty() || is_broken_) {
    return std::nullopt;
  }
  const unsigned head = rest_.front();
  rest_ = rest_.subspan(1);
  TapeOperation operation;
  operation.op = static_cast<TapeOp>(head >> 4U);
  operation.link = static_cast<firmware::HeadLink>(head & 0xFU);
  const bool is_known = (head >> 4U) < firmware::kTapeOps && (head & 0xFU) < firmware::kHeadLinkNames.size();
  const Operation result = is_known ? fields(operation) : std::nullopt;
  is_broken_ = !result;
  return result;
}

std::optional<TapeOperation> TapeReader::fields(TapeOperation operation) noexcept {
  const auto when = [&operation](bool is_good) { return is_good ? Operation(operation) : std::nullopt; };
  switch (operation.op) {
    case TapeOp::Open:
    case TapeOp::Service:
    case TapeOp::After:
      return take_state(operation) ? Operation(operation) : std::nullopt;
    case TapeOp::Step:
      return step(operation);
    case TapeOp::ReadBusy:
    case TapeOp::ReadDown:
    case TapeOp::Discard:
    case TapeOp::End:
      return operation;
    case TapeOp::ReadOk:
      operation.status = hal::LinkStatus::Ok;
      return take_stamp(operation) && take_bytes(operation) ? Operation(operation) : std::nullopt;
    case TapeOp::Write:
      return take_status(operation) && take_bytes(operation) ? Operation(operation) : std::nullopt;
    case TapeOp::SetBaud: {
      const bool has_status = take_status(operation);
      const auto baud = number(kNumber32Max);
      operation.baud = static_cast<std::uint32_t>(baud.value_or(0));
      return when(has_status && baud);
    }
    case TapeOp::CanReceive:
      operation.status = hal::LinkStatus::Ok;
      return take_stamp(operation) && take_frame(operation) ? Operation(operation) : std::nullopt;
    case TapeOp::CanSend:
      return take_status(operation) && take_frame(operation) ? Operation(operation) : std::nullopt;
    case TapeOp::Command:
      return take_command(operation) ? Operation(operation) : std::nullopt;
    case TapeOp::Lost: {
      const auto lost = number(kNumberMax);
      operation.number = lost.value_or(0);
      return when(lost.has_value());
    }
  }
  return std::nullopt;
}

std::optional<TapeOperation> TapeReader::step(TapeOperation operation) noexcept {
  std::optional<std::int64_t> change;
  if (is_first_step_) {
    const auto now = number(static_cast<std::uint64_t>(kTimeMax_ns));
    change = now ? std::optional(static_cast<std::int64_t>(*now) - (now_ + period_).count()) : std::nullopt;
  } else {
    change = signed_number();
  }
  if (!change || !is_time(*change)) {
    return std::nullopt;
  }
  const std::int64_t period_ns = period_.count() + *change;
  if (period_ns < 0 || !is_time(period_ns) || !is_time(now_.count() + period_ns)) {
    return std::nullopt;
  }
  period_ = hal::Stamp(period_ns);
  now_ += period_;
  is_first_step_ = false;
  operation.time = now_;
  return operation;
}

bool TapeReader::take_state(TapeOperation& operation) noexcept {
  const auto epoch = number(kNumber32Max);
  const auto is_up = number(1);
  const auto baud = number(kNumber32Max);
  if (!epoch || !is_up || !baud) {
    return false;
  }
  operation.state = {static_cast<std::uint32_t>(*epoch), *is_up == 1, static_cast<std::uint32_t>(*baud)};
  return true;
}

bool TapeReader::take_stamp(TapeOperation& operation) noexcept {
  const auto offset = signed_number();
  if (!offset || !is_time(*offset)) {
    return false;
  }
  operation.time = now_ + hal::Stamp(*offset);
  return true;
}

bool TapeReader::take_status(TapeOperation& operation) noexcept {
  const auto status = number(static_cast<std::uint64_t>(hal::LinkStatus::Down));
  operation.status = static_cast<hal::LinkStatus>(status.value_or(0));
  return status.has_value();
}

bool TapeReader::take_bytes(TapeOperation& operation) noexcept {
  const auto count = number(std::min<std::uint64_t>(firmware::kTapeBytesMax, rest_.size()));
  if (!count || *count > rest_.size()) {
    return false;
  }
  operation.bytes = rest_.first(static_cast<std::size_t>(*count));
  rest_ = rest_.subspan(operation.bytes.size());
  return true;
}

bool TapeReader::take_frame(TapeOperation& operation) noexcept {
  const auto id = number(kNumber32Max);
  const auto shape = number(2 * operation.frame.data.size() + 1);
  if (!id || !shape || *shape / 2 > rest_.size()) {
    return false;
  }
  operation.frame.id = static_cast<std::uint32_t>(*id);
  operation.frame.extended = *shape % 2 == 1;
  operation.frame.size = static_cast<std::uint8_t>(*shape / 2);
  std::copy_n(rest_.begin(), operation.frame.size, operation.frame.data.begin());
  rest_ = rest_.subspan(operation.frame.size);
  return true;
}

bool TapeReader::take_command(TapeOperation& operation) noexcept {
  const auto command = number(firmware::kTapeCommands - 1);
  const auto argument = number(kNumberMax);
  operation.command = static_cast<firmware::TapeCommand>(command.value_or(0));
  operation.number = argument.value_or(0);
  return command && argument;
}

namespace {

using firmware::TapeOp;

std::string shown_bytes(std::span<const std::uint8_t> bytes) {
  return in_quotes({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

std::string shown_frame(const hal::CanFrame& frame) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string text = "identifier " + std::to_string(frame.id) + " and bytes";
  for (const std::uint8_t byte : frame.bytes()) {
    text += {' ', kDigits[byte >> 4U], kDigits[byte & 0xFU]};
  }
  return text;
}

}  // namespace

std::string text_of(const TapeOperation& operation) {
  const std::string link(firmware::kHeadLinkNames[static_cast<std::size_t>(operation.link)]);
  switch (operation.op) {
    case TapeOp::Open:
      return "the start of a recording";
    case TapeOp::Step:
      return "the step at " + fixed_text(hal::to_seconds(operation.time), 6) + " s";
    case TapeOp::Service:
    case TapeOp::After:
      return "a change of the " + link + "'s state";
    case TapeOp::ReadBusy:
    case TapeOp::ReadDown:
    case TapeOp::ReadOk:
    case TapeOp::CanReceive:
      return "a read of the " + link;
    case TapeOp::Write:
      return "a write of " + shown_bytes(operation.bytes) + " to the " + link;
    case TapeOp::SetBaud:
      return "a change of the " + link + " to " + std::to_string(operation.baud) + " baud";
    case TapeOp::Discard:
      return "a discard of what the " + link + " has received";
    case TapeOp::CanSend:
      return "a frame of " + shown_frame(operation.frame) + " to the " + link;
    case TapeOp::Command:
      return "a command to the scan head";
    case TapeOp::Lost:
      return "a loss of operations";
    case TapeOp::End:
      break;
  }
  return "the end of the tape";
}

TapePlayer::TapePlayer(ChunkSource& chunks) : chunks_(chunks) {
  while (look_ahead() && next_->op == TapeOp::Open) {
    opened_[static_cast<std::size_t>(next_->link)] = next_->state;
    pop();
  }
}

/// The next chunk goes to the reader, which has none yet at the start.
void TapePlayer::load_chunk() {
  const auto chunk = chunks_.next();
  if (!chunk) {
    finish(TapeEnd::Cut, "the tape was not ended; it stops");
    return;
  }
  if (chunk->number == 0 && chunk_ >= 0) {
    finish(TapeEnd::Cut, "another recording begins in the same file before this one was ended; it stops");
    return;
  }
  if (chunk->number != chunk_ + 1) {
    finish(TapeEnd::ChunkMissing, "chunk " + std::to_string(chunk_ + 1) + " is missing or damaged, chunk " +
                                      std::to_string(chunk->number) + " follows; the tape stops");
    return;
  }
  ++chunk_;
  operation_ = 0;
  reader_.load(chunk->bytes);
}

/// next_ is the next operation; false when there is none. The bytes of the operation before are gone then.
bool TapePlayer::look_ahead() {
  while (end_ == TapeEnd::None && !next_) {
    ++operation_;
    next_ = reader_.next();
    if (!next_ && reader_.is_broken()) {
      finish(TapeEnd::Broken, "what stands on the tape is no operation;");
    } else if (!next_) {
      load_chunk();
    }
  }
  if (next_ && next_->op == TapeOp::Lost) {
    finish(TapeEnd::Lost,
           "the recorder lost " + std::to_string(next_->number) + " operations; the tape stops");
  } else if (next_ && next_->op == TapeOp::End) {
    finish(TapeEnd::Complete, "the recording was ended");
  }
  return next_.has_value();
}

void TapePlayer::pop() {
  last_ = next_;
  next_.reset();
}

bool TapePlayer::has_ended_step() {
  return look_ahead() ? next_->op == TapeOp::Step || next_->op == TapeOp::Command : end_ == TapeEnd::Complete;
}

std::string TapePlayer::place() const {
  return " at " + fixed_text(hal::to_seconds(now_), 3) + " s (chunk " +
         std::to_string(std::max<std::int64_t>(chunk_, 0)) + ", operation " + std::to_string(operation_) +
         ")";
}

void TapePlayer::finish(TapeEnd end, const std::string& text) {
  next_.reset();
  if (end_ == TapeEnd::None) {
    end_ = end;
    end_text_ = text + place();
  }
}

std::optional<TapeOperation> TapePlayer::next() {
  if (!look_ahead()) {
    return std::nullopt;
  }
  if (next_->op != TapeOp::Step && next_->op != TapeOp::Command) {
    finish(TapeEnd::Diverged, "the drivers have ended their step, the tape has " + text_of(*next_));
    return std::nullopt;
  }
  const TapeOperation operation = *next_;
  now_ = operation.op == TapeOp::Step ? operation.time : now_;
  pop();
  return operation;
}

std::optional<TapeOperation> TapePlayer::answer(firmware::HeadLink link, std::initializer_list<TapeOp> ops) {
  if (!look_ahead()) {
    return std::nullopt;
  }
  const bool fits = next_->link == link && std::find(ops.begin(), ops.end(), next_->op) != ops.end();
  if (!fits) {
    TapeOperation asked;
    asked.op = *ops.begin();
    asked.link = link;
    finish(TapeEnd::Diverged, "the driver does " + text_of(asked) + ", the tape has " + text_of(*next_));
    return std::nullopt;
  }
  const TapeOperation operation = *next_;
  pop();
  return operation;
}

std::optional<firmware::TapeLinkState> TapePlayer::state_change(firmware::HeadLink link, TapeOp op) {
  if (!look_ahead() || next_->op != op || next_->link != link) {
    return std::nullopt;
  }
  const firmware::TapeLinkState state = next_->state;
  pop();
  return state;
}

void TapePlayer::diverge(const std::string& done) {
  finish(TapeEnd::Diverged,
         "the driver does " + done + ", the tape has " + (last_ ? text_of(*last_) : "nothing"));
}

namespace {

using firmware::HeadLink;
using firmware::TapeOp;
using hal::LinkStatus;

constexpr std::initializer_list<TapeOp> kReads = {TapeOp::ReadOk, TapeOp::ReadBusy, TapeOp::ReadDown};
constexpr std::initializer_list<TapeOp> kReceives = {TapeOp::CanReceive, TapeOp::ReadBusy, TapeOp::ReadDown};

LinkStatus status_of_read(TapeOp op) noexcept {
  switch (op) {
    case TapeOp::ReadOk:
    case TapeOp::CanReceive:
      return LinkStatus::Ok;
    case TapeOp::ReadDown:
      return LinkStatus::Down;
    default:
      return LinkStatus::Busy;
  }
}

firmware::TapeLinkState opened(const TapePlayer& player, HeadLink link) {
  return player.opened(link).value_or(firmware::TapeLinkState{});
}

template <typename Link>
std::unique_ptr<Link> make_link(TapePlayer& player, HeadLink link) {
  return player.opened(link) ? std::make_unique<Link>(player, link) : nullptr;
}

}  // namespace

PlaybackByteLink::PlaybackByteLink(TapePlayer& player, HeadLink link)
    : player_(player), link_(link), state_(opened(player, link)) {
}

void PlaybackByteLink::follow(TapeOp op) {
  if (const auto state = player_.state_change(link_, op)) {
    state_ = *state;
  }
}

void PlaybackByteLink::service(hal::Stamp) noexcept {
  follow(TapeOp::Service);
}

hal::ByteRead PlaybackByteLink::read(std::span<std::uint8_t> into) noexcept {
  const auto taped = player_.answer(link_, kReads);
  if (!taped) {
    return {};
  }
  if (taped->bytes.size() > into.size()) {
    player_.diverge("a read of at most " + std::to_string(into.size()) + " bytes");
    return {};
  }
  std::copy(taped->bytes.begin(), taped->bytes.end(), into.begin());
  const hal::ByteRead result{status_of_read(taped->op), taped->bytes.size(), taped->time};
  follow(TapeOp::After);
  return result;
}

LinkStatus PlaybackByteLink::write(std::span<const std::uint8_t> bytes) noexcept {
  const auto taped = player_.answer(link_, {TapeOp::Write});
  if (!taped) {
    return LinkStatus::Busy;
  }
  if (!std::equal(bytes.begin(), bytes.end(), taped->bytes.begin(), taped->bytes.end())) {
    TapeOperation done = *taped;
    done.bytes = bytes;
    player_.diverge(text_of(done));
    return LinkStatus::Busy;
  }
  follow(TapeOp::After);
  return taped->status;
}

LinkStatus PlaybackByteLink::set_baud(std::uint32_t baud) noexcept {
  const auto taped = player_.answer(link_, {TapeOp::SetBaud});
  if (!taped) {
    return LinkStatus::Down;
  }
  if (taped->baud != baud) {
    TapeOperation done = *taped;
    done.baud = baud;
    player_.diverge(text_of(done));
    return LinkStatus::Down;
  }
  follow(TapeOp::After);
  return taped->status;
}

void PlaybackByteLink::discard_input() noexcept {
  if (player_.answer(link_, {TapeOp::Discard})) {
    follow(TapeOp::After);
  }
}

PlaybackCanLink::PlaybackCanLink(TapePlayer& player, HeadLink link)
    : player_(player), link_(link), state_(opened(player, link)) {
}

void PlaybackCanLink::follow(TapeOp op) {
  if (const auto state = player_.state_change(link_, op)) {
    state_ = *state;
  }
}

void PlaybackCanLink::service(hal::Stamp) noexcept {
  follow(TapeOp::Service);
}

hal::CanRead PlaybackCanLink::receive() noexcept {
  const auto taped = player_.answer(link_, kReceives);
  if (!taped) {
    return {};
  }
  follow(TapeOp::After);
  return {status_of_read(taped->op), taped->frame, taped->time};
}

LinkStatus PlaybackCanLink::send(const hal::CanFrame& frame) noexcept {
  const auto taped = player_.answer(link_, {TapeOp::CanSend});
  if (!taped) {
    return LinkStatus::Busy;
  }
  const bool is_same = frame.id == taped->frame.id && frame.extended == taped->frame.extended &&
                       std::ranges::equal(frame.bytes(), taped->frame.bytes());
  if (!is_same) {
    TapeOperation done = *taped;
    done.frame = frame;
    player_.diverge(text_of(done));
    return LinkStatus::Busy;
  }
  follow(TapeOp::After);
  return taped->status;
}

firmware::OwnedHeadLinks playback_links(TapePlayer& player) {
  return {make_link<PlaybackByteLink>(player, HeadLink::PanTiltBytes),
          make_link<PlaybackCanLink>(player, HeadLink::PanTiltCan),
          make_link<PlaybackByteLink>(player, HeadLink::RangefinderBytes),
          make_link<PlaybackCanLink>(player, HeadLink::RangefinderCan)};
}

tl::expected<std::unique_ptr<HeadPlayback>, InputError> HeadPlayback::create(ChunkSource& chunks,
                                                                             const firmware::Config& config) {
  auto playback = std::unique_ptr<HeadPlayback>(new HeadPlayback(chunks));
  return playback->start(config).map([&] { return std::move(playback); });
}

tl::expected<void, InputError> HeadPlayback::start(const firmware::Config& config) {
  auto drivers = firmware::make_head_drivers(config.head, links_.get());
  if (!drivers) {
    return refuse("the tape", "does not fit the settings: " + drivers.error().message);
  }
  drivers_ = std::move(*drivers);
  sensor_ =
      std::make_unique<firmware::SensorHead>(*drivers_.pan_tilt, *drivers_.rangefinder, config.scan_head);
  return {};
}

std::optional<firmware::HeadEvent> HeadPlayback::next() {
  for (;;) {
    if (auto event = sensor_->take()) {
      return event;
    }
    const auto operation = player_.next();
    if (!operation) {
      return std::nullopt;
    }
    if (operation->op == firmware::TapeOp::Command) {
      firmware::command(*sensor_, operation->command, operation->number);
      continue;
    }
    sensor_->step(operation->time);
    if (!player_.has_ended_step()) {
      return std::nullopt;
    }
  }
}

}  // namespace slamsensor::tools
