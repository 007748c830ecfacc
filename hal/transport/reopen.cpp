#include "hal/transport/reopen.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

namespace slamsensor::hal {
namespace {

/// Texts one after the other, cut at the length of a problem.
class Joined {
 public:
  Joined& operator<<(std::string_view text) noexcept {
    const std::size_t count = std::min(text.size(), text_.size() - size_);
    std::copy_n(text.begin(), count, text_.begin() + static_cast<std::ptrdiff_t>(size_));
    size_ += count;
    return *this;
  }
  [[nodiscard]] std::string_view view() const noexcept { return {text_.data(), size_}; }

 private:
  std::array<char, kProblemMax> text_{};
  std::size_t size_ = 0;
};

std::string_view words_for(int error) noexcept {
  const char* const words = ::strerrordesc_np(error);
  return words != nullptr ? words : "unknown error";
}

std::string_view advice_for(int error) noexcept {
  switch (error) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
      return "plug it in and switch it on, or correct its name in the configuration";
    case EACCES:
    case EPERM:
      return "let this user use it (group dialout or a udev rule)";
    case EBUSY:
    case EWOULDBLOCK:
      return "another program has it: stop that program";
    case ENOTTY:
    case EISDIR:
      return "name a terminal device in the configuration";
    case ENETDOWN:
      return "set its bit rate and bring it up (ip link set ... up)";
    case EAFNOSUPPORT:
      return "this kernel has no such bus: load its modules (modprobe can-raw)";
    default:
      return "it is tried again";
  }
}

}  // namespace

DeniedAdvice::DeniedAdvice(std::string_view group) noexcept {
  Joined text;
  text << "the unit keeps it from the service: add the line DeviceAllow=char-"
       << (group.empty() ? "NAME" : group) << " rw (systemctl edit slamsensor), and restart";
  text_ = FixedText<160>(text.view());
}

ReopenProblem describe(std::string_view kind, std::string_view name, const OpenFailure& failure) noexcept {
  Joined text;
  text << kind << " " << name << ": " << failure.doing;
  if (failure.error != 0) {
    text << (failure.doing.empty() ? "" : ": ") << words_for(failure.error);
  }
  text << "; " << (failure.advice.empty() ? advice_for(failure.error) : failure.advice);
  return ReopenProblem(text.view());
}

}  // namespace slamsensor::hal
