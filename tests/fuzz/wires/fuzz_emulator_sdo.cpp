#include "tools/emulator/canopen/emulated_node.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace {

using namespace slamsensor::tools;  // NOLINT(google-build-using-namespace)

constexpr std::size_t kTextMax = 64;

/// One number and one text.
class Keeper final : public ObjectKeeper {
 public:
  SdoAbort read_object(ObjectKey key, std::vector<std::uint8_t>& bytes) override {
    if (key.index != 0x2000) {
      return SdoAbort::NoObject;
    }
    bytes.insert(bytes.end(), text_.begin(), text_.end());
    return SdoAbort::None;
  }
  SdoAbort write_object(ObjectKey key, std::span<const std::uint8_t> bytes) override {
    if (key.index != 0x2000 || bytes.size() > kTextMax) {
      return SdoAbort::TooLong;
    }
    text_.assign(bytes.begin(), bytes.end());
    return SdoAbort::None;
  }
  std::size_t object_width(ObjectKey key) const override { return key.sub == 1 ? 4 : 0; }

 private:
  std::vector<std::uint8_t> text_ = {'a', ' ', 't', 'e', 'x', 't', ' ', 'o', 'f', ' ', 'm', 'o', 'r', 'e'};
};

}  // namespace

// Requests of eight bytes each. Whatever they are, each but an abort has an answer that is one of CiA 301.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Keeper keeper;
  SdoServer server(keeper);
  for (std::size_t at = 0; at < size; at += 8) {
    SdoBytes request{};
    std::copy_n(data + at, std::min<std::size_t>(8, size - at), request.begin());
    const auto answer = server.answer(request);
    const bool is_abort = request[0] >> 5 == 4;
    if (answer.has_value() == is_abort || (answer && (*answer)[0] >> 5 > 4)) {
      __builtin_trap();
    }
  }
  return 0;
}
