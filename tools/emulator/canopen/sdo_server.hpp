#pragma once

#include "tools/emulator/canopen/object_dictionary.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace slamsensor::tools {

/// Who knows a node's objects.
class ObjectKeeper {
 public:
  ObjectKeeper() = default;
  ObjectKeeper(const ObjectKeeper&) = delete;
  ObjectKeeper& operator=(const ObjectKeeper&) = delete;
  virtual ~ObjectKeeper() = default;

  /// Appends what the object holds to `bytes`, or tells why not.
  [[nodiscard]] virtual SdoAbort read_object(ObjectKey key, std::vector<std::uint8_t>& bytes) = 0;

  /// Writes the object, or tells why not.
  [[nodiscard]] virtual SdoAbort write_object(ObjectKey key, std::span<const std::uint8_t> bytes) = 0;

  /// Bytes of a number, 0 when there is none such.
  [[nodiscard]] virtual std::size_t object_width(ObjectKey key) const = 0;
};

using SdoBytes = std::array<std::uint8_t, 8>;

/// The default SDO server of a node (CiA 301): expedited transfers and segmented ones; no block transfers.
class SdoServer {
 public:
  explicit SdoServer(ObjectKeeper& keeper) : keeper_(keeper) {}

  /// The answer to `request`; nothing to an abort.
  [[nodiscard]] std::optional<SdoBytes> answer(const SdoBytes& request);

  /// Answers `request` with `code` and forgets the transfer under way.
  [[nodiscard]] SdoBytes abort(const SdoBytes& request, SdoAbort code);

  /// Forgets the transfer under way.
  void reset() { transfer_ = Transfer::None; }

 private:
  enum class Transfer : std::uint8_t { None, Upload, Download };

  [[nodiscard]] SdoBytes begin_download(const SdoBytes& request);
  [[nodiscard]] SdoBytes download_segment(const SdoBytes& request);
  [[nodiscard]] SdoBytes begin_upload(const SdoBytes& request);
  [[nodiscard]] SdoBytes upload_segment(const SdoBytes& request);
  [[nodiscard]] SdoBytes give_up(SdoAbort code);

  ObjectKeeper& keeper_;
  Transfer transfer_ = Transfer::None;
  ObjectKey key_;                    // of the transfer
  std::vector<std::uint8_t> bytes_;  // of it
  std::size_t sent_ = 0;             // of an upload
  std::uint8_t toggle_ = 0;          // of the next segment
};

}  // namespace slamsensor::tools
