#include "tools/recording/tape_player.hpp"

#include "tools/input/input_error.hpp"
#include "tools/output/number_text.hpp"

#include <algorithm>
#include <string_view>

namespace slamsensor::tools {
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

}  // namespace slamsensor::tools
