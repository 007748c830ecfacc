#include "firmware/control/control_server.hpp"

#include "firmware/supervision/file_descriptor.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <exception>
#include <fcntl.h>
#include <filesystem>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>

namespace slamsensor::firmware {
namespace {

ControlResult too_long() {
  return tl::unexpected(ControlError{
      ControlErrorCode::Syntax,
      "the line is longer than " + std::to_string(kControlLineMax) + " bytes; send shorter ones"});
}

/// What the handler throws costs the request, not the daemon.
ControlOutcome carry_out(const ControlRequest& request, const ControlHandler& handler) {
  try {
    return handler(request);
  } catch (const std::exception& error) {
    return tl::unexpected(
        ControlError{ControlErrorCode::Failed,
                     std::string(error.what()) + "; this is a fault of the program, please report it"});
  }
}

}  // namespace

void ControlSession::receive(std::string_view bytes) {
  input_ += bytes.substr(0, room());
}

bool ControlSession::take_line(std::string& line, SessionCounts& counts) {
  while (!input_.empty()) {
    const std::size_t end = input_.find('\n');
    const bool is_whole = end != input_.npos || input_ended_;
    const std::size_t size = std::min(end, input_.size());
    const bool is_cut = skipping_;
    if (!is_whole && size <= kControlLineMax + 1) {  // a carriage return may be its last byte
      input_.erase(0, is_cut ? size : 0);
      return false;
    }
    line = input_.substr(0, size);
    input_.erase(0, end == input_.npos ? size : size + 1);
    skipping_ = !is_whole;
    if (!line.empty() && line.back() == '\r') {
      line.pop_back();
    }
    if (is_cut) {
      continue;
    }
    if (!is_whole || line.size() > kControlLineMax) {
      ++counts.too_long;
      ++counts.refused;
      put(too_long());
      line.clear();
    }
    return true;
  }
  return false;
}

bool ControlSession::can_run() const noexcept {
  return !is_pending() && output_.empty() && !input_.empty() &&
         (input_ended_ || input_.size() > kControlLineMax + 1 || input_.find('\n') != input_.npos);
}

void ControlSession::run(const ControlHandler& handler, ControlToken& last_token, SessionCounts& counts) {
  std::string line;
  while (!is_pending() && output_.empty() && take_line(line, counts)) {
    const std::string_view request = trimmed(line);
    if (!request.empty() && request.front() != '#') {
      answer(request, handler, last_token, counts);
    }
  }
}

void ControlSession::answer(std::string_view line, const ControlHandler& handler, ControlToken& last_token,
                            SessionCounts& counts) {
  ++counts.requests;
  auto request = parse_control_request(line);
  if (!request) {
    ++counts.refused;
    put(tl::unexpected(request.error()));
    return;
  }
  // Waited for before it is asked for: the handler may complete it within the call.
  const ControlToken token = ++last_token;
  pending_ = request->token = token;
  if (const ControlOutcome outcome = carry_out(*request, handler)) {
    counts.refused += outcome->has_value() ? 0 : 1;
    complete(token, *outcome);
  }
}

bool ControlSession::complete(ControlToken token, const ControlResult& result) {
  if (token == kNone || token != pending_) {
    return false;
  }
  pending_ = kNone;
  put(result);
  return true;
}

void ControlSession::give_up(std::string_view why) {
  complete(pending_, tl::unexpected(ControlError{ControlErrorCode::Timeout, std::string(why)}));
}

void ControlSession::put(const ControlResult& result) {
  output_ += answer_text(result);
}

void ControlSession::sent(std::size_t count) noexcept {
  output_sent_ += count;
  if (output_sent_ >= output_.size()) {
    output_.clear();
    output_sent_ = 0;
  }
}

namespace {

constexpr mode_t kMode = 0660;
constexpr int kBacklog = 8;
constexpr int kKind = SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK;

enum class Occupant { Nobody, Dead, Alive, OtherFile, Unreachable };

tl::unexpected<hal::InitError> refuse(const std::string& path, const std::string& why) {
  return tl::unexpected(hal::InitError{"control socket " + path + ": " + why});
}

std::string advice(int error) {
  switch (error) {
    case ENOENT:
      return "; make its folder (systemd does with RuntimeDirectory=) or change control.socket";
    case EACCES:
    case EPERM:
    case EROFS:
      return "; make its folder writable for the daemon or change control.socket";
    case EMFILE:
    case ENFILE:
      return "; raise the limit of open files";
    case ENOMEM:
    case ENOBUFS:
      return "; give the daemon more memory";
    default:
      return "; change control.socket";
  }
}

tl::unexpected<hal::InitError> failure(const std::string& path, const char* step, int error) {
  return refuse(path, std::string("cannot be ") + step + ": " + std::strerror(error) + advice(error));
}

Occupant occupant_of(const std::string& path, const UnixAddress& address) {
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0) {
    return errno == ENOENT ? Occupant::Nobody : Occupant::Unreachable;
  }
  if (!S_ISSOCK(status.st_mode)) {
    return Occupant::OtherFile;
  }
  const FileDescriptor probe(::socket(AF_UNIX, kKind, 0));
  if (::connect(probe.get(), address.get(), address.size) == 0 || errno == EAGAIN) {
    return Occupant::Alive;
  }
  return errno == ECONNREFUSED ? Occupant::Dead : Occupant::Unreachable;
}

/// Nobody else of this kind looks at the folder while this lives. Where the folder cannot be locked there is
/// nothing to be had: the binding reports the rest.
FileDescriptor lock_folder(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  FileDescriptor lock(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (lock && ::flock(lock.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    lock.reset();
    errno = EWOULDBLOCK;
  }
  return lock;
}

/// Makes `path` free to be bound.
tl::expected<void, hal::InitError> clear_path(const std::string& path, const UnixAddress& address) {
  switch (occupant_of(path, address)) {
    case Occupant::Nobody:
      return {};
    case Occupant::Dead:
      if (::unlink(path.c_str()) != 0) {
        return failure(path, "removed", errno);
      }
      return {};
    case Occupant::Alive:
      return refuse(path, "another slamsensord answers there; stop it or change control.socket");
    case Occupant::OtherFile:
      return refuse(path, "a file that is no socket is there; remove it or change control.socket");
    case Occupant::Unreachable:
      break;
  }
  return failure(path, "looked at", errno);
}

constexpr hal::Stamp kAcceptPause = std::chrono::seconds(1);
constexpr hal::Stamp kPlacePeriod = std::chrono::seconds(1);  // of looks at the path
constexpr hal::Stamp kPlaceRetry = std::chrono::seconds(10);  // whoever is there meets a probe in each
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

ControlListener::ControlListener(FileDescriptor socket, std::string path)
    : socket_(std::move(socket)), path_(std::move(path)) {
  struct stat status {};
  if (::lstat(path_.c_str(), &status) == 0) {
    device_ = status.st_dev;
    inode_ = status.st_ino;
  }
}

ControlListener::~ControlListener() {
  if (socket_ && is_in_place()) {
    ::unlink(path_.c_str());
  }
}

bool ControlListener::is_in_place() const noexcept {
  struct stat status {};
  return ::lstat(path_.c_str(), &status) == 0 && status.st_dev == device_ && status.st_ino == inode_;
}

tl::expected<ControlListener, hal::InitError> ControlListener::create(const std::string& path) {
  const auto address = unix_address(path);
  if (!address || path.front() == '@') {
    return refuse(path, "no path of 1 to " + std::to_string(kUnixPathMax) + " bytes; change control.socket");
  }
  const FileDescriptor lock = lock_folder(path);
  if (!lock && errno == EWOULDBLOCK) {
    return refuse(path, "another slamsensord is starting there; stop it or change control.socket");
  }
  if (const auto cleared = clear_path(path, *address); !cleared) {
    return tl::unexpected(cleared.error());
  }
  FileDescriptor socket(::socket(AF_UNIX, kKind, 0));
  // The mode of the descriptor goes over to the path: at no time may more people connect than in the end.
  if (!socket || ::fchmod(socket.get(), kMode) != 0 ||
      ::bind(socket.get(), address->get(), address->size) != 0) {
    return failure(path, "made", errno);
  }
  ControlListener listener(std::move(socket), path);
  if (::chmod(path.c_str(), kMode) != 0 || ::listen(listener.fd(), kBacklog) != 0) {
    return failure(path, "opened", errno);
  }
  return listener;
}

FileDescriptor ControlListener::accept() noexcept {
  return FileDescriptor(::accept4(socket_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
}

tl::expected<std::unique_ptr<ControlServer>, hal::InitError> ControlServer::create(
    const ControlServerConfig& config, ControlHandler handler, Log& log) {
  auto listener = ControlListener::create(config.socket);
  if (!listener) {
    return tl::unexpected(listener.error());
  }
  return std::unique_ptr<ControlServer>(
      new ControlServer(config, std::move(*listener), std::move(handler), log));
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
  keep_in_place(now);
}

void ControlServer::keep_in_place(hal::Stamp now) {
  if (now < place_due_) {
    return;
  }
  place_due_ = now + kPlacePeriod;
  if (listener_.is_in_place()) {
    return;
  }
  auto again = ControlListener::create(config_.socket);
  if (again) {
    listener_ = std::move(*again);
    place_problem_.clear();
    log_.notice("control socket " + config_.socket + ": its file was gone and is made again");
    return;
  }
  place_due_ = now + kPlaceRetry;
  if (again.error().message != place_problem_) {
    place_problem_ = again.error().message;
    log_.error(place_problem_ + "; until then this daemon cannot be reached");
  }
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
    client.session.run(handler_, last_token_, counts_);
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
