#pragma once

#include "tools/view/recorded_story.hpp"
#include "tools/view/sensor_story.hpp"

#include <tl/expected.hpp>

#include <array>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

namespace slamsensor::tools {

/// A file of the page (tools/view/page), built into the program.
struct PageFile {
  std::string_view path;
  std::string_view type;
  std::string_view content;
};

[[nodiscard]] const std::array<PageFile, 3>& page_files();

/// What a page may be told to do, and whether it may.
struct ViewControl {
  std::string token;  ///< empty: the page is read-only
  /// Hands a request to the daemon; its answer as JSON (answer_json).
  std::function<std::string(const std::string& request)> ask;
};

/// The web server of `slamsensor view`: the page, and what it shows as JSON and server-sent events. A live
/// story is shared with the thread that feeds it, under its mutex; a recording belongs to the server.
class ViewServer {
 public:
  static constexpr int kStreamsMax = 16;  ///< pages with a live stream; more are told to come later

  struct Live {
    SensorStory story;
    std::string problem;  ///< why nothing can be heard; empty when something can
    std::mutex mutex;
  };

  explicit ViewServer(Live& live, ViewControl control);
  explicit ViewServer(RecordedStory recording);
  ViewServer(const ViewServer&) = delete;
  ViewServer& operator=(const ViewServer&) = delete;
  ~ViewServer();

  /// Takes `port` (0: any) of `address`; the port, or why not.
  [[nodiscard]] tl::expected<int, std::string> bind(const std::string& address, int port);
  /// Serves until `stop`.
  void run();
  /// From any thread.
  void stop();

 private:
  class Pages;
  std::unique_ptr<Pages> pages_;
};

/// Whether `host` (a Host header) names this machine itself, so that a page of elsewhere, whose name was made
/// to point here, is not served.
[[nodiscard]] bool is_loopback_host(std::string_view host);

/// The requests that a page may hand to the daemon, given the token.
[[nodiscard]] bool is_page_request(std::string_view request);

}  // namespace slamsensor::tools
