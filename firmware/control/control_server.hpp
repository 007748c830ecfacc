#pragma once

#include "firmware/control/control_request.hpp"
#include "firmware/supervision/file_descriptor.hpp"
#include "firmware/supervision/log.hpp"
#include "hal/counters.hpp"
#include "hal/init_error.hpp"
#include "hal/stamp.hpp"

#include <cstddef>
#include <memory>
#include <poll.h>
#include <span>
#include <string>
#include <string_view>
#include <sys/types.h>
#include <vector>

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

/// A local stream socket that listens at a path. The path goes with it, unless another has taken it over.
class ControlListener {
 public:
  /// Listens at `path` with mode 0660. A socket that a dead process left there is replaced; one that answers,
  /// or a file of another kind, is left alone and refused. The error says what to do.
  [[nodiscard]] static tl::expected<ControlListener, hal::InitError> create(const std::string& path);

  ControlListener(ControlListener&& other) noexcept = default;
  ControlListener& operator=(ControlListener&& other) noexcept = default;
  ~ControlListener();

  [[nodiscard]] int fd() const noexcept { return socket_.get(); }

  /// Whether the path still leads to this socket: nobody has removed or replaced its file.
  [[nodiscard]] bool is_in_place() const noexcept;

  /// The next client, its socket non-blocking; none when there is none (errno says whether it went wrong).
  [[nodiscard]] FileDescriptor accept() noexcept;

 private:
  ControlListener(FileDescriptor socket, std::string path);

  FileDescriptor socket_;
  std::string path_;
  dev_t device_ = 0;
  ino_t inode_ = 0;
};

struct ControlServerConfig {
  std::string socket = "/run/slamsensor/control";
  std::size_t clients_max = kControlClientsMax;
  hal::Stamp answer_timeout = std::chrono::seconds(30);  ///< for a request that is answered later
  hal::Stamp unread_timeout =
      std::chrono::seconds(10);                   ///< a client that takes nothing for so long has to go
  hal::Stamp idle_min = std::chrono::seconds(1);  ///< so long silent, a client may have to make room
};

/// Serves the control protocol (control_request.hpp). One thread; never waits.
class ControlServer {
 public:
  /// Listens. `log` outlives the server.
  [[nodiscard]] static tl::expected<std::unique_ptr<ControlServer>, hal::InitError> create(
      const ControlServerConfig& config, ControlHandler handler, Log& log);

  /// Appends what poll() is to wait for. Beside that, step() is due once a second.
  void append_interest(std::vector<pollfd>& interest) const;

  /// Takes new clients, answers what has come, sends what can be sent, lets go who is gone. Makes the socket
  /// again within a second when its file was removed; while something else is there, looks every 10 s
  /// whether the path is free. Clients stay connected through all of that. `now` never decreases.
  void step(hal::Stamp now);

  /// Answers a request that was to be answered later; nothing but a count comes of it when nobody waits for
  /// it any more. It is sent with the next step().
  void complete(ControlToken token, const ControlResult& result);

  [[nodiscard]] std::size_t clients() const noexcept { return clients_.size(); }

  /// clients_accepted, clients_refused, clients_dropped, accept_failed, requests, requests_refused,
  /// lines_too_long, timeouts, answers_unclaimed.
  [[nodiscard]] std::vector<hal::Counter> counters() const;

 private:
  struct Client {
    FileDescriptor socket;
    ControlSession session;
    hal::Stamp active{};  // last progress of reading or sending
    hal::Stamp asked{};   // since when its request is under way
    bool is_gone = false;
  };

  ControlServer(const ControlServerConfig& config, ControlListener listener, ControlHandler handler, Log& log)
      : config_(config), listener_(std::move(listener)), handler_(std::move(handler)), log_(log) {}

  void keep_in_place(hal::Stamp now);
  void accept_clients(hal::Stamp now);
  void admit(FileDescriptor socket, hal::Stamp now);
  [[nodiscard]] bool make_room(hal::Stamp now);
  void serve(Client& client, hal::Stamp now);
  void read(Client& client, hal::Stamp now);
  void write(Client& client, hal::Stamp now);
  void check_time(Client& client, hal::Stamp now);

  ControlServerConfig config_;
  ControlListener listener_;
  ControlHandler handler_;
  Log& log_;
  std::vector<std::unique_ptr<Client>> clients_;
  ControlToken last_token_ = 0;
  hal::Stamp accept_after_{};  // the system had no room for a client before
  bool accepting_ = true;
  hal::Stamp place_due_{};     // when the place of the socket is looked at
  std::string place_problem_;  // why the socket could not be made again, as the log has it

  SessionCounts counts_;
  std::uint64_t accepted_ = 0;
  std::uint64_t turned_away_ = 0;
  std::uint64_t dropped_ = 0;
  std::uint64_t accept_failed_ = 0;
  std::uint64_t timeouts_ = 0;
  std::uint64_t unclaimed_ = 0;
};

}  // namespace slamsensor::firmware
