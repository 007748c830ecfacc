#include "tools/view/view_server.hpp"

#include "tools/view/story_json.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <httplib.h>
#include <optional>
#include <poll.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

namespace slamsensor::tools {
namespace {

using Json = nlohmann::json;
using httplib::Request;
using httplib::Response;

constexpr std::chrono::milliseconds kStreamPeriod(250);
constexpr std::size_t kThreads = 3 * ViewServer::kStreamsMax;
constexpr std::size_t kBodyMax = 4096;

constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' data:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

std::int64_t utc_now_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// In a time that does not tell how much of it is right.
bool is_same_secret(std::string_view a, std::string_view b) {
  unsigned difference = a.size() == b.size() ? 0U : 1U;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference |=
        static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b.empty() ? 0 : b[i % b.size()]);
  }
  return difference == 0;
}

void send_json(Response& response, const Json& json, int status = 200) {
  response.status = status;
  response.set_content(json.dump(-1, ' ', false, Json::error_handler_t::replace), "application/json");
}

void send_error(Response& response, int status, const std::string& what) {
  send_json(response, {{"error", what}}, status);
}

std::optional<double> number_of(const Request& request, const char* name) {
  const std::string text = request.get_param_value(name);
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return end != text.c_str() && *end == '\0' ? std::optional(value) : std::nullopt;
}

}  // namespace

bool is_loopback_host(std::string_view host) {
  if (host.starts_with("[::1]")) {
    return host.size() == 5 || host[5] == ':';
  }
  const std::string_view name = host.substr(0, host.find(':'));
  return name == "localhost" || name == "127.0.0.1";
}

bool is_page_request(std::string_view request) {
  constexpr std::array<std::string_view, 9> kAllowed = {"scan now",     "scan pause",  "scan resume",
                                                        "map save",     "map freeze",  "map unfreeze",
                                                        "record start", "record stop", "map info"};
  return std::find(kAllowed.begin(), kAllowed.end(), request) != kAllowed.end();
}

/// What a client sends and gets over one connection, which is one request: so many bytes and lines, in so
/// short a time, that no client takes memory or a thread for itself.
class ShortStream final : public httplib::Stream {
 public:
  explicit ShortStream(socket_t socket) : socket_(socket), end_(Clock::now() + kRequestTime) {}

  bool is_readable() const override {
    return bytes_ < kRequestMax && lines_ < kLinesMax && is_ready(POLLIN, end_ - Clock::now());
  }
  bool is_writable() const override { return is_ready(POLLOUT, kWriteTime); }

  ssize_t read(char* into, std::size_t size) override {
    if (!is_readable()) {
      return -1;
    }
    const ssize_t count = ::recv(socket_, into, std::min(size, kRequestMax - bytes_), 0);
    if (count > 0) {
      bytes_ += static_cast<std::size_t>(count);
      lines_ += std::count(into, into + count, '\n');
    }
    return count;
  }
  ssize_t write(const char* from, std::size_t size) override {
    return is_writable() ? ::send(socket_, from, size, MSG_NOSIGNAL) : -1;
  }

  void get_remote_ip_and_port(std::string& ip, int& port) const override {
    ip.clear();
    port = 0;
  }
  void get_local_ip_and_port(std::string& ip, int& port) const override { get_remote_ip_and_port(ip, port); }
  socket_t socket() const override { return socket_; }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t kRequestMax = std::size_t{16} * 1024;
  static constexpr std::ptrdiff_t kLinesMax = 200;
  static constexpr std::chrono::seconds kRequestTime{2};
  static constexpr std::chrono::seconds kWriteTime{5};

  bool is_ready(short what, Clock::duration within) const {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(within).count();
    pollfd poll{socket_, what, 0};
    return left > 0 && ::poll(&poll, 1, static_cast<int>(left)) == 1;
  }

  socket_t socket_;
  Clock::time_point end_;
  std::size_t bytes_ = 0;
  std::ptrdiff_t lines_ = 0;
};

/// A server of one request a connection.
class ShortServer final : public httplib::Server {
 private:
  bool process_and_close_socket(socket_t socket) override {
    ShortStream stream(socket);
    const bool is_served = serve(stream);
    ::shutdown(socket, SHUT_RDWR);
    ::close(socket);
    return is_served;
  }

  /// As the library of Debian 12 (0.11) has it, or that of Debian 13 (0.18), which asks for addresses, too.
  template <typename Stream>
  bool serve(Stream& stream) {
    bool is_closed = false;
    if constexpr (requires { this->process_request(stream, true, is_closed, nullptr); }) {
      return this->process_request(stream, true, is_closed, nullptr);
    } else {
      return this->process_request(stream, std::string(), 0, std::string(), 0, true, is_closed, nullptr);
    }
  }
};

class ViewServer::Pages {
 public:
  Pages(Live* live, std::optional<RecordedStory> recording, ViewControl control)
      : live_(live), recording_(std::move(recording)), control_(std::move(control)) {
    server_.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
    server_.set_socket_options(
        [](socket_t socket) {  // by itself it shares a port with whoever has it already
          const int yes = 1;
          ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
        });
    server_.set_payload_max_length(kBodyMax);
    server_.set_default_headers({{"Content-Security-Policy", kPolicy},
                                 {"X-Content-Type-Options", "nosniff"},
                                 {"Referrer-Policy", "no-referrer"},
                                 {"Cache-Control", "no-store"}});
    server_.set_pre_routing_handler([this](const Request& request, Response& response) {
      if (is_local_only_ && !is_loopback_host(request.get_header_value("Host"))) {
        send_error(response, 403, "this page is served to this machine only; --listen opens it to others");
        return httplib::Server::HandlerResponse::Handled;
      }
      return httplib::Server::HandlerResponse::Unhandled;
    });
    server_.set_error_handler([this](const Request&, Response& response) {
      if (response.status == 404) {
        response.set_content(std::string("nothing is here; look at / for the page, /api/about or ") +
                                 (recording_ ? "/api/at?t=SECONDS\n" : "/api/stream\n"),
                             "text/plain");
      }
    });
    add_files();
    add_story();
    server_.Post("/api/ctl", [this](const Request& request, Response& response) { obey(request, response); });
  }

  tl::expected<int, std::string> bind(const std::string& address, int port) {
    is_local_only_ = address == "127.0.0.1" || address == "::1" || address == "localhost";
    const int bound = port == 0 ? server_.bind_to_any_port(address.c_str())
                                : (server_.bind_to_port(address.c_str(), port) ? port : -1);
    if (bound <= 0) {
      return tl::unexpected("cannot listen on " + address + ':' + std::to_string(port) +
                            ": another program has the port, or the address is not of this machine; name "
                            "another with --listen ADDRESS:PORT");
    }
    return bound;
  }

  void run() { server_.listen_after_bind(); }

  void stop() {
    is_stopping_ = true;
    server_.stop();
  }

 private:
  void add_files() {
    for (const PageFile& file : page_files()) {
      server_.Get(std::string(file.path), [&file](const Request&, Response& response) {
        response.set_content(file.content.data(), file.content.size(), std::string(file.type).c_str());
      });
    }
  }

  void add_story() {
    server_.Get("/api/about", [this](const Request&, Response& response) { send_json(response, about()); });
    if (recording_) {
      server_.Get("/api/at",
                  [this](const Request& request, Response& response) { tell_at(request, response); });
    } else {
      server_.Get("/api/stream", [this](const Request&, Response& response) { open_stream(response); });
    }
  }

  Json about() {
    Json out = {{"live", !recording_}, {"control", !control_.token.empty()}};
    if (!recording_) {
      return out;
    }
    const auto seconds = [](std::int64_t us) { return static_cast<double>(us) / 1e6; };
    Json marks = Json::array();
    for (const RecordedStory::Mark& mark : recording_->marks()) {
      marks.push_back({seconds(mark.utime_us), mark.status});
    }
    Json events = Json::array();
    for (const StoryEvent& event : recording_->events()) {
      events.push_back(event_json(event));
    }
    out["begin"] = seconds(recording_->begin_us());
    out["end"] = seconds(recording_->end_us());
    out["marks"] = std::move(marks);
    out["events"] = std::move(events);
    out["warning"] = recording_->warning();
    return out;
  }

  /// GET /api/at?t=SECONDS[&map=VERSION]: all of the story at a moment; the map only when it is another.
  void tell_at(const Request& request, Response& response) {
    const auto time_s = number_of(request, "t");
    if (!time_s || !(*time_s > 0.0 && *time_s < 1e11)) {
      return send_error(response, 400, "t: seconds since 1970 are needed");
    }
    StoryCursor cursor;
    if (const auto version = number_of(request, "map"); version && *version >= 0.0 && *version < 1e15) {
      cursor.map_version = static_cast<std::uint64_t>(*version);
    }
    const auto time_us = static_cast<std::int64_t>(*time_s * 1e6);
    const std::lock_guard lock(recording_mutex_);
    Json json = story_json(recording_->at(time_us), time_us, cursor);
    json["map_version"] = *cursor.map_version;
    send_json(response, json);
  }

  /// GET /api/stream: a `data:` line a quarter of a second, the whole story first and then what is new.
  void open_stream(Response& response) {
    if (streams_.fetch_add(1) >= kStreamsMax) {
      --streams_;
      response.set_header("Retry-After", "10");
      return send_error(response, 503, "enough pages are open; close one");
    }
    auto cursor = std::make_shared<StoryCursor>();
    auto next = std::make_shared<std::chrono::steady_clock::time_point>(std::chrono::steady_clock::now());
    response.set_chunked_content_provider(
        "text/event-stream",
        [this, cursor, next](std::size_t, httplib::DataSink& sink) {
          std::this_thread::sleep_until(*next);
          *next = std::chrono::steady_clock::now() + kStreamPeriod;
          if (is_stopping_) {
            sink.done();
            return true;
          }
          const std::string event = "data: " + live_json(*cursor) + "\n\n";
          return sink.write(event.data(), event.size());
        },
        [this](bool) { --streams_; });
  }

  std::string live_json(StoryCursor& cursor) {
    const std::lock_guard lock(live_->mutex);
    Json json = story_json(live_->story, utc_now_us(), cursor);
    json["problem"] = live_->problem;
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
  }

  /// POST /api/ctl {"request": "scan now"} with the token as bearer.
  void obey(const Request& request, Response& response) {
    if (control_.token.empty()) {
      return send_error(response, 403,
                        "this page is read-only; start slamsensor view with --control-token-file");
    }
    if (!is_same_secret(request.get_header_value("Authorization"), "Bearer " + control_.token)) {
      return send_error(response, 401, "that is not the token");
    }
    const Json body = Json::parse(request.body, nullptr, false);
    const Json asked = body.is_object() ? body.value("request", Json()) : Json();
    if (!asked.is_string() || !is_page_request(asked.get<std::string>())) {
      return send_error(response, 400, "no request that a page may make");
    }
    response.set_content(control_.ask(asked.get<std::string>()), "application/json");
  }

  Live* live_;
  std::optional<RecordedStory> recording_;
  std::mutex recording_mutex_;
  ViewControl control_;
  bool is_local_only_ = true;
  std::atomic<bool> is_stopping_{false};
  std::atomic<int> streams_{0};
  ShortServer server_;
};

ViewServer::ViewServer(Live& live, ViewControl control)
    : pages_(std::make_unique<Pages>(&live, std::nullopt, std::move(control))) {
}
ViewServer::ViewServer(RecordedStory recording)
    : pages_(std::make_unique<Pages>(nullptr, std::move(recording), ViewControl{})) {
}
ViewServer::~ViewServer() = default;

tl::expected<int, std::string> ViewServer::bind(const std::string& address, int port) {
  return pages_->bind(address, port);
}

void ViewServer::run() {
  pages_->run();
}

void ViewServer::stop() {
  pages_->stop();
}

}  // namespace slamsensor::tools
