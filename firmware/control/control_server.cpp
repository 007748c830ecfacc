#include "firmware/control/control_server.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <sys/socket.h>

namespace slamsensor::firmware {
namespace {

constexpr hal::Stamp kAcceptPause = std::chrono::seconds(1);
constexpr int kRequestsPerStep = 16;  // of one client: the others, and the watchdog, have their turn

bool is_not_now(int error) noexcept {
  return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

/// The client has closed its end altogether, not only said that it has no more requests.
bool has_hung_up(int fd) noexcept {
  pollfd state{fd, 0, 0};
  return ::poll(&state, 1, 0) > 0;
}

/// The client went before it was taken.
bool is_clients_fault(int error) noexcept {
  return error == ECONNABORTED || error == EPROTO || error == EPERM;
}

}  // namespace

tl::expected<std::unique_ptr<ControlServer>, hal::InitError> ControlServer::create(
    const ControlServerConfig& config, ControlTarget& target) {
  auto listener = ControlListener::create(config.socket);
  if (!listener) {
    return tl::unexpected(listener.error());
  }
  return std::unique_ptr<ControlServer>(new ControlServer(config, std::move(*listener), target));
}

void ControlServer::append_interest(std::vector<pollfd>& interest) const {
  if (accepting_) {
    interest.push_back({listener_.fd(), POLLIN, 0});
  }
  for (const auto& client : clients_) {
    const ControlSession& session = client->session;
    const bool reads = session.room() > 0 && !session.has_ended();
    // One who can take an answer and has requests left is to be served at once.
    const bool writes = session.can_run() || !session.output().empty();
    const int events = (reads ? POLLIN : 0) | (writes ? POLLOUT : 0);
    interest.push_back({client->socket.get(), static_cast<short>(events), 0});
  }
}

void ControlServer::step(hal::Stamp now) {
  accept_clients(now);
  for (const auto& client : clients_) {
    serve(*client, now);
  }
  std::erase_if(clients_, [](const auto& client) { return client->is_gone; });
}

void ControlServer::accept_clients(hal::Stamp now) {
  accepting_ = now >= accept_after_;
  for (std::size_t i = 0; accepting_ && i < kControlClientsMax; ++i) {
    FileDescriptor socket = listener_.accept();
    if (socket) {
      admit(std::move(socket), now);
    } else if (is_not_now(errno)) {
      return;
    } else {
      ++accept_failed_;
      // Out of descriptors or memory: the waiting client would have poll() return at once for ever.
      accepting_ = is_clients_fault(errno);
      accept_after_ = accepting_ ? accept_after_ : now + kAcceptPause;
    }
  }
}

void ControlServer::admit(FileDescriptor socket, hal::Stamp now) {
  if (clients_.size() >= config_.clients_max && !make_room(now)) {
    ++turned_away_;
    const std::string text = answer_text(tl::unexpected(ControlError{
        ControlErrorCode::Busy,
        std::to_string(clients_.size()) + " clients are connected; end one of them and try again"}));
    static_cast<void>(::send(socket.get(), text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT));
    return;
  }
  ++accepted_;
  clients_.push_back(std::make_unique<Client>());
  clients_.back()->socket = std::move(socket);
  clients_.back()->active = now;
}

bool ControlServer::make_room(hal::Stamp now) {
  const auto rank = [](const auto& client) {
    return client->session.is_pending() ? hal::kNever : client->active;
  };
  const auto idlest = std::min_element(clients_.begin(), clients_.end(),
                                       [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
  if (idlest == clients_.end() || (*idlest)->session.is_pending() ||
      now - (*idlest)->active < config_.idle_min) {
    return false;
  }
  ++dropped_;
  clients_.erase(idlest);
  return true;
}

void ControlServer::serve(Client& client, hal::Stamp now) {
  const bool was_pending = client.session.is_pending();
  read(client, now);
  for (int i = 0; i < kRequestsPerStep && !client.is_gone; ++i) {
    client.session.run(target_, last_token_, counts_);
    write(client, now);
  }
  client.asked = was_pending ? client.asked : now;
  check_time(client, now);
  client.is_gone = client.is_gone || client.session.is_finished();
}

void ControlServer::read(Client& client, hal::Stamp now) {
  std::array<char, ControlSession::kInputMax> bytes;
  if (client.session.has_ended()) {
    client.is_gone = has_hung_up(client.socket.get());
    return;
  }
  const std::size_t room = client.session.room();
  if (room == 0) {
    return;
  }
  const ssize_t count = ::recv(client.socket.get(), bytes.data(), room, MSG_DONTWAIT);
  if (count > 0) {
    client.session.receive({bytes.data(), static_cast<std::size_t>(count)});
    client.active = now;
  } else if (count == 0) {
    client.session.end_input();
  } else if (!is_not_now(errno)) {
    client.is_gone = true;
  }
}

void ControlServer::write(Client& client, hal::Stamp now) {
  const std::string_view output = client.session.output();
  if (output.empty() || client.is_gone) {
    return;
  }
  const ssize_t count =
      ::send(client.socket.get(), output.data(), output.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  if (count > 0) {
    client.session.sent(static_cast<std::size_t>(count));
    client.active = now;
  } else if (count < 0 && !is_not_now(errno)) {
    client.is_gone = true;
  }
}

void ControlServer::check_time(Client& client, hal::Stamp now) {
  if (client.session.is_pending() && now - client.asked >= config_.answer_timeout) {
    ++timeouts_;
    client.session.give_up("no answer within " +
                           std::to_string(config_.answer_timeout / std::chrono::seconds(1)) +
                           " s; it may still be done: look at status, and try again");
    client.active = now;
  } else if (!client.session.output().empty() && now - client.active >= config_.unread_timeout) {
    ++dropped_;
    client.is_gone = true;
  }
}

void ControlServer::complete(ControlToken token, const ControlResult& result) {
  const bool claimed = std::any_of(clients_.begin(), clients_.end(), [&](const auto& client) {
    return client->session.complete(token, result);
  });
  unclaimed_ += claimed ? 0 : 1;
  counts_.refused += claimed && !result ? 1 : 0;
}

std::vector<hal::Counter> ControlServer::counters() const {
  return {{"clients_accepted", accepted_},      {"clients_refused", turned_away_},
          {"clients_dropped", dropped_},        {"accept_failed", accept_failed_},
          {"requests", counts_.requests},       {"requests_refused", counts_.refused},
          {"lines_too_long", counts_.too_long}, {"timeouts", timeouts_},
          {"answers_unclaimed", unclaimed_}};
}

}  // namespace slamsensor::firmware
