#pragma once

#include "firmware/control/control_request.hpp"

#include <cstddef>
#include <string>
#include <string_view>

namespace slamsensor::firmware {

/// What comes of a session's lines.
struct SessionCounts {
  std::uint64_t requests = 0;
  std::uint64_t refused = 0;  ///< answered with an error
  std::uint64_t too_long = 0;
};

/// The protocol's side of one client: bytes in, answers out. Knows no socket and no time. Memory is bounded
/// by kInputMax and two answers.
class ControlSession {
 public:
  /// Room for requests that were sent ahead.
  static constexpr std::size_t kInputMax = 4 * (kControlLineMax + 2);

  /// How many bytes `receive` takes now.
  [[nodiscard]] std::size_t room() const noexcept { return kInputMax - input_.size(); }

  /// Takes the first room() bytes of `bytes`.
  void receive(std::string_view bytes);

  /// No more bytes will come; a last line without an end counts.
  void end_input() noexcept { input_ended_ = true; }
  [[nodiscard]] bool has_ended() const noexcept { return input_ended_; }

  /// Answers the lines that are there, until one is answered later or an answer is waiting to be sent. Tokens
  /// are drawn from `last_token`. Call it again after receive, end_input, complete and sent.
  void run(const ControlHandler& handler, ControlToken& last_token, SessionCounts& counts);

  /// Whether run() would take up a line.
  [[nodiscard]] bool can_run() const noexcept;

  /// Answers the request that `token` stands for; false when it is not one that this session waits for.
  bool complete(ControlToken token, const ControlResult& result);

  /// What is to be sent to the client.
  [[nodiscard]] std::string_view output() const noexcept {
    return std::string_view(output_).substr(output_sent_);
  }
  /// The first `count` bytes of output() have been sent.
  void sent(std::size_t count) noexcept;

  [[nodiscard]] bool is_pending() const noexcept { return pending_ != kNone; }
  /// Everything that came has been answered and sent, and no more will come.
  [[nodiscard]] bool is_finished() const noexcept {
    return input_ended_ && input_.empty() && !is_pending() && output_.empty();
  }
  /// The request that is answered later is answered with a time-out.
  void give_up(std::string_view why);

 private:
  static constexpr ControlToken kNone = 0;

  [[nodiscard]] bool take_line(std::string& line, SessionCounts& counts);
  void answer(std::string_view line, const ControlHandler& handler, ControlToken& last_token,
              SessionCounts& counts);
  void put(const ControlResult& result);

  std::string input_;
  std::string output_;
  std::size_t output_sent_ = 0;
  ControlToken pending_ = kNone;
  bool input_ended_ = false;
  bool skipping_ = false;  // the rest of a line that was too long
};

}  // namespace slamsensor::firmware
