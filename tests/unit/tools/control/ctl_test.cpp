#include "tools/control/ctl.hpp"

#include "firmware/control/control_server.hpp"
#include "hal/clock.hpp"
#include "tests/unit/firmware/control/fake_control_target.hpp"
#include "tests/unit/tools/input/temp_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <atomic>
#include <memory>
#include <sys/stat.h>
#include <thread>

namespace slamsensor::tools {
namespace {

using firmware::FakeControlTarget;
using testing::HasSubstr;

constexpr uid_t kNobody = 65534;

/// A daemon that runs in a thread of its own.
class Daemon {
 public:
  explicit Daemon(const std::string& socket) {
    firmware::ControlServerConfig config;
    config.socket = socket;
    server_ = firmware::ControlServer::create(config, target.handler(), log_).value();
    thread_ = std::thread([this] { run(); });
  }
  ~Daemon() {
    stop_ = true;
    thread_.join();
  }

  FakeControlTarget target;  ///< to be set before the first request

 private:
  void run() {
    while (!stop_) {
      std::vector<pollfd> interest;
      server_->append_interest(interest);
      ::poll(interest.data(), interest.size(), 10);
      server_->step(hal::monotonic_now());
    }
  }

  firmware::Log log_;
  std::unique_ptr<firmware::ControlServer> server_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

/// A file in memory.
struct Paper {
  explicit Paper(const std::string& text = {}) : file(std::tmpfile()) {
    std::fwrite(text.data(), 1, text.size(), file);
    std::rewind(file);
  }
  Paper(const Paper&) = delete;
  Paper& operator=(const Paper&) = delete;
  ~Paper() { std::fclose(file); }

  std::string text() const {
    std::string all(static_cast<std::size_t>(std::ftell(file)), '\0');
    std::rewind(file);
    EXPECT_EQ(std::fread(all.data(), 1, all.size(), file), all.size());
    return all;
  }

  std::FILE* file;
};

struct CtlTest : testing::Test {
  CtlTest() { options.socket = folder.path() / "control"; }

  ControlClient client() const { return ControlClient::connect(options.socket).value(); }

  TempFolder folder;
  CtlOptions options;
  Paper out;
};

TEST_F(CtlTest, PrintsLinesAndSummary) {
  Daemon daemon(options.socket);
  daemon.target.reply = {"2 maps", {"default 512 landmarks", "shed 31 landmarks"}};
  auto connected = client();
  EXPECT_EQ(run_request(connected, "map list", options, out.file).value(), EX_OK);
  EXPECT_EQ(out.text(), "default 512 landmarks\nshed 31 landmarks\n2 maps\n");
}

TEST_F(CtlTest, ARefusalIsAnErrorWithItsStatus) {
  Daemon daemon(options.socket);
  auto connected = client();
  const auto unknown = run_request(connected, "stauts", options, out.file);
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().exit_status, EX_USAGE);
  EXPECT_EQ(unknown.error().message,
            "there is no request 'stauts'; did you mean 'status'?; help lists all requests\n");
  EXPECT_EQ(out.text(), "");
}

TEST_F(CtlTest, JsonIsTheDaemonsOwnOrMadeOfTheAnswer) {
  Daemon daemon(options.socket);
  options.form = CtlForm::Json;
  auto connected = client();
  EXPECT_EQ(run_request(connected, "status", options, out.file).value(), EX_OK);
  EXPECT_EQ(run_request(connected, "map reset", options, out.file).value(), EX_OK);
  EXPECT_FALSE(run_request(connected, "map load", options, out.file));
  const std::string text = out.text();
  const std::size_t first = text.find('\n');
  const std::size_t second = text.find('\n', first + 1);
  EXPECT_EQ(nlohmann::json::parse(text.substr(0, first))["state"], "starting");
  EXPECT_EQ(text.substr(first + 1, second - first - 1),
            R"({"request":"map reset","ok":true,"code":null,"text":"done","lines":[]})");
  const auto refused = nlohmann::json::parse(text.substr(second + 1));
  EXPECT_EQ(refused["ok"], false);
  EXPECT_EQ(refused["code"], "value");
}

TEST_F(CtlTest, TheDaemonsJsonParses) {
  Daemon daemon(options.socket);
  auto connected = client();
  for (const char* request : {"status json", "fix json", "counters json", "devices json"}) {
    const auto answer = connected.ask(request, options.timeout);
    ASSERT_TRUE(answer && answer->lines.size() == 1) << request;
    EXPECT_TRUE(nlohmann::json::accept(answer->lines[0])) << answer->lines[0];
  }
}

TEST_F(CtlTest, LinesGoOnAfterARefusalAndEndWithTheLastStatus) {
  Daemon daemon(options.socket);
  auto connected = client();
  const Paper in("# a script\nversion\n\nmap load\r\n  scan mode  often\nquit\nversion\n");
  EXPECT_EQ(run_lines(connected, options, in.file, out.file).value(), EX_USAGE);
  EXPECT_EQ(out.text(),
            "slamsensord 1.2.3\n"
            "refused: something is missing; say: map load NAME\n"
            "refused: 'often' is not allowed; allowed: continuous, single\n");
}

TEST_F(CtlTest, SaysThatTheDaemonIsNotThere) {
  const auto missing = ControlClient::connect(options.socket);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().exit_status, EX_UNAVAILABLE);
  EXPECT_THAT(missing.error().message,
              HasSubstr("control socket " + options.socket + ": the daemon is not there"));
  const auto long_path = ControlClient::connect(std::string(200, 'p'));
  EXPECT_EQ(long_path.error().exit_status, EX_USAGE);
}

TEST_F(CtlTest, SaysThatARightIsMissing) {
  Daemon daemon(options.socket);
  ASSERT_EQ(::chmod(options.socket.c_str(), 0), 0);
  const uid_t own = ::geteuid();
  if (own == 0) {  // root may connect to every socket
    ASSERT_EQ(::seteuid(kNobody), 0);
  }
  const auto refused = ControlClient::connect(options.socket);
  ASSERT_EQ(::seteuid(own), 0);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().exit_status, EX_NOPERM);
  EXPECT_THAT(refused.error().message, HasSubstr("join the group"));
}

TEST_F(CtlTest, AnAnswerThatDoesNotComeIsATimeout) {
  Daemon daemon(options.socket);
  daemon.target.manner = FakeControlTarget::Manner::Later;
  auto connected = client();
  const auto answer = connected.ask("map save", std::chrono::milliseconds(50));
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().exit_status, EX_TEMPFAIL);
}

TEST_F(CtlTest, ADaemonThatGoesIsDistinguishedFromAnother) {
  auto daemon = std::make_unique<Daemon>(options.socket);
  auto connected = client();
  daemon.reset();
  const auto answer = connected.ask("version", options.timeout);
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().exit_status, EX_UNAVAILABLE);
}

TEST(ExitStatusOf, EveryCodeHasOne) {
  for (const std::string_view code : firmware::kControlErrorNames) {
    EXPECT_NE(exit_status_of(code), EX_OK) << code;
  }
  EXPECT_EQ(exit_status_of("config"), EX_CONFIG);
  EXPECT_EQ(exit_status_of("not_found"), EX_NOINPUT);
  EXPECT_EQ(exit_status_of("something newer"), EX_SOFTWARE);
}

}  // namespace
}  // namespace slamsensor::tools
