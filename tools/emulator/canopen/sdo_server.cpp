#include "tools/emulator/canopen/sdo_server.hpp"

#include <algorithm>

namespace slamsensor::tools {
namespace {

constexpr std::size_t kSegment = 7;
constexpr std::size_t kDownloadMax = 64;
constexpr std::uint8_t kToggle = 0x10;
constexpr std::uint8_t kExpedited = 0x02;
constexpr std::uint8_t kSized = 0x01;

ObjectKey key_of(const SdoBytes& request) noexcept {
  return {static_cast<std::uint16_t>(request[1] + 256 * request[2]), request[3]};
}

SdoBytes reply(std::uint8_t command, ObjectKey key, std::span<const std::uint8_t> data) noexcept {
  SdoBytes bytes{command, static_cast<std::uint8_t>(key.index), static_cast<std::uint8_t>(key.index >> 8U),
                 key.sub};
  std::copy_n(data.begin(), std::min<std::size_t>(data.size(), 4), bytes.begin() + 4);
  return bytes;
}

SdoBytes abort_reply(ObjectKey key, SdoAbort code) {
  std::vector<std::uint8_t> data;
  append_number(data, static_cast<std::int64_t>(code), 4);
  return reply(0x80, key, data);
}

}  // namespace

std::optional<SdoBytes> SdoServer::answer(const SdoBytes& request) {
  switch (request[0] >> 5U) {
    case 0:
      return download_segment(request);
    case 1:
      return begin_download(request);
    case 2:
      return begin_upload(request);
    case 3:
      return upload_segment(request);
    case 4:
      reset();
      return std::nullopt;
    default:
      return abort(request, SdoAbort::BadCommand);
  }
}

SdoBytes SdoServer::abort(const SdoBytes& request, SdoAbort code) {
  reset();
  return abort_reply(key_of(request), code);
}

SdoBytes SdoServer::give_up(SdoAbort code) {
  reset();
  return abort_reply(key_, code);
}

SdoBytes SdoServer::begin_download(const SdoBytes& request) {
  key_ = key_of(request);
  bytes_.clear();
  toggle_ = 0;
  if ((request[0] & kExpedited) == 0) {
    transfer_ = Transfer::Download;
    return reply(0x60, key_, {});
  }
  reset();
  // Without a length it is as long as the object.
  const std::size_t size =
      (request[0] & kSized) != 0 ? 4U - ((request[0] >> 2U) & 3U) : keeper_.object_width(key_);
  const SdoAbort code =
      keeper_.write_object(key_, std::span(request).subspan(4, std::min<std::size_t>(size, 4)));
  return code == SdoAbort::None ? reply(0x60, key_, {}) : abort_reply(key_, code);
}

SdoBytes SdoServer::download_segment(const SdoBytes& request) {
  if (transfer_ != Transfer::Download) {
    return abort(request, SdoAbort::BadCommand);
  }
  if ((request[0] & kToggle) != toggle_) {
    return give_up(SdoAbort::Toggle);
  }
  const std::size_t size = kSegment - ((request[0] >> 1U) & 7U);
  bytes_.insert(bytes_.end(), request.begin() + 1, request.begin() + 1 + static_cast<std::ptrdiff_t>(size));
  if (bytes_.size() > kDownloadMax) {
    return give_up(SdoAbort::TooLong);
  }
  if ((request[0] & 1U) != 0) {
    reset();
    if (const SdoAbort code = keeper_.write_object(key_, bytes_); code != SdoAbort::None) {
      return give_up(code);
    }
  }
  SdoBytes bytes{static_cast<std::uint8_t>(0x20U | toggle_)};
  toggle_ ^= kToggle;
  return bytes;
}

SdoBytes SdoServer::begin_upload(const SdoBytes& request) {
  key_ = key_of(request);
  bytes_.clear();
  reset();
  if (const SdoAbort code = keeper_.read_object(key_, bytes_); code != SdoAbort::None) {
    return abort_reply(key_, code);
  }
  if (bytes_.size() <= 4) {
    const std::size_t unused = 4 - bytes_.size();
    return reply(static_cast<std::uint8_t>(0x43U | (unused << 2U)), key_, bytes_);
  }
  transfer_ = Transfer::Upload;
  sent_ = 0;
  toggle_ = 0;
  std::vector<std::uint8_t> size;
  append_number(size, static_cast<std::int64_t>(bytes_.size()), 4);
  return reply(0x41, key_, size);
}

SdoBytes SdoServer::upload_segment(const SdoBytes& request) {
  if (transfer_ != Transfer::Upload) {
    return abort(request, SdoAbort::BadCommand);
  }
  if ((request[0] & kToggle) != toggle_) {
    return give_up(SdoAbort::Toggle);
  }
  const std::size_t size = std::min(kSegment, bytes_.size() - sent_);
  SdoBytes bytes{};
  std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(sent_), size, bytes.begin() + 1);
  sent_ += size;
  const bool is_last = sent_ == bytes_.size();
  bytes[0] = static_cast<std::uint8_t>(toggle_ | ((kSegment - size) << 1U) | (is_last ? 1U : 0U));
  toggle_ ^= kToggle;
  if (is_last) {
    reset();
  }
  return bytes;
}

}  // namespace slamsensor::tools
