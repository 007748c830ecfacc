#pragma once

#include "firmware/control/control_listener.hpp"
#include "firmware/control/control_session.hpp"
#include "hal/counters.hpp"
#include "hal/stamp.hpp"

#include <memory>
#include <poll.h>
#include <span>
#include <vector>

namespace slamsensor::firmware {

struct ControlServerConfig {
  std::string socket = "/run/slamsensor/control";
  std::size_t clients_max = kControlClientsMax;
  hal::Stamp answer_timeout = std::chrono::seconds(30);  ///< for a request that is answered later
  hal::Stamp unread_timeout =
      std::chrono::seconds(10);                   ///< a client that takes nothing for so long has to go
  hal::Stamp idle_min = std::chrono::seconds(1);  ///< so long silent, a client may have to make room
};

/// Serves the control protocol (control_protocol.hpp). One thread; never waits.
class ControlServer {
 public:
  /// Listens. `target` outlives this.
  [[nodiscard]] static tl::expected<std::unique_ptr<ControlServer>, hal::InitError> create(
      const ControlServerConfig& config, ControlTarget& target);

  /// Appends what poll() is to wait for. Beside that, step() is due once a second.
  void append_interest(std::vector<pollfd>& interest) const;

  /// Takes new clients, answers what has come, sends what can be sent, lets go who is gone. `now` never
  /// decreases.
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

  ControlServer(const ControlServerConfig& config, ControlListener listener, ControlTarget& target)
      : config_(config), listener_(std::move(listener)), target_(target) {}

  void accept_clients(hal::Stamp now);
  void admit(FileDescriptor socket, hal::Stamp now);
  [[nodiscard]] bool make_room(hal::Stamp now);
  void serve(Client& client, hal::Stamp now);
  void read(Client& client, hal::Stamp now);
  void write(Client& client, hal::Stamp now);
  void check_time(Client& client, hal::Stamp now);

  ControlServerConfig config_;
  ControlListener listener_;
  ControlTarget& target_;
  std::vector<std::unique_ptr<Client>> clients_;
  ControlToken last_token_ = 0;
  hal::Stamp accept_after_{};  // the system had no room for a client before
  bool accepting_ = true;

  SessionCounts counts_;
  std::uint64_t accepted_ = 0;
  std::uint64_t turned_away_ = 0;
  std::uint64_t dropped_ = 0;
  std::uint64_t accept_failed_ = 0;
  std::uint64_t timeouts_ = 0;
  std::uint64_t unclaimed_ = 0;
};

}  // namespace slamsensor::firmware
